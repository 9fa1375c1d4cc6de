// What a foreign FMU says of itself, as far as it takes to run it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/unit.h"

namespace quayside::harness {

struct FmuVariable {
  enum class Kind { real, boolean, integer };
  Variable variable;  // its unit in SI, its start in SI
  Kind kind = Kind::real;
  unsigned reference = 0;
  double factor = 1, offset = 0;  // value in SI = factor × the FMU's value + offset
};

struct FmuDescription {
  int version = 3;  // of FMI
  std::string token, identifier;
  bool can_save = false;               // get, set and serialize states
  std::vector<FmuVariable> variables;  // parameters, inputs, outputs of these kinds; integers only as parameters
};

// Throws std::invalid_argument, saying what is wrong, for a file that is missing, no XML, of another version of FMI,
// without Co-Simulation, or with variables that contradict each other.
FmuDescription read_description(const std::filesystem::path& file);

}  // namespace quayside::harness
