#include "harness/fmi/unit_of_measure.h"

#include <utility>

namespace quayside::harness {

namespace {

using Exponents = std::array<int, 8>;

// The units that variables of this project have: exponents of kg, m, s, A, K, mol, cd, rad.
const std::pair<const char*, Exponents> kKnown[] = {
    {"1", {}},
    {"m", {0, 1}},
    {"m/s", {0, 1, -1}},
    {"m/s2", {0, 1, -2}},
    {"m/s3", {0, 1, -3}},
    {"rad", {0, 0, 0, 0, 0, 0, 0, 1}},
    {"rad/s", {0, 0, -1, 0, 0, 0, 0, 1}},
    {"rad/s2", {0, 0, -2, 0, 0, 0, 0, 1}},
    {"rad/s3", {0, 0, -3, 0, 0, 0, 0, 1}},
    {"s", {0, 0, 1}},
    {"kg", {1}},
    {"N", {1, 1, -2}},
    {"J", {1, 2, -2}},
    {"W", {1, 2, -3}},
};

}  // namespace

std::optional<UnitOfMeasure> unit_of_measure(const std::string& name) {
  for (const auto& [known, exponents] : kKnown) {
    if (name == known) return UnitOfMeasure{exponents, 1, 0};
  }
  return std::nullopt;
}

std::string si_name(const UnitOfMeasure& unit) {
  for (const auto& [known, exponents] : kKnown) {
    if (unit.exponents == exponents) return known;
  }
  std::string name;
  for (std::size_t i = 0; i < unit.exponents.size(); ++i) {
    if (unit.exponents[i] == 0) continue;
    name += std::string(name.empty() ? "" : ".") + UnitOfMeasure::kBase[i];
    if (unit.exponents[i] != 1) name += std::to_string(unit.exponents[i]);
  }
  return name;
}

}  // namespace quayside::harness
