#include "harness/impacts/impulse_theory.h"

#include <algorithm>
#include <cmath>

#include "contact_nn/restitution.h"

namespace quayside::harness {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kSteps = 20000;      // per blow: relative errors below 1e-6 with friction that turns within a thousandth of it
constexpr double kApproach = 0.02;  // of the way to 1 + c s = 0 in one step

Matrix3d cross(const Vector3d& r) {
  Matrix3d m;
  m << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return m;
}

Matrix3d inverse_inertia_W(const crane_models::Body& body) {
  const Matrix3d R = body.X_WB.linear();
  return R * body.I_BBcm_B.inverse() * R.transpose();
}

// Velocity at the point per impulse there [1/kg].
Matrix3d mobility(const crane_models::Body& body, const Vector3d& r) {
  if (body.is_static()) return Matrix3d::Zero();
  return Matrix3d::Identity() / body.mass - cross(r) * inverse_inertia_W(body) * cross(r);
}

double kinetic_energy(const crane_models::Body& body, const Vector3d& v, const Vector3d& w) {
  return body.is_static() ? 0 : 0.5 * body.mass * v.squaredNorm() + 0.5 * w.dot(inverse_inertia_W(body).inverse() * w);
}

}  // namespace

TheoreticalBlow theoretical_blow(const ImpactScene& impact, const contact_nn::ContactSettings& contact) {
  const crane_models::Body& a = impact.scene.bodies[0];
  const crane_models::Body& b = impact.scene.bodies[1];
  const Vector3d n = impact.normal_W;
  const Vector3d r_a = -a.X_WB.translation();
  const Vector3d r_b = -(b.X_WB.translation() + impact.time_of_touch * b.v_WB);
  const Matrix3d K = mobility(a, r_a) + mobility(b, r_b);
  const double c = contact_nn::damping_for(contact.restitution, contact.reference_speed);

  const auto force_per_normal = [&](const Vector3d& v) -> Vector3d {
    const Vector3d v_t = v - n.dot(v) * n;
    return n - contact.friction / std::sqrt(v_t.squaredNorm() + contact.transition_speed * contact.transition_speed) * v_t;
  };
  const auto work_rate = [&](const Vector3d& v) {
    const double s = -n.dot(v);
    return s / (1 + c * s);
  };
  Vector3d v = b.v_WB, impulse = Vector3d::Zero();
  double stored = 0;
  const double longest = 2 * -n.dot(v) / n.dot(K * n) / kSteps;
  for (;;) {
    const Vector3d f1 = force_per_normal(v);
    // The damping pulls when 1 + c s < 0, which it must not: that is where what is stored comes back without end.
    const double slope = c * n.dot(K * f1);
    const double h = slope > 0 ? std::min(longest, kApproach * (1 - c * n.dot(v)) / slope) : longest;
    const Vector3d v2 = v + 0.5 * h * K * f1, f2 = force_per_normal(v2), v3 = v + 0.5 * h * K * f2;
    const Vector3d f3 = force_per_normal(v3), v4 = v + h * K * f3, f4 = force_per_normal(v4);
    const Vector3d gained = h / 6 * (f1 + 2 * f2 + 2 * f3 + f4);
    const double work = h / 6 * (work_rate(v) + 2 * work_rate(v2) + 2 * work_rate(v3) + work_rate(v4));
    const double share = stored + work >= 0 ? 1 : stored / -work;  // of the last step
    impulse += share * gained;
    v += share * (K * gained);
    stored += work;
    if (stored < 0) break;
  }

  TheoreticalBlow blow;
  blow.impulse = impulse;
  blow.velocity = b.v_WB + impulse / b.mass;
  blow.angular_velocity = inverse_inertia_W(b) * r_b.cross(impulse);
  const double before = kinetic_energy(b, b.v_WB, Vector3d::Zero());
  double after = kinetic_energy(b, blow.velocity, blow.angular_velocity);
  if (!a.is_static()) after += kinetic_energy(a, -impulse / a.mass, inverse_inertia_W(a) * r_a.cross(-impulse));
  blow.energy_lost = before - after;
  return blow;
}

}  // namespace quayside::harness
