// Steps units along their connections.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "harness/masters/method.h"
#include "harness/masters/network.h"
#include "harness/state_bytes.h"
#include "harness/unit.h"

namespace quayside::harness {

// Co-simulation over an explicit list of units and connections, by one of the methods of harness/masters/method.h.
//
// Each step goes to the communication point asked for, or to the next time event that a unit has announced if that comes first.
// The first unit added, the plant, may stop early at an event of its own: the others follow to that time. After a step
// with an event all units enter event mode, which is iterated until no connected value changes any more.
//
// Time is absolute and counted in nanoseconds, so however many steps are made, nothing drifts.
class Master {
 public:
  // Throws what make_method throws.
  explicit Master(const MasterSettings& settings = {}) : method_(make_method(settings)) {}

  // The unit must outlive the master. Throws std::invalid_argument if the name is taken.
  void add(Unit& unit) { network_.add(unit); }

  // From an output to an input, both written "instance::variable". Values travel in the order of the connections, so where an
  // output follows from an input at once, the connection to that input comes first. Throws std::invalid_argument for names
  // that do not exist, wrong causality, unequal types or units, inputs already taken. A number whose unit its maker does
  // not tell ("") goes with any.
  void connect(const std::string& output, const std::string& input, Carries carries = Carries::held) {
    network_.connect(output, input, carries);
  }

  // Throws StepFailed, as does `advance_to`; after that the master is of no further use until it is initialized or restored
  // together with its units, but the units can be read.
  void initialize(Time start);

  // To the communication point `target`, in as many steps as events and the method demand. False when a unit asked for the
  // end of the simulation: then `time()` may be earlier than `target`.
  bool advance_to(Time target);

  // The same in pieces, for a master above this one: to `target` or to where an event ends the step earlier. True when
  // there is an event at the time that was reached; then `handle_event` has to come before the next step.
  bool advance_to_event(Time target);
  void handle_event();
  std::optional<Time> next_event() const;  // the earliest that a unit has announced
  bool needs_event_mode() const;           // of any unit
  bool terminated() const { return terminated_; }

  // What the master itself remembers; the units save their own states.
  void save(ByteWriter& out) const;
  void restore(ByteReader& in);

  void terminate();

  Time time() const { return time_; }

 private:
  void settle();

  Network network_;
  std::unique_ptr<Method> method_;
  Time time_ = 0;
  Time next_event_ = 0;
  bool terminated_ = false;
};

}  // namespace quayside::harness
