// Where the error of a run comes from: the run again with one thing better each time.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cases/case.h"
#include "harness/compare.h"

namespace quayside::harness {

// One share of the error: how far two runs are apart that differ in one thing.
struct BudgetLine {
  std::string share;       // "integration"
  std::string comparison;  // "relative tolerance 1e-06 against 1e-08"
  PositionDistance position;
  double impulse = 0;           // largest difference of an impact's impulse [N s]
  double largest_impulse = 0;   // of any impact, to hold it against [N s]
  double peak_force = 0;        // largest difference of an impact's peak force [N]
  std::size_t unmatched = 0;    // impacts that one of the runs has alone
  std::optional<std::string> failure;  // of the run to compare with; nothing is measured then
};

// Five runs of the case more, of Simbody at a hundredth of its tolerance and of MuJoCo:
//   integration      the case's tolerance against a hundredth of it
//   contact model    the case's model against exact, both at the tight tolerance, as all that follow
//   scene reduction  reduced against full
//   same law         MuJoCo under our laws
//   native           MuJoCo with its own tendons and contacts
// `progress`: called at communication points with the part done; returning false ends it with the lines there are.
std::vector<BudgetLine> error_budget(const cases::Case& description, const std::function<bool(double done)>& progress = {});

std::string budget_text(const std::vector<BudgetLine>& budget);

}  // namespace quayside::harness
