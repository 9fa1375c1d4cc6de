#include "harness/unit.h"

#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

namespace quayside::harness {

Time nanoseconds(double t) {
  // 2⁶³ is a double, the largest int64 is not: compare against the power of two, which NaN fails as well.
  constexpr double kLimit = 9223372036854775808.0;
  const double count = std::round(t * 1e9);
  if (!(std::abs(count) < kLimit)) {
    throw std::out_of_range(fmt::format("{} s cannot be counted in nanoseconds: the limit is 292 years", t));
  }
  return static_cast<Time>(count);
}

StepFailed::StepFailed(const std::string& unit, Time time, const std::string& reason)
    : std::runtime_error(fmt::format("{} stopped at {:.9f} s: {}", unit, seconds(time), reason)), time(time) {}

}  // namespace quayside::harness
