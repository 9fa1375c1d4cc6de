#include "contact_nn/bristle.h"

#include <cmath>

namespace quayside::contact_nn {

using Eigen::Vector3d;

namespace {

// S(x)/x.
double carried_share(double x) {
  constexpr double w = BristleFriction::kBlend;
  if (x <= 1 - w) return 1;
  if (x >= 1 + w) return 1 / x;
  const double into = x - (1 - w);
  return 1 - into * into / (4 * w * x);
}

}  // namespace

Bristle BristleFriction::add(const Bristle& z, const Pose& X_AB, const RelativeVelocity& V_AB, ContactForce& force) const {
  constexpr double kRate = 1 / kRelaxation;
  force.potential_energy += 0.5 * stiffness_ * z.squaredNorm();
  const double N = force.f_A.norm();
  if (N == 0) {
    force.dissipated_power += kRate * stiffness_ * z.squaredNorm();
    return -kRate * z;
  }
  const Vector3d n = force.f_A / N, &c = force.impact_point_A;
  const double r = std::sqrt(force.pressure_radius2);
  const Vector3d v = V_AB.v_A + V_AB.w_A.cross(c - X_AB.translation());
  Bristle slide, deflection = z;
  slide << v - n.dot(v) * n, r * n.dot(V_AB.w_A);
  const double through = n.dot(z.head<3>());
  deflection.head<3>() -= through * n;

  const Bristle pull = stiffness_ * deflection + damping() * slide;
  const double s = carried_share(pull.norm() / (friction_ * N));
  const Bristle carried = s * pull;
  Bristle rate = slide - (1 - s) / damping() * pull;
  force.dissipated_power += damping() * rate.squaredNorm() + s * (1 - s) / damping() * pull.squaredNorm() +
                            kRate * stiffness_ * through * through;
  rate.head<3>() -= kRate * through * n;

  const Vector3d f = carried.head<3>();
  force.f_A -= f;
  force.t_A -= c.cross(f) + r * carried[3] * n;
  return rate;
}

std::optional<BristleFriction> bristle_friction(const ContactSettings& settings) {
  if (settings.friction_law != Friction::bristle || settings.friction == 0) return std::nullopt;
  return BristleFriction(settings);
}

}  // namespace quayside::contact_nn
