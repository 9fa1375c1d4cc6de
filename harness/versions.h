// What this program was built from: "quayside", "simbody", ... with their versions.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace quayside::harness {

std::vector<std::pair<std::string, std::string>> versions();

}  // namespace quayside::harness
