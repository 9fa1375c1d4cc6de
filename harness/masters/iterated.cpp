#include <fmt/format.h>

#include "harness/masters/method.h"

namespace quayside::harness {
namespace {

// The step is taken again and again from the same beginning. Over it an input is held at the mean of its values at both
// ends: the first is known, the second is what the round before gave (a part of it, with relaxation), or this one where
// the unit it comes from has stepped already. It is over when no end value changes by more than the tolerance.
//
// The mean of both ends is the mean over the step but for O(step³), so the error is of second order; and for an
// oscillator that is cut between mass and spring this is the trapezoidal rule, which neither gains nor loses energy.
//
// A unit that stops early makes the step shorter for all.
class Iterated final : public Method {
 public:
  Iterated(double tolerance, double relaxation) : tolerance_(tolerance), relaxation_(relaxation) {}

  Reached step(Network& network, Time now, Time goal) override {
    network.save_units(start_, now);
    network.read(begin_);
    end_ = begin_;
    for (int round = 0; round < kMaxRounds; ++round) {
      before_ = end_;
      const Reached reached = iterate(network, now, goal);
      if (reached.time == now) return reached;
      if (reached.time == goal && network.difference(end_, before_) <= tolerance_) {
        network.carry_all(goal);
        return reached;
      }
      for (std::size_t c = 0; c < end_.size(); ++c) end_[c] = before_[c] + relaxation_ * (end_[c] - before_[c]);
      goal = reached.time;
      network.restore_units(start_);
    }
    throw StepFailed("master", now,
                     fmt::format("the iteration of a step of {} s does not converge in {} rounds; make steps shorter "
                                 "(output.interval), or lower master.relaxation from {}",
                                 seconds(goal - now), kMaxRounds, relaxation_));
  }

 private:
  // One round. Where it returns `now`, a unit has an event at once, and all others stand as they were.
  Reached iterate(Network& network, Time now, Time goal) {
    Reached reached{goal};
    for (std::size_t i = 0; i < network.units().size(); ++i) {
      put(network, i, now, [&](std::size_t c) { return network.is_held(c) ? 0.5 * (begin_[c] + end_[c]) : begin_[c]; });
      const StepResult result = step_or_go_back(network, i, now, goal);
      reached.event |= result.event;
      reached.terminate |= result.terminate;
      if (result.time < goal) {
        reached.time = result.time;
        if (reached.time > now) return reached;
        for (std::size_t other = 0; other < i; ++other) network.units()[other]->restore(start_[other]);
        network.forget_values();
        return reached;
      }
      // Outputs that follow from inputs at once follow from those of the end.
      put(network, i, goal, [&](std::size_t c) { return network.is_held(c) ? end_[c] : begin_[c]; });
      network.read_from(i, end_);
    }
    return reached;
  }

  template <typename ValueOf>
  static void put(Network& network, std::size_t unit, Time now, const ValueOf& value_of) {
    for (std::size_t c = 0; c < network.connections(); ++c) {
      if (network.sink(c) == unit) network.put(c, value_of(c), now);
    }
  }

  StepResult step_or_go_back(Network& network, std::size_t unit, Time now, Time goal) {
    try {
      return network.units()[unit]->do_step(now, goal - now);
    } catch (const StepFailed&) {
      network.restore_units(start_);
      throw;
    }
  }

  const double tolerance_, relaxation_;
  std::vector<UnitState> start_;
  std::vector<double> begin_, end_, before_;  // values of the connections
};

}  // namespace

std::unique_ptr<Method> make_iterated(double tolerance, double relaxation) {
  return std::make_unique<Iterated>(tolerance, relaxation);
}

}  // namespace quayside::harness
