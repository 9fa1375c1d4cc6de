#include <stdexcept>

#include <fmt/format.h>

#include "harness/engine_unit.h"
#include "harness/mujoco/mujoco_unit.h"
#include "harness/simbody/simbody_unit.h"

namespace quayside::harness {

std::unique_ptr<EngineUnit> make_engine(const std::string& engine, const crane_models::Scene& scene,
                                        const contact_nn::ContactSettings& contact, const SolverSettings& solver) {
  if (engine == "simbody") return make_simbody_engine(scene, contact, solver);
  if (engine == "mujoco_same_law") return make_mujoco_engine(true, scene, contact, solver);
  if (engine == "mujoco") return make_mujoco_engine(false, scene, contact, solver);
  throw std::invalid_argument(
      fmt::format("no engine \"{}\"; expected one of simbody, mujoco_same_law, mujoco", engine));
}

}  // namespace quayside::harness
