#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "harness/masters/method.h"

namespace quayside::harness {
namespace {

// Of the step that the estimate would allow.
constexpr double kSafety = 0.9;
constexpr double kMostGrowth = 4, kMostShrinking = 0.2;
// A failure inside a trial step says nothing about how much shorter the next one should be.
constexpr double kAfterFailure = 0.25;
// Where a step this short is still too long, the values jump, and no step will do.
constexpr Time kShortestStep = 100;  // [ns]

// Every step is taken twice from the same beginning, in one piece and in two halves, both by Gauss-Seidel, and the
// difference of the connected values at the end is its error: that of two halves is half that of the whole, and the
// halves are what is kept. A step's error grows with its square, hence the root for the next one.
//
// An event inside one of the halves ends the step there, without an estimate: the way to it is shorter than a step that was
// to be expected good. A trial that fails altogether is a step too long.
class ErrorControlled final : public Method {
 public:
  explicit ErrorControlled(double tolerance) : tolerance_(tolerance) {}

  Reached step(Network& network, Time now, Time goal) override {
    const Time wanted = step_ > 0 ? std::min(step_, goal - now) : goal - now;
    network.save_units(start_, now);
    for (Time step = wanted;; network.restore_units(start_)) {
      const double error = try_step(network, now, step);
      if (event_between_) return reached_;
      double factor = kAfterFailure;
      if (error == 0) factor = kMostGrowth;
      else if (std::isfinite(error)) factor = std::clamp(kSafety * std::sqrt(tolerance_ / error), kMostShrinking, kMostGrowth);
      const auto next = static_cast<Time>(std::llround(static_cast<double>(step) * factor));
      if (error <= tolerance_) {
        // A step cut by the goal says nothing against a longer one that was good before.
        step_ = step < step_ ? std::max(step_, next) : next;
        return reached_;
      }
      if (step <= kShortestStep) {
        network.restore_units(start_);
        if (failure_) throw *failure_;
        throw StepFailed("master", now,
                         fmt::format("connected values are wrong by {:.2g} of their size in a step of {} ns; raise "
                                     "master.tolerance from {}",
                                     error, step, tolerance_));
      }
      step = std::max(kShortestStep, next);
    }
  }

  void restart() override { step_ = 0; }
  void save(ByteWriter& out) const override { out.put(step_); }
  void restore(ByteReader& in) override { in.get(step_); }

 private:
  // The error; infinite for a step that fails. Leaves the units at the end of the halves, `reached_`.
  double try_step(Network& network, Time now, Time step) {
    failure_.reset();
    event_between_ = false;
    try {
      const Reached whole = method_->step(network, now, now + step);
      network.read(whole_);
      network.restore_units(start_);
      network.carry_all(now);
      reached_ = {now, false, false};
      for (const Time end : {now + step / 2, now + step}) {
        if (end == reached_.time) continue;  // half of a nanosecond
        reached_ = method_->step(network, reached_.time, end);
        const bool looked_at = std::any_of(network.units().begin(), network.units().end(),
                                           [](const Unit* unit) { return unit->needs_event_mode(); });
        if (reached_.time < end || reached_.event || reached_.terminate || looked_at) break;
      }
      if ((event_between_ = reached_.time != whole.time)) return 0;
      network.read(halves_);
      return network.difference(whole_, halves_);
    } catch (const StepFailed& failure) {
      failure_ = failure;
      return std::numeric_limits<double>::infinity();
    }
  }

  const double tolerance_;
  const std::unique_ptr<Method> method_ = make_gauss_seidel();
  Time step_ = 0;  // that the next one may have; 0: nothing is known
  Reached reached_;
  bool event_between_ = false;  // the two trials did not come to the same time
  std::optional<StepFailed> failure_;
  std::vector<UnitState> start_;
  std::vector<double> whole_, halves_;  // values of the connections
};

}  // namespace

std::unique_ptr<Method> make_error_controlled(double tolerance) { return std::make_unique<ErrorControlled>(tolerance); }

}  // namespace quayside::harness
