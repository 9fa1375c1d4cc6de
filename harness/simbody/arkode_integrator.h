// SUNDIALS' ARKODE: Runge-Kutta methods.
#pragma once

#include "harness/simbody/integrator.h"

namespace quayside::harness {

enum class ArkodeMethod { explicit_runge_kutta, implicit_runge_kutta };

std::unique_ptr<Integrator> make_arkode_integrator(ArkodeMethod method, OdeSystem& system,
                                                   const IntegratorSettings& settings);

}  // namespace quayside::harness
