// The outputs of an engine unit, in the order of `engine_variables`.
#pragma once

#include <vector>

#include "harness/engine_unit.h"
#include "harness/event_monitor.h"
#include "harness/scene_forces.h"

namespace quayside::harness::mujoco {

class Outputs {
 public:
  // The scene must outlive this object.
  explicit Outputs(const crane_models::Scene& scene);

  // Writes `count()` values. Allocates nothing.
  void write(const std::vector<BodyMotion>& bodies, const SceneLoads& loads, const EventMonitor& monitor,
             const EnergyLedger& energy, double* values) const;

 private:
  const crane_models::Scene& scene_;
  std::vector<crane_models::ContactGroup> groups_;
};

}  // namespace quayside::harness::mujoco
