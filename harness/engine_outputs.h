// The values of an engine unit's outputs, in the order of `engine_variables`.
#pragma once

#include <vector>

#include "harness/engine_unit.h"
#include "harness/event_monitor.h"
#include "harness/scene_forces.h"

namespace quayside::harness {

// Overwrites `values` with all outputs. Allocates nothing once `values` has its size.
void write_outputs(const crane_models::Scene& scene, const std::vector<BodyMotion>& bodies, const SceneLoads& loads,
                   const std::vector<char>& locks_closed, const EventMonitor& monitor, const EnergyLedger& energy,
                   std::vector<double>& values);

}  // namespace quayside::harness
