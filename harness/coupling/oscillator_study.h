// Masters on the two-mass oscillator: error against macro step and cost, and the limits of stability.
#pragma once

#include <string>
#include <vector>

#include "harness/coupling/two_mass_oscillator.h"

namespace quayside::harness {

struct OscillatorPoint {
  Cut cut{};
  std::string method;
  double step = 0;       // communication step [s]
  double tolerance = 0;  // of the master; 0 where it has none
  double error = 0;      // the largest of both positions over all communication points [m]
  std::size_t unit_steps = 0;
  double order = 0;      // of the error in the step (with error control: in unit steps), from the point before; NaN: none
};

struct StabilityLimit {
  Cut cut{};
  std::string method;
  double theory = 0, measured = 0;  // the longest stable step [s]; infinite: there is none up to kLongestStep
};

constexpr double kOscillatorDuration = 4;  // [s]: some ten periods of the faster mode
constexpr double kLongestStep = 10;        // for which stability is looked at [s]

// All masters, both cuts: steps of 0.1 s and halves, quarters ... of it, `halvings` times.
std::vector<OscillatorPoint> oscillator_errors(const TwoMassOscillator& oscillator, int halvings);
// Jacobi, Gauss-Seidel and the iteration, both cuts. For the iteration the limit is where it stops
// converging in kMaxRounds.
std::vector<StabilityLimit> oscillator_limits(const TwoMassOscillator& oscillator);

// One run. An error that is not finite: the run failed or blew up.
OscillatorPoint oscillator_run(const TwoMassOscillator& oscillator, Cut cut, const MasterSettings& settings, double step);

// Whether a run with this step dies away: after many steps, no larger in later ones than in earlier ones.
bool dies_away(const TwoMassOscillator& oscillator, Cut cut, const MasterSettings& settings, double step);

}  // namespace quayside::harness
