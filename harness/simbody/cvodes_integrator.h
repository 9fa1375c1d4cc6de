// SUNDIALS' CVODES: linear multistep methods of varying order.
#pragma once

#include "harness/simbody/integrator.h"

namespace quayside::harness {

enum class CvodesMethod { bdf, adams };

std::unique_ptr<Integrator> make_cvodes_integrator(CvodesMethod method, OdeSystem& system,
                                                   const IntegratorSettings& settings);

}  // namespace quayside::harness
