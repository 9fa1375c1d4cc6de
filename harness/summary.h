// What a run comes to: engines compared, expectations evaluated, and all of it as summary.json.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "harness/compare.h"
#include "harness/error_budget.h"
#include "harness/expectations.h"
#include "harness/run.h"

namespace quayside::harness {

struct EvaluatedRun {
  RunResult run;
  std::vector<EngineComparison> comparisons;  // the first engine against each of the others
  std::vector<ExpectationResult> expectations;
  std::vector<BudgetLine> budget;  // where it was asked for

  bool completed() const;            // no engine failed
  bool expectations_hold() const;    // none failed; one that was not checked has not failed
};

EvaluatedRun evaluate(RunResult run);

// summary.json: `case`, `command`, `versions`, `scene`, `contact`, `solver`, `engines`, `comparison`, `expectations`,
// `error_budget` (where it was asked for), `interrupted`. Numbers in SI units; what is not finite or not known is null. `command`: as the user gave it.
nlohmann::ordered_json summary(const EvaluatedRun& evaluated, const std::string& command);

nlohmann::ordered_json to_json(const Event& event);
nlohmann::ordered_json to_json(const std::vector<Event>& events);
nlohmann::ordered_json to_json(const TrajectoryComparison& comparison);
nlohmann::ordered_json to_json(const EventComparison& comparison);
nlohmann::ordered_json to_json(const ExpectationResult& result);
nlohmann::ordered_json to_json(const BudgetLine& line);

}  // namespace quayside::harness
