// A unit made of lambdas: does what a test says and remembers what was done to it.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "harness/engine_unit.h"
#include "harness/state_bytes.h"

namespace quayside::harness {

class MockUnit : public EngineUnit {
 public:
  explicit MockUnit(std::string name) : name_(std::move(name)) {}

  ValueReference add(const std::string& name, Causality causality, const std::string& unit = "1", double start = 0,
                     Type type = Type::float64) {
    variables_.push_back({name, unit, causality, type, "", start});
    values.push_back(start);
    return static_cast<ValueReference>(values.size() - 1);
  }
  ValueReference input(const std::string& name, const std::string& unit = "1") { return add(name, Causality::input, unit); }
  ValueReference output(const std::string& name, const std::string& unit = "1") { return add(name, Causality::output, unit); }

  // What the unit does; the time of the unit is kept by the mock.
  std::function<StepResult(Time now, Time step)> on_step = [](Time now, Time step) { return StepResult{now + step}; };
  std::function<std::optional<Time>(Time now)> on_event = [](Time) { return std::nullopt; };
  std::function<void()> on_initialize = [] {};
  std::function<bool()> asks_for_event = [] { return false; };

  // What was done to it.
  std::vector<double> values;
  std::vector<std::pair<Time, Time>> steps;  // now, step
  std::vector<Time> event_modes;             // times at which event mode was entered from step mode
  int updates = 0;
  int restored = 0;
  Time now = 0;
  std::vector<Event> events;
  bool terminated = false;

  const std::string& name() const override { return name_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  double get(ValueReference variable) const override { return values.at(variable); }
  void set(ValueReference variable, double value) override {
    if (variables_.at(variable).causality != Causality::input) throw std::invalid_argument("not an input");
    values[variable] = value;
  }
  void enter_initialization_mode(Time start) override { now = start; }
  void exit_initialization_mode() override { on_initialize(); }
  void enter_event_mode() override { event_modes.push_back(now); }
  std::optional<Time> update_discrete_states() override {
    ++updates;
    return on_event(now);
  }
  void enter_step_mode() override {}
  StepResult do_step(Time from, Time step) override {
    steps.emplace_back(from, step);
    const StepResult result = on_step(from, step);
    now = result.time;
    return result;
  }
  bool needs_event_mode() const override { return asks_for_event(); }
  UnitState save() override {
    ByteWriter out;
    out.put(now);
    out.put(values.data(), values.size());
    return out.take();
  }
  void restore(const UnitState& state) override {
    ByteReader in(state);
    in.get(now);
    in.get(values.data(), values.size());
    ++restored;
  }
  void terminate() override { terminated = true; }
  void reset() override {}

  std::vector<Event> take_events() override { return std::exchange(events, {}); }
  std::vector<Event> open_contacts() const override { return {}; }
  EnergyLedger energy() const override { return {}; }
  EngineStatistics statistics() const override { return {}; }

 private:
  std::string name_;
  std::vector<Variable> variables_;
};

}  // namespace quayside::harness
