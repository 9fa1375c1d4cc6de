// What a case's script and connections do with a scene, for the reduction.
#pragma once

#include <string>

#include "cases/case.h"
#include "crane_models/reduction.h"

namespace quayside::harness {

// What a connection to command.* leads to, or nothing.
std::string commanded_by(const cases::ConnectionSpec& connection);

crane_models::ScriptUse use_of(const crane_models::Scene& scene, const cases::Case& description);

}  // namespace quayside::harness
