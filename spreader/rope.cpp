#include "spreader/rope.h"

#include <algorithm>
#include <limits>

namespace quayside::spreader {
namespace {

// From 0 to 1 with level ends, so that the tension has no kink either where the ramp ends.
double ramp(double stretch) {
  const double u = std::min(stretch / kDampingRamp, 1.0);
  return u * u * (3 - 2 * u);
}

}  // namespace

RopeTension rope_tension(const Rope& rope, double length, double length_rate, double rest_length,
                         double rest_length_rate) {
  if (!(rest_length > 0)) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan, nan, nan};
  }
  RopeTension result;
  result.stretch = length - rest_length;
  if (result.stretch <= 0) return result;

  const double x = result.stretch;
  const double stiffness = rope.axial_stiffness / rest_length;
  const double stretch_rate = length_rate - rest_length_rate;
  const double elastic = stiffness * x;
  const double damping = rope.damping_time * stiffness * ramp(x);
  result.tension = std::max(0.0, elastic + damping * stretch_rate);
  result.energy = 0.5 * elastic * x;
  result.work_in = -(result.tension + result.energy / rest_length) * rest_length_rate;
  result.dissipated_power = (result.tension - elastic) * stretch_rate;
  return result;
}

}  // namespace quayside::spreader
