#include <fmt/format.h>

#include <stdexcept>

#include "harness/masters/method.h"

namespace quayside::harness {

std::unique_ptr<Method> make_method(const MasterSettings& settings) {
  if (!(settings.tolerance > 0 && settings.tolerance < 1)) {
    throw std::invalid_argument(fmt::format("master.tolerance is {}: give a value between 0 and 1", settings.tolerance));
  }
  if (!(settings.relaxation > 0 && settings.relaxation <= 1)) {
    throw std::invalid_argument(fmt::format("master.relaxation is {}: give a value in (0, 1]", settings.relaxation));
  }
  if (settings.method == "jacobi") return make_jacobi();
  if (settings.method == "gauss_seidel") return make_gauss_seidel();
  if (settings.method == "iterated") return make_iterated(settings.tolerance, settings.relaxation);
  if (settings.method == "error_controlled") return make_error_controlled(settings.tolerance);
  throw std::invalid_argument(
      fmt::format("there is no master.method \"{}\"; there are: jacobi, gauss_seidel, iterated, error_controlled", settings.method));
}

}  // namespace quayside::harness
