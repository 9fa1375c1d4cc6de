#include "harness/mujoco/export_mjcf.h"

#include "harness/mujoco/guard.h"
#include "harness/mujoco/mjcf.h"
#include "harness/mujoco/native_options.h"

namespace quayside::harness::mujoco {

std::string export_mjcf(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact, double step) {
  const ProcessHooks hooks;
  MjcfOptions options = native_options(scene, contact);
  options.step = step;
  return to_mjcf(scene, options);
}

}  // namespace quayside::harness::mujoco
