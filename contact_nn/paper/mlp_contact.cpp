#include "contact_nn/paper/mlp_contact.h"

#include <algorithm>
#include <utility>

#include "contact_nn/paper/trihedra.h"

namespace quayside::contact_nn::paper {

using Eigen::Vector3d;

MlpContact::MlpContact(Network network, Encoding encoding, Depth depth, double stiffness)
    : network_(std::move(network)), encoding_(encoding), depth_(depth), stiffness_(stiffness) {}

ContactForce MlpContact::operator()(const Pose& X_AB) const {
  ContactForce f;
  const double gap = separation(cube(), cube(), X_AB);
  if (gap >= 0) return f;
  Eigen::MatrixXd inputs(6, 1);
  inputs << X_AB.translation(), euler_angles(X_AB.linear());
  const Impact impact = impact_of(network_(inputs).col(0), encoding_);
  const Vector3d& n = impact.direction;
  double depth = -gap;
  if (depth_ == Depth::own) {
    const double reach = kEdge / 2 * (n.lpNorm<1>() + (X_AB.linear().transpose() * n).lpNorm<1>());
    depth = std::max(0.0, reach - n.dot(X_AB.translation()));
  }
  f.touching = true;
  f.impact_point_A = impact.point;
  f.normal_force = stiffness_ * depth;
  f.f_A = f.normal_force * n;
  f.t_A = impact.point.cross(f.f_A);
  return f;
}

}  // namespace quayside::contact_nn::paper
