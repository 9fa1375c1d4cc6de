// A run told on the terminal: what was simulated, how fast, how far the engines are apart, which expectations hold.
#pragma once

#include <string>
#include <vector>

#include "harness/summary.h"
#include "harness/terminal.h"

namespace quayside::harness {

// Which engine stopped, when and why. `engine` has failed.
std::string failure_text(const EngineRun& engine);

std::string run_text(const EvaluatedRun& evaluated, const Style& style);

// One line each: mark, what was expected, what was found; and why it was expected, below those that failed.
std::string expectations_text(const std::vector<ExpectationResult>& results, const Style& style);

// One line per signal: rms, max and end of the distance.
std::string differences_text(const std::vector<SignalDifference>& signals, const Style& style);

// One line per matched event with the shift in time and the differences of impulse and peak force, then those without a partner.
std::string event_differences_text(const EventComparison& events, const std::string& first, const std::string& second,
                                   const Style& style);

}  // namespace quayside::harness
