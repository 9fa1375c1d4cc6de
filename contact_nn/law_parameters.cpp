#include "contact_nn/law_parameters.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "contact_nn/restitution.h"

namespace quayside::contact_nn {
namespace {

// A rebound below a thousandth is no rebound, and c would grow without bound.
constexpr double kLeastRestitution = 1e-3;

void demand(bool good, const char* key, double value, const char* range) {
  if (!good) throw std::invalid_argument(fmt::format("contact.{} is {}: it must be {}", key, value, range));
}

}  // namespace

LawParameters law_parameters(const ContactSettings& s) {
  demand(std::isfinite(s.stiffness) && s.stiffness > 0, "stiffness", s.stiffness, "positive and finite [N/m]");
  demand(s.restitution >= kLeastRestitution && s.restitution <= 1, "restitution", s.restitution,
         "from 0.001 to 1 (1: elastic)");
  demand(std::isfinite(s.reference_speed) && s.reference_speed > 0, "reference_speed", s.reference_speed,
         "positive and finite [m/s]");
  demand(std::isfinite(s.friction) && s.friction >= 0, "friction", s.friction, "zero or more, and finite");
  demand(std::isfinite(s.transition_speed) && s.transition_speed > 0, "transition_speed", s.transition_speed,
         "positive and finite [m/s]");
  const bool bristle = s.friction_law == Friction::bristle;
  return {s.stiffness, damping_for(s.restitution, s.reference_speed), bristle ? 0 : s.friction, s.transition_speed, bristle};
}

}  // namespace quayside::contact_nn
