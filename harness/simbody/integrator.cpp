#include "harness/simbody/integrator.h"

#include <fmt/format.h>

#include "harness/simbody/arkode_integrator.h"
#include "harness/simbody/cvodes_integrator.h"
#include "harness/simbody/simtk_integrator.h"

namespace quayside::harness {

std::unique_ptr<Integrator> make_integrator(const std::string& name, OdeSystem& system,
                                            const IntegratorSettings& settings) {
  if (name == "bdf") return make_cvodes_integrator(CvodesMethod::bdf, system, settings);
  if (name == "adams") return make_cvodes_integrator(CvodesMethod::adams, system, settings);
  if (name == "erk") return make_arkode_integrator(ArkodeMethod::explicit_runge_kutta, system, settings);
  if (name == "dirk") return make_arkode_integrator(ArkodeMethod::implicit_runge_kutta, system, settings);
  if (name == "merson") return make_simtk_integrator(SimtkMethod::merson, system, settings);
  if (name == "feldberg") return make_simtk_integrator(SimtkMethod::feldberg, system, settings);
  if (name == "rk3") return make_simtk_integrator(SimtkMethod::rk3, system, settings);
  if (name == "cpodes") return make_simtk_integrator(SimtkMethod::cpodes, system, settings);
  throw std::invalid_argument(fmt::format(
      "solver.integrator: no \"{}\"; expected one of bdf, adams, erk, dirk, merson, feldberg, rk3, cpodes", name));
}

}  // namespace quayside::harness
