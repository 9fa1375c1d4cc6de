// Steps units along their connections.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/state_bytes.h"
#include "harness/unit.h"

namespace quayside::harness {

// The co-simulation algorithm: Gauss-Seidel over an explicit list of units and connections.
//
// Each step goes to the communication point asked for, or to the next time event that a unit has announced if that comes first.
// Units step in the order in which they were added, each with inputs from those that have stepped already. The
// first one, the plant, may stop early at an event of its own: the others follow to that time. After a step with an
// event all units enter event mode, which is iterated until no connected value changes any more.
//
// Time is absolute and counted in nanoseconds, so however many steps are made, nothing drifts.
class Master {
 public:
  // The unit must outlive the master. Throws std::invalid_argument if the name is taken.
  void add(Unit& unit);

  // From an output to an input, both written "instance::variable". Values travel in the order of the connections. Throws
  // std::invalid_argument for names that do not exist, wrong causality, unequal types or units, inputs already taken. A
  // number whose unit its maker does not tell ("") goes with any.
  void connect(const std::string& output, const std::string& input);

  // Throws StepFailed, as does `advance_to`; after that the master is of no further use until it is initialized or restored
  // together with its units, but the units can be read.
  void initialize(Time start);

  // To the communication point `target`, in as many steps as events demand. False when a unit asked for the end of the
  // simulation: then `time()` may be earlier than `target`.
  bool advance_to(Time target);

  // The same in pieces, for a master above this one: one step, to `target` or to where an event ends it earlier. True when
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
  struct Endpoint {
    std::size_t unit;
    ValueReference variable;
  };
  struct Connection {
    Endpoint from, to;
    std::string name;  // of the output, for messages
    double value;      // last carried; NaN: none yet
  };

  Endpoint find(const std::string& name) const;
  bool carry(Connection& connection);
  bool carry_all();
  void carry_to(std::size_t unit);
  bool step(Time goal);
  void settle();

  std::vector<Unit*> units_;
  std::vector<Connection> connections_;
  Time time_ = 0;
  Time next_event_ = 0;
  bool terminated_ = false;
};

}  // namespace quayside::harness
