#include "harness/mujoco/mujoco_unit.h"

#include "harness/mujoco/native.h"
#include "harness/mujoco/same_law.h"

namespace quayside::harness {

std::unique_ptr<EngineUnit> make_mujoco_engine(bool same_law, const crane_models::Scene& scene,
                                               const contact_nn::ContactSettings& contact,
                                               const SolverSettings& solver) {
  if (same_law) return std::make_unique<mujoco::SameLawEngine>(scene, contact, solver);
  return std::make_unique<mujoco::NativeEngine>(scene, contact, solver);
}

}  // namespace quayside::harness
