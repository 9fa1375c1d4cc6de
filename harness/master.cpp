#include "harness/master.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

namespace quayside::harness {

namespace {

constexpr Time kNever = std::numeric_limits<Time>::max();
constexpr int kMaxEventIterations = 100;  // a chain of causes at one instant is a few links long; more is a loop
constexpr int kMaxStalls = 1000;          // steps in a row that stop where they began; an impact needs a few

}  // namespace

void Master::initialize(Time start) {
  time_ = start;
  terminated_ = false;
  network_.forget_values();
  method_->restart();
  for (Unit* unit : network_.units()) unit->enter_initialization_mode(start);
  network_.carry_all(start);
  for (Unit* unit : network_.units()) unit->exit_initialization_mode();  // into event mode
  settle();
}

// Event mode until nothing changes, then on to step mode.
void Master::settle() {
  network_.carry_all(time_);
  for (int i = 0; i < kMaxEventIterations; ++i) {
    next_event_ = kNever;
    for (Unit* unit : network_.units()) {
      if (const std::optional<Time> next = unit->update_discrete_states()) {
        next_event_ = std::min(next_event_, std::max(*next, time_));
      }
    }
    if (network_.carry_all(time_)) continue;
    for (Unit* unit : network_.units()) unit->enter_step_mode();
    return;
  }
  throw StepFailed("master", time_,
                   fmt::format("events trigger each other without end ({} rounds); look for script lines whose "
                               "conditions undo one another",
                               kMaxEventIterations));
}

bool Master::advance_to_event(Time target) {
  const Time goal = std::min(target, next_event_);
  while (true) {
    const Time before = time_;
    const Reached reached = method_->step(network_, time_, goal);
    time_ = reached.time;
    terminated_ |= reached.terminate;
    if (reached.event || time_ == next_event_ || needs_event_mode()) return true;
    if (time_ >= goal || time_ == before || terminated_) return false;
  }
}

void Master::handle_event() {
  for (Unit* unit : network_.units()) unit->enter_event_mode();
  settle();
}

std::optional<Time> Master::next_event() const {
  return next_event_ == kNever ? std::nullopt : std::optional<Time>(next_event_);
}

bool Master::needs_event_mode() const {
  return std::any_of(network_.units().begin(), network_.units().end(), [](const Unit* unit) { return unit->needs_event_mode(); });
}

void Master::save(ByteWriter& out) const {
  out.put(time_);
  out.put(next_event_);
  out.put(terminated_);
  network_.save(out);
  method_->save(out);
}

void Master::restore(ByteReader& in) {
  in.get(time_);
  in.get(next_event_);
  in.get(terminated_);
  network_.restore(in);
  method_->restore(in);
}

bool Master::advance_to(Time target) {
  for (int stalls = 0; time_ < target && !terminated_;) {
    const Time before = time_;
    if (advance_to_event(target)) handle_event();
    stalls = time_ > before ? 0 : stalls + 1;
    if (stalls > kMaxStalls) {
      throw StepFailed(network_.units()[0]->name(), time_, "events follow each other without progress in time");
    }
  }
  return !terminated_;
}

void Master::terminate() {
  for (Unit* unit : network_.units()) unit->terminate();
}

}  // namespace quayside::harness
