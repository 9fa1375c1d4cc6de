#include "harness/master.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "harness/names.h"

namespace quayside::harness {

namespace {

constexpr Time kNever = std::numeric_limits<Time>::max();
constexpr int kMaxEventIterations = 100;  // a chain of causes at one instant is a few links long; more is a loop
constexpr int kMaxStalls = 1000;          // steps in a row that stop where they began; an impact needs a few

}  // namespace

void Master::add(Unit& unit) {
  for (const Unit* other : units_) {
    if (other->name() == unit.name()) throw std::invalid_argument(fmt::format("two units are called \"{}\"", unit.name()));
  }
  units_.push_back(&unit);
}

Master::Endpoint Master::find(const std::string& name) const {
  const std::size_t colons = name.find("::");
  const std::string instance = name.substr(0, colons);
  std::vector<std::string> instances;
  for (std::size_t i = 0; i < units_.size(); ++i) {
    instances.push_back(units_[i]->name());
    if (units_[i]->name() != instance) continue;
    const std::string wanted = colons == std::string::npos ? "" : name.substr(colons + 2);
    std::vector<std::string> names;
    for (const Variable& variable : units_[i]->variables()) {
      if (variable.name == wanted) return {i, static_cast<ValueReference>(names.size())};
      names.push_back(variable.name);
    }
    throw std::invalid_argument(
        fmt::format("connection \"{}\": no variable \"{}\"; {}", name, wanted, nearest_names(wanted, names)));
  }
  throw std::invalid_argument(
      fmt::format("connection \"{}\": no unit \"{}\"; {}", name, instance, nearest_names(instance, instances)));
}

void Master::connect(const std::string& output, const std::string& input) {
  const Endpoint from = find(output), to = find(input);
  const Variable& source = units_[from.unit]->variables()[from.variable];
  const Variable& sink = units_[to.unit]->variables()[to.variable];
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("connection of \"{}\" to \"{}\": {}", output, input, why));
  };
  if (source.causality != Causality::output) refuse("the first is not an output");
  if (sink.causality != Causality::input) refuse("the second is not an input");
  if (source.type != sink.type) refuse("one is a number, the other boolean");
  const bool both_told = !source.unit.empty() && !sink.unit.empty();
  if (both_told && source.unit != sink.unit) refuse(fmt::format("their units differ, [{}] and [{}]", source.unit, sink.unit));
  for (const Connection& other : connections_) {
    if (other.to.unit == to.unit && other.to.variable == to.variable) refuse("the input already gets " + other.name);
  }
  connections_.push_back({from, to, output, std::numeric_limits<double>::quiet_NaN()});
}

// Inputs are set only when their value is new. Returns whether it was.
bool Master::carry(Connection& connection) {
  const double value = units_[connection.from.unit]->get(connection.from.variable);
  if (value == connection.value) return false;
  if (!std::isfinite(value)) {
    throw StepFailed(units_[connection.from.unit]->name(), time_, fmt::format("{} is {}", connection.name, value));
  }
  units_[connection.to.unit]->set(connection.to.variable, value);
  connection.value = value;
  return true;
}

bool Master::carry_all() {
  bool changed = false;
  for (Connection& connection : connections_) changed |= carry(connection);
  return changed;
}

void Master::carry_to(std::size_t unit) {
  for (Connection& connection : connections_) {
    if (connection.to.unit == unit) carry(connection);
  }
}

void Master::initialize(Time start) {
  time_ = start;
  terminated_ = false;
  for (Connection& connection : connections_) connection.value = std::numeric_limits<double>::quiet_NaN();
  for (Unit* unit : units_) unit->enter_initialization_mode(start);
  carry_all();
  for (Unit* unit : units_) unit->exit_initialization_mode();  // into event mode
  settle();
}

// Event mode until nothing changes, then on to step mode.
void Master::settle() {
  carry_all();
  for (int i = 0; i < kMaxEventIterations; ++i) {
    next_event_ = kNever;
    for (Unit* unit : units_) {
      if (const std::optional<Time> next = unit->update_discrete_states()) {
        next_event_ = std::min(next_event_, std::max(*next, time_));
      }
    }
    if (carry_all()) continue;
    for (Unit* unit : units_) unit->enter_step_mode();
    return;
  }
  throw StepFailed("master", time_,
                   fmt::format("events trigger each other without end ({} rounds); look for script lines whose "
                               "conditions undo one another",
                               kMaxEventIterations));
}

// One Gauss-Seidel step towards `goal`. Returns whether there is an event at the time that was reached.
bool Master::step(Time goal) {
  bool event = false;
  for (std::size_t i = 0; i < units_.size() && goal > time_; ++i) {
    carry_to(i);
    const StepResult result = units_[i]->do_step(time_, goal - time_);
    assert(result.time >= time_ && result.time <= goal);
    if (result.time < goal && i > 0) {
      throw StepFailed(units_[i]->name(), result.time,
                       fmt::format("stopped early, while {} is ahead at {} s; only the first unit may", units_[0]->name(),
                                   seconds(goal)));
    }
    goal = result.time;
    event |= result.event;
    terminated_ |= result.terminate;
  }
  time_ = goal;
  carry_all();
  return event || time_ == next_event_ || needs_event_mode();
}

bool Master::advance_to_event(Time target) { return step(std::min(target, next_event_)); }

void Master::handle_event() {
  for (Unit* unit : units_) unit->enter_event_mode();
  settle();
}

std::optional<Time> Master::next_event() const {
  return next_event_ == kNever ? std::nullopt : std::optional<Time>(next_event_);
}

bool Master::needs_event_mode() const {
  return std::any_of(units_.begin(), units_.end(), [](const Unit* unit) { return unit->needs_event_mode(); });
}

void Master::save(ByteWriter& out) const {
  out.put(time_);
  out.put(next_event_);
  out.put(terminated_);
  for (const Connection& connection : connections_) out.put(connection.value);
}

void Master::restore(ByteReader& in) {
  in.get(time_);
  in.get(next_event_);
  in.get(terminated_);
  for (Connection& connection : connections_) in.get(connection.value);
}

bool Master::advance_to(Time target) {
  for (int stalls = 0; time_ < target && !terminated_;) {
    const Time before = time_;
    if (advance_to_event(target)) handle_event();
    stalls = time_ > before ? 0 : stalls + 1;
    if (stalls > kMaxStalls) throw StepFailed(units_[0]->name(), time_, "events follow each other without progress in time");
  }
  return !terminated_;
}

void Master::terminate() {
  for (Unit* unit : units_) unit->terminate();
}

}  // namespace quayside::harness
