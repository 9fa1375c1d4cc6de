// The kept responses to all impacts, and what has moved since.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "harness/impacts/impact_response.h"

namespace quayside::harness {

// One line of the reference file: impact,response,unit,value,tolerance. It moved when it differs by more than the tolerance.
struct ReferenceRow {
  std::string impact, response, unit;
  double value = 0, tolerance = 0;
};

// Throws std::runtime_error "file:line: what is wrong".
std::vector<ReferenceRow> read_impact_reference(const std::filesystem::path& file);
void write_impact_reference(const std::filesystem::path& file, const std::vector<ReferenceRow>& rows);

// Called before each of `all` impacts; returning false ends the measurement with what there is.
using ImpactProgress = std::function<bool(std::size_t done, std::size_t all)>;

// Responses to these impacts, without tolerances.
std::vector<ReferenceRow> measure_impacts(const std::vector<Impact>& impacts, const ImpactSetup& setup, const ImpactProgress& progress);

// Fills in the tolerances, by what the solver leaves: ten times the difference to a run at a tenth of the tolerance, and at
// least a hundred steps (more than a blow takes) of the tolerance; for times of rest also what 2 % of their limit would change.
void estimate_tolerances(const std::vector<Impact>& impacts, const ImpactSetup& setup, std::vector<ReferenceRow>& rows,
                         const ImpactProgress& progress);

// A response that differs by more than its tolerance, is new (no `before`) or gone (no `now`).
struct MovedResponse {
  std::string impact, response, unit;
  std::optional<double> before, now;
  double tolerance = 0;
};
// In the order of `now`, what is gone at the end.
std::vector<MovedResponse> moved_responses(const std::vector<ReferenceRow>& before, const std::vector<ReferenceRow>& now);

// The new file: rows that have moved with their new value and tolerance, all others to the letter as they were.
std::vector<ReferenceRow> updated_reference(const std::vector<ReferenceRow>& before, const std::vector<ReferenceRow>& now);

}  // namespace quayside::harness
