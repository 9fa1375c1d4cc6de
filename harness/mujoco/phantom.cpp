#include "harness/mujoco/phantom.h"

namespace quayside::harness::mujoco {
namespace {

constexpr double kSlack = 1e-6;  // [m]

double outside(const Eigen::Vector3d& p, const Eigen::Vector3d& half) { return (p.cwiseAbs() - half).maxCoeff(); }

}  // namespace

bool is_phantom(const contact_nn::Box& a, const contact_nn::Box& b, const contact_nn::Pose& X_AB,
                const ReportedContact& contact) {
  if (contact_nn::separation(a, b, X_AB) > kSlack) return true;
  const double reach = contact.depth + kSlack;
  if (outside(contact.p_A, a.half) > reach || outside(X_AB.inverse() * contact.p_A, b.half) > reach) return true;
  const Eigen::Vector3d n_B = X_AB.linear().transpose() * contact.n_A;
  const double overlap =
      a.half.dot(contact.n_A.cwiseAbs()) + b.half.dot(n_B.cwiseAbs()) - X_AB.translation().dot(contact.n_A);
  return contact.depth > overlap + kSlack;
}

}  // namespace quayside::harness::mujoco
