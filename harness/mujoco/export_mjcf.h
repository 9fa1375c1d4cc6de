// A Scene for MuJoCo's own tools, with the tendons, locks and contacts that the engine "mujoco" has.
#pragma once

#include <string>

#include "contact_nn/contact.h"
#include "crane_models/scene.h"

namespace quayside::harness::mujoco {

// MJCF with a time step of `step` [s]; its keyframe "start" is the scene's start. Nothing drives it: trolleys stand and
// ropes keep their length. Throws std::invalid_argument for a scene that cannot be built.
std::string export_mjcf(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact, double step);

}  // namespace quayside::harness::mujoco
