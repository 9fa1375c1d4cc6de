// Units of measure as products of powers of SI base units and the radian, times a factor.
#pragma once

#include <array>
#include <optional>
#include <string>

namespace quayside::harness {

struct UnitOfMeasure {
  static constexpr std::array<const char*, 8> kBase{"kg", "m", "s", "A", "K", "mol", "cd", "rad"};
  std::array<int, 8> exponents{};  // of kBase
  double factor = 1, offset = 0;   // value in base units = factor × value + offset
};

// Of a name as this project's variables have them: "m/s2", "N", "1". Empty for one that is none of these.
std::optional<UnitOfMeasure> unit_of_measure(const std::string& name);

// The name that this project gives the base units of `unit`: "rad/s" for degrees per second; made up where it has none.
std::string si_name(const UnitOfMeasure& unit);

}  // namespace quayside::harness
