#include "harness/mujoco/outputs.h"

#include <algorithm>
#include <cmath>

namespace quayside::harness::mujoco {
namespace {

const BodyMotion kAtRest;

double* put(double* out, const Eigen::Vector3d& v) { return std::copy(v.data(), v.data() + 3, out); }

}  // namespace

Outputs::Outputs(const crane_models::Scene& scene) : scene_(scene), groups_(crane_models::contact_groups(scene)) {}

void Outputs::write(const std::vector<BodyMotion>& bodies, const SceneLoads& loads, const EventMonitor& monitor,
                    const EnergyLedger& energy, double* out) const {
  for (const auto& frame : scene_.frames) {
    const BodyMotion& body = frame.body == crane_models::kWorld ? kAtRest : bodies[frame.body];
    const crane_models::Pose X_WR = body.X_WB * frame.X_BR;
    Eigen::Quaterniond q(X_WR.linear());
    if (q.w() < 0) q.coeffs() *= -1;  // of the two quaternions of a rotation the one nearer to none
    out = put(out, X_WR.translation());
    for (const double c : {q.w(), q.x(), q.y(), q.z()}) *out++ = c;
    out = put(out, body.v_WB + body.w_WB.cross(X_WR.translation() - body.X_WB.translation()));
    out = put(out, body.w_WB);
    const Eigen::Vector3d up = X_WR.linear().col(2);
    *out++ = std::atan2(up.head<2>().norm(), up.z());
  }
  for (const auto& rope : loads.ropes) {
    *out++ = rope.tension;
    *out++ = rope.stretch;
  }
  for (const auto& group : groups_) {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (const int pair : group.pairs) force += loads.pairs[pair].f_W;
    *out++ = force.norm();
  }
  for (std::size_t i = 0; i < scene_.landed_switches.size(); ++i) *out++ = monitor.landed(static_cast<int>(i)) ? 1 : 0;
  for (const double e : {energy.kinetic, energy.potential, energy.work_in, energy.dissipated, energy.residual()}) {
    *out++ = e;
  }
}

}  // namespace quayside::harness::mujoco
