// How an engine answers an impact of the matrix, as a list of numbers under names.
#pragma once

#include <string>
#include <vector>

#include "contact_nn/contact.h"
#include "harness/engine_unit.h"
#include "harness/impacts/impact_matrix.h"

namespace quayside::harness {

struct ResponseValue {
  std::string name, unit;
  double value;
  double scale;       // what is much for it: errors of the solver are relative to this
  double spread = 0;  // of a time at which something falls below a limit: how far that moves with 2 % of the limit
};

struct ImpactSetup {
  std::string engine = "simbody";
  contact_nn::ContactSettings contact;  // friction is the impact's
  double relative_tolerance = 1e-8;     // of the solver
  bool until_rest = true;               // false: the first blow alone
};

// Of the first blow, from touch to parting: impulse [N s], peak force [N], duration [s], velocities of the box after it [m/s,
// rad/s], energy lost [J]; and, on the ground with friction, the time until the box has come to rest under gravity [s]. Throws
// StepFailed, and std::runtime_error when there is no blow or no end to it.
std::vector<ResponseValue> impact_response(const Impact& impact, const ImpactSetup& setup);

}  // namespace quayside::harness
