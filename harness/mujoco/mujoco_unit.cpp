#include "harness/mujoco/mujoco_unit.h"

#include <stdexcept>

#include "harness/mujoco/same_law.h"

namespace quayside::harness {

std::unique_ptr<EngineUnit> make_mujoco_engine(bool same_law, const crane_models::Scene& scene,
                                               const contact_nn::ContactSettings& contact, const SolverSettings& solver) {
  if (!same_law) throw std::invalid_argument("the engine mujoco is not there yet: leave it out of --engine");
  return std::make_unique<mujoco::SameLawEngine>(scene, contact, solver);
}

}  // namespace quayside::harness
