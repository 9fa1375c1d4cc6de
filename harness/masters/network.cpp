#include "harness/masters/network.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "harness/names.h"

namespace quayside::harness {

namespace {

// Values below this (in SI units) are nothing but rounding where they ought to be zero.
constexpr double kSmallestScale = 1e-6;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void Network::add(Unit& unit) {
  for (const Unit* other : units_) {
    if (other->name() == unit.name()) throw std::invalid_argument(fmt::format("two units are called \"{}\"", unit.name()));
  }
  units_.push_back(&unit);
}

Network::Endpoint Network::find(const std::string& name) const {
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

void Network::connect(const std::string& output, const std::string& input, Carries carries) {
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
  if (source.type == Type::boolean) carries = Carries::at_once;

  const std::string measure = source.unit.empty() ? sink.unit : source.unit;
  const auto known = std::find(measures_.begin(), measures_.end(), measure);
  const auto index = static_cast<std::size_t>(known - measures_.begin());
  if (known == measures_.end()) {
    measures_.push_back(measure);
    scales_.push_back(kSmallestScale);
  }
  connections_.push_back({from, to, output, carries, index, kNone});
}

bool Network::set(Connection& connection, double value, Time now) {
  if (value == connection.value) return false;
  if (!std::isfinite(value)) {
    throw StepFailed(units_[connection.from.unit]->name(), now, fmt::format("{} is {}", connection.name, value));
  }
  units_[connection.to.unit]->set(connection.to.variable, value);
  connection.value = value;
  scales_[connection.measure] = std::max(scales_[connection.measure], std::abs(value));
  return true;
}

bool Network::carry_all(Time now) {
  bool changed = false;
  for (Connection& connection : connections_) changed |= set(connection, value_of(connection), now);
  return changed;
}

void Network::carry_to(std::size_t unit, Time now) {
  for (Connection& connection : connections_) {
    if (connection.to.unit == unit) set(connection, value_of(connection), now);
  }
}

void Network::put(std::size_t connection, double value, Time now) { set(connections_[connection], value, now); }

void Network::forget_values() {
  for (Connection& connection : connections_) connection.value = kNone;
}

void Network::step(std::size_t unit, Time now, Reached& reached) {
  const StepResult result = units_[unit]->do_step(now, reached.time - now);
  assert(result.time >= now && result.time <= reached.time);
  if (result.time < reached.time && unit > 0) {
    throw StepFailed(units_[unit]->name(), result.time,
                     fmt::format("stopped early, while {} is ahead at {} s; only the first unit may, or any unit with "
                                 "master.method: iterated",
                                 units_[0]->name(), seconds(reached.time)));
  }
  reached.time = result.time;
  reached.event |= result.event;
  reached.terminate |= result.terminate;
}

void Network::read(std::vector<double>& values) const {
  values.resize(connections_.size());
  for (std::size_t i = 0; i < connections_.size(); ++i) values[i] = value_of(connections_[i]);
}

void Network::read_from(std::size_t unit, std::vector<double>& values) const {
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    if (connections_[i].from.unit == unit) values[i] = value_of(connections_[i]);
  }
}

double Network::difference(const std::vector<double>& a, const std::vector<double>& b) const {
  double largest = 0;
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    if (!is_held(i)) continue;
    const double difference = std::abs(a[i] - b[i]) / scales_[connections_[i].measure];
    if (!(difference <= largest)) largest = difference;  // NaN counts as large
  }
  return largest;
}

void Network::save_units(std::vector<UnitState>& states, Time now) const {
  states.resize(units_.size());
  for (std::size_t i = 0; i < units_.size(); ++i) {
    try {
      states[i] = units_[i]->save();
    } catch (const std::logic_error& error) {
      throw StepFailed(units_[i]->name(), now,
                       fmt::format("{}. Masters that go back need it: take master.method: gauss_seidel or jacobi", error.what()));
    }
  }
}

// Inputs are part of a unit's state, but foreign units are not to be trusted with that: all are set again.
void Network::restore_units(const std::vector<UnitState>& states) {
  for (std::size_t i = 0; i < units_.size(); ++i) units_[i]->restore(states[i]);
  forget_values();
}

void Network::save(ByteWriter& out) const {
  for (const Connection& connection : connections_) out.put(connection.value);
  out.put(scales_.data(), scales_.size());
}

void Network::restore(ByteReader& in) {
  for (Connection& connection : connections_) in.get(connection.value);
  in.get(scales_.data(), scales_.size());
}

}  // namespace quayside::harness
