#include "harness/coupling/oscillator_study.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quayside::harness {

namespace {

constexpr double kFirstStep = 0.1;  // [s]
// Iterations are to be exact, so that what is seen is the step's error and not the iteration's.
constexpr double kExact = 1e-13;
const std::vector<std::string> kFixedStepMethods{"jacobi", "gauss_seidel", "iterated"};
const std::vector<double> kTolerances{1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The limit is looked for by halving, in runs of this many steps. A mode that grows by 1e-6 a step shows in them.
constexpr int kLimitSteps = 20'000;
constexpr int kHalvings = 24;

// What an iteration is asked for where its convergence is looked at. It is not to be had where a round leaves more than this.
constexpr double kAgreement = 1e-6;
const double kSlowestRound = std::pow(kAgreement, 1.0 / kMaxRounds);

bool converges(const TwoMassOscillator& oscillator, Cut cut, double step) {
  return std::isfinite(oscillator_run(oscillator, cut, {"iterated", kAgreement, 1}, step).error);
}

template <typename Predicate>
double largest(const Predicate& good, double low, double high) {
  if (good(high)) return kInfinity;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (good(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

OscillatorPoint oscillator_run(const TwoMassOscillator& oscillator, Cut cut, const MasterSettings& settings, double step) {
  OscillatorPoint point{cut, settings.method, step, settings.tolerance, 0, 0, std::nan("")};
  CutOscillator units(oscillator, cut, settings);
  try {
    units.master().initialize(0);
    const auto steps = std::max<long>(1, std::lround(kOscillatorDuration / step));
    for (long i = 1; i <= steps; ++i) {
      const Time time = nanoseconds(static_cast<double>(i) * step);
      units.master().advance_to(time);
      const Eigen::Vector4d difference = units.state() - oscillator.at(seconds(time));
      point.error = std::max({point.error, std::abs(difference[0]), std::abs(difference[2])});
    }
  } catch (const StepFailed&) {
    point.error = kInfinity;
  }
  point.unit_steps = units.unit_steps();
  return point;
}

bool dies_away(const TwoMassOscillator& oscillator, Cut cut, const MasterSettings& settings, double step) {
  CutOscillator units(oscillator, cut, settings);
  const Time h = nanoseconds(step);
  const auto size_after = [&](int begin, int end) {
    double size = 0;
    for (int i = begin + 1; i <= end; ++i) {
      units.master().advance_to(i * h);
      size = std::max(size, units.state().lpNorm<Eigen::Infinity>());
    }
    return size;
  };
  try {
    units.master().initialize(0);
    size_after(0, kLimitSteps / 2);  // until the mode that grows, or dies away most slowly, is all there is
    return size_after(kLimitSteps / 2, 3 * kLimitSteps / 4) >= size_after(3 * kLimitSteps / 4, kLimitSteps);
  } catch (const StepFailed&) {  // numbers overflow
    return false;
  }
}

std::vector<OscillatorPoint> oscillator_errors(const TwoMassOscillator& oscillator, int halvings) {
  std::vector<OscillatorPoint> points;
  const auto add = [&](OscillatorPoint point, bool first, double ratio) {
    if (!first) point.order = std::log(points.back().error / point.error) / std::log(ratio);
    points.push_back(point);
  };
  for (const Cut cut : {Cut::displacement_force, Cut::force_force}) {
    for (const std::string& method : kFixedStepMethods) {
      for (int i = 0; i <= halvings; ++i) {
        OscillatorPoint point = oscillator_run(oscillator, cut, {method, kExact, 1}, std::ldexp(kFirstStep, -i));
        if (method != "iterated") point.tolerance = 0;
        add(point, i == 0, 2);
      }
    }
    for (const double tolerance : kTolerances) {
      const OscillatorPoint point = oscillator_run(oscillator, cut, {"error_controlled", tolerance, 1}, kFirstStep);
      const bool first = tolerance == kTolerances.front();
      add(point, first, first ? 1 : static_cast<double>(point.unit_steps) / static_cast<double>(points.back().unit_steps));
    }
  }
  return points;
}

std::vector<StabilityLimit> oscillator_limits(const TwoMassOscillator& oscillator) {
  std::vector<StabilityLimit> limits;
  for (const Cut cut : {Cut::displacement_force, Cut::force_force}) {
    for (const std::string method : {"jacobi", "gauss_seidel"}) {
      const double theory = stability_limit(oscillator, cut, method, kLongestStep);
      const auto stable = [&](double h) { return dies_away(oscillator, cut, {method, kExact, 1}, h); };
      limits.push_back({cut, method, theory, largest(stable, 0, 2 * theory)});
    }
    const auto factor = [&](double h) { return std::abs(iteration_factor(oscillator, cut, h)) < kSlowestRound; };
    const double theory = largest(factor, 0, kLongestStep);
    const auto good = [&](double h) { return converges(oscillator, cut, h); };
    limits.push_back({cut, "iterated", theory, largest(good, 0, std::isfinite(theory) ? 2 * theory : kLongestStep)});
  }
  return limits;
}

}  // namespace quayside::harness
