// What a case expects, held against what a run showed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/case.h"
#include "harness/run.h"

namespace quayside::harness {

enum class Verdict { passed, failed, not_checked };
const char* to_string(Verdict verdict);  // "passed", "failed", "not checked"

struct ExpectationResult {
  Verdict verdict = Verdict::not_checked;
  std::string text;                // "simbody: load.position.z at the end = 5.182 ± 0.005 m"
  std::optional<double> measured;  // in the unit of the signal, in seconds for events
  std::string finding;             // "5.1817 m", or why there is nothing to measure
  std::string why;                 // the reason that the case gives
  int line = 0;                    // in the case file
};

// One result per expectation of the case, in its order. An expectation about an engine that was not run, or about a run
// that the user interrupted, is not checked; one about an engine that failed on the way has failed.
std::vector<ExpectationResult> evaluate_expectations(const RunResult& run);

// Throws cases::CaseError for an expectation of a signal that the run will not record, so that a slip of the pen shows
// before the simulation and not after it. `signals`: names of the scalar signals.
void check_expectations(const cases::Case& description, const std::vector<std::string>& signals);

}  // namespace quayside::harness
