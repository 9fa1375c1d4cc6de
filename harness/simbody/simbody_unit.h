// The product's engine: the Scene as a Simbody multibody system, integrated by SUNDIALS' CVODES or another of the
// methods in integrator.h.
#pragma once

#include <memory>

#include "harness/engine_unit.h"

namespace quayside::harness {

// Variables as of engine_variables. Drives whose inputs are not set keep the motion they have; a drive that is set to
// what it would have come to by itself (to 1e-9) costs nothing, so that drives may be set at every communication
// point.
//
// Throws std::invalid_argument for a scene or settings it cannot build.
std::unique_ptr<EngineUnit> make_simbody_engine(const crane_models::Scene& scene,
                                                const contact_nn::ContactSettings& contact,
                                                const SolverSettings& solver);

}  // namespace quayside::harness
