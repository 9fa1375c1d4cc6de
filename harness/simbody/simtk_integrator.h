// The integrators that come with Simbody, on the same right-hand side.
#pragma once

#include "harness/simbody/integrator.h"

namespace quayside::harness {

enum class SimtkMethod { merson, feldberg, rk3, cpodes };

std::unique_ptr<Integrator> make_simtk_integrator(SimtkMethod method, OdeSystem& system,
                                                  const IntegratorSettings& settings);

}  // namespace quayside::harness
