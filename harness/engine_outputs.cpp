#include "harness/engine_outputs.h"

#include <cmath>

namespace quayside::harness {

void write_outputs(const crane_models::Scene& scene, const std::vector<BodyMotion>& bodies, const SceneLoads& loads,
                   const std::vector<char>& locks_closed, const EventMonitor& monitor, const EnergyLedger& energy,
                   std::vector<double>& values) {
  static const BodyMotion kAtRest;
  values.clear();
  const auto put = [&](const Eigen::Vector3d& v) { values.insert(values.end(), v.data(), v.data() + 3); };
  for (const auto& frame : scene.frames) {
    const BodyMotion& body = frame.body == crane_models::kWorld ? kAtRest : bodies[frame.body];
    const crane_models::Pose X_WR = body.X_WB * frame.X_BR;
    Eigen::Quaterniond q(X_WR.linear());
    if (q.w() < 0) q.coeffs() *= -1;  // of the two quaternions the one that turns by less than half a turn
    put(X_WR.translation());
    values.insert(values.end(), {q.w(), q.x(), q.y(), q.z()});
    put(body.v_WB + body.w_WB.cross(X_WR.translation() - body.X_WB.translation()));
    put(body.w_WB);
    const Eigen::Vector3d z_W = X_WR.linear().col(2);
    values.push_back(std::atan2(z_W.head<2>().norm(), z_W.z()));
  }
  for (const auto& rope : loads.ropes) values.insert(values.end(), {rope.tension, rope.stretch});
  for (std::size_t i = 0; i < scene.locks.size(); ++i) {
    if (scene.locks[i].command >= 0) values.push_back(locks_closed[i] != 0);
  }
  for (const auto& group : monitor.groups()) values.push_back(group_force(group, loads).norm());
  for (std::size_t i = 0; i < scene.landed_switches.size(); ++i) values.push_back(monitor.landed(static_cast<int>(i)));
  values.insert(values.end(), {energy.kinetic, energy.potential, energy.work_in, energy.dissipated, energy.residual()});
}

}  // namespace quayside::harness
