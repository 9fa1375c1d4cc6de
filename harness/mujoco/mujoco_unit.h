// A Scene in MuJoCo behind the EngineUnit interface, as one of two engines:
//
//   mujoco_same_law   MuJoCo's dynamics and integrator under our rope, lock and contact laws: checks the dynamics
//   mujoco            MuJoCo's own tendons, equality constraints and contacts, their parameters mapped from ours: an
//                     independent model of everything but the data
#pragma once

#include <memory>

#include "harness/engine_unit.h"

namespace quayside::harness {

// Throws std::invalid_argument for a scene or settings that cannot be built, with what to change.
std::unique_ptr<EngineUnit> make_mujoco_engine(bool same_law, const crane_models::Scene& scene,
                                               const contact_nn::ContactSettings& contact,
                                               const SolverSettings& solver);

}  // namespace quayside::harness
