// Units and the connections between them: what is stepped, and what is handed over.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "harness/state_bytes.h"
#include "harness/unit.h"

namespace quayside::harness {

// For how long a value that is handed over at the beginning of a step is true.
//   at_once   what the output says then is all there is to know about the step: a drive's value with its rate and
//             acceleration, a command. Booleans always.
//   held      a force, a position, a speed that is asked for: it goes on changing in its own unit while the other one
//             holds it. This is the coupling's error, and what an iteration improves.
enum class Carries { held, at_once };

// How far a step went. `time` is where every unit stands then.
struct Reached {
  Time time = 0;
  bool event = false;
  bool terminate = false;
};

class Network {
 public:
  // The unit must outlive the network. Throws std::invalid_argument if the name is taken.
  void add(Unit& unit);
  // See Master::connect.
  void connect(const std::string& output, const std::string& input, Carries carries);

  const std::vector<Unit*>& units() const { return units_; }
  std::size_t connections() const { return connections_.size(); }

  // Hands over present values, in the order of the connections; an input is set only when its value is new. Returns whether
  // any was. Throws StepFailed for values that are not finite, with `now` for the time.
  bool carry_all(Time now);
  void carry_to(std::size_t unit, Time now);  // to the inputs of one unit
  void forget_values();                       // the next time all inputs are set

  // Steps one unit towards `reached.time` and adds what it says to `reached`. The first unit may stop early: then the
  // others follow to there. Throws StepFailed where another does.
  void step(std::size_t unit, Time now, Reached& reached);

  // For iterations: values of the connections' outputs, by connection.
  void read(std::vector<double>& values) const;
  void read_from(std::size_t unit, std::vector<double>& values) const;
  bool is_held(std::size_t connection) const { return connections_[connection].carries == Carries::held; }
  std::size_t source(std::size_t connection) const { return connections_[connection].from.unit; }
  std::size_t sink(std::size_t connection) const { return connections_[connection].to.unit; }
  void put(std::size_t connection, double value, Time now);  // into its input
  // The largest difference of values that are held, each over the largest that any value in its unit of measurement has
  // had so far (kSmallestScale at least).
  double difference(const std::vector<double>& a, const std::vector<double>& b) const;

  // All units' states at the beginning of a step, to go back to. Throws StepFailed when a unit cannot be saved.
  void save_units(std::vector<UnitState>& states, Time now) const;
  void restore_units(const std::vector<UnitState>& states);

  // What the network itself remembers; the units save their own states.
  void save(ByteWriter& out) const;
  void restore(ByteReader& in);

 private:
  struct Endpoint {
    std::size_t unit;
    ValueReference variable;
  };
  struct Connection {
    Endpoint from, to;
    std::string name;  // of the output, for messages
    Carries carries;
    std::size_t measure;  // index in scales_
    double value;         // last carried; NaN: none yet
  };

  Endpoint find(const std::string& name) const;
  double value_of(const Connection& connection) const { return units_[connection.from.unit]->get(connection.from.variable); }
  bool set(Connection& connection, double value, Time now);

  std::vector<Unit*> units_;
  std::vector<Connection> connections_;
  std::vector<std::string> measures_;  // units of measurement of what is carried
  std::vector<double> scales_;         // largest magnitude so far, per measure
};

}  // namespace quayside::harness
