// How far apart two words are: for suggestions where a name is not known.
#pragma once

#include <cstddef>
#include <string>

namespace quayside::cases {

// Levenshtein's distance: letters to insert, remove or replace.
std::size_t edit_distance(const std::string& a, const std::string& b);

}  // namespace quayside::cases
