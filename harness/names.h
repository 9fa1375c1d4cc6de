// Help for somebody who misspelt a name.
#pragma once

#include <string>
#include <vector>

namespace quayside::harness {

// The names closest to `wanted` in a sentence: "nearest: load.position.x, load.position.y"; all of them where they are few.
std::string nearest_names(const std::string& wanted, const std::vector<std::string>& names);

}  // namespace quayside::harness
