// One co-simulation unit with the life cycle of FMI 3.0 for Co-Simulation.
//
//   instantiated ─▶ initialization mode ─▶ event mode ⇄ step mode ─▶ terminated
//
// Time on the interface is an integer number of nanoseconds: absolute times are rounded, steps are never added up, so
// nothing drifts. Variables are addressed by value reference: their index in `variables()`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace quayside::harness {

using Time = std::int64_t;  // [ns]
constexpr double kNanosecond = 1e-9;
inline double seconds(Time t) { return static_cast<double>(t) / 1e9; }  // the double nearest to t
Time nanoseconds(double t);  // rounded to nearest; throws std::out_of_range where int64 cannot hold it

enum class Causality { parameter, input, output, local };
enum class Type { float64, boolean };

struct Variable {
  std::string name;  // structured: "load.position.z"
  std::string unit;  // SI, "1" for none, empty for booleans
  Causality causality = Causality::output;
  Type type = Type::float64;
  std::string description;
  double start = 0;  // booleans: 0 or 1
};

using ValueReference = std::uint32_t;

// How far a step went. `time` is the new time of the unit; it is earlier than asked when an event ended the step.
struct StepResult {
  Time time = 0;
  bool event = false;       // enter event mode before the next step
  bool terminate = false;   // the unit asks for the end of the simulation
};

// A step that could not be done. The unit is left in its last good state, at `time`.
class StepFailed : public std::runtime_error {
 public:
  StepFailed(const std::string& unit, Time time, const std::string& reason);
  Time time;
};

// A complete state of one unit, opaque bytes: equal state gives equal bytes.
using UnitState = std::vector<std::byte>;

class Unit {
 public:
  virtual ~Unit() = default;

  virtual const std::string& name() const = 0;
  virtual const std::vector<Variable>& variables() const = 0;

  // Values of booleans are 0 and 1. Setting is allowed for inputs (any mode) and parameters (initialization mode); a wrong
  // reference or causality throws std::invalid_argument.
  virtual double get(ValueReference variable) const = 0;
  virtual void set(ValueReference variable, double value) = 0;

  virtual void enter_initialization_mode(Time start) = 0;
  virtual void exit_initialization_mode() = 0;

  // Event mode: discrete changes happen here. Returns the next time event that is known in advance, if any: the master
  // does not step beyond it.
  virtual void enter_event_mode() = 0;
  virtual std::optional<Time> update_discrete_states() = 0;
  virtual void enter_step_mode() = 0;

  // From `now` (the unit's own time) by `step` > 0. Throws StepFailed.
  virtual StepResult do_step(Time now, Time step) = 0;

  // In step mode: whether an input was set that only event mode can answer. The master then enters it before it steps on.
  virtual bool needs_event_mode() const { return false; }

  // A save restarts the solver, so that the run that continues and the run that is restored later are the same.
  virtual UnitState save() = 0;
  virtual void restore(const UnitState& state) = 0;

  virtual void terminate() = 0;
  virtual void reset() = 0;
};

}  // namespace quayside::harness
