// The operator, the motors and the guards: plays a case's script, moves the drives within their limits of speed,
// acceleration and jerk, and stops them when a load limit trips.
//
// Jerk is piecewise constant and changes at event times only, so that within a step every drive moves exactly as
// value + rate τ + ½ acceleration τ² + ⅙ jerk τ³, which is what the engines take as input. All breakpoints (ends of
// ramps, `at` times, ends of `after`) are announced by `update_discrete_states`.
//
// An emergency stop, by the script, by a load limit that trips or by a drive that passes a limit switch, brings every drive to rest with the deceleration that
// its machine has for it, and for good: whatever is asked for later, it does not move again. Twistlocks still obey. The
// wind is no drive of the machine and blows on.
//
// Variables, named as the engines name their inputs and outputs:
//   outputs  <drive>.value, <drive>.rate, <drive>.acceleration, <drive>.jerk per drive of the scene; <command> (boolean)
//   inputs   every landed switch of the scene (boolean); signals of engines that conditions of the script name or load
//            limits watch;
//            command.<drive>, command.<command>: what an operator asks for, see `hand_over`
//
// Conditions on switches and signals, limit switches among them, are looked at whenever units meet: at communication points and at events. A signal
// may also be an output of this unit ("hoist.value"). A condition that holds starts its entry once; entries that are due
// at the same moment fire in the order of the script.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "cases/case.h"
#include "crane_models/scene.h"
#include "harness/engine_unit.h"
#include "harness/master.h"
#include "harness/unit.h"

namespace quayside::harness {

class DriveUnit final : public Unit {
 public:
  // Takes the script from `description`; `scene` is the one that is simulated. Throws cases::CaseError for drives,
  // commands, signals and switches that the scene does not have and for speeds beyond a drive's limit.
  DriveUnit(const std::string& name, const cases::Case& description, const crane_models::Scene& scene);

  const std::string& name() const override { return name_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  double get(ValueReference variable) const override;
  void set(ValueReference variable, double value) override;

  void enter_initialization_mode(Time start) override;
  void exit_initialization_mode() override {}
  void enter_event_mode() override {}
  std::optional<Time> update_discrete_states() override;
  void enter_step_mode() override {}
  StepResult do_step(Time now, Time step) override;

  UnitState save() override;
  void restore(const UnitState& state) override;
  void terminate() override {}
  void reset() override;
  bool needs_event_mode() const override;

  // Whose orders a drive or command of the scene obeys: the script's, as all do at first, or those of its input. The speed
  // that an input asks for is cut to the drive's limit; ramps follow as for the script. `reset` leaves this as it is.
  void hand_over(const std::string& drive_or_command, bool to_input);

  // Limits that tripped and emergency stops since the last call.
  std::vector<Event> take_events();

 private:
  // A part of a ramp that follows: its length, and what acceleration and jerk it begins with.
  struct Phase {
    Time duration = 0;
    double acceleration = 0, jerk = 0;
  };
  // A motor's motion since `begin`: constant jerk until `end` (kNever: no end), then the phases that are left, then
  // `target` speed.
  struct Segment {
    Time begin, end;
    crane_models::DriveMotion motion;  // at `begin`
    double target;                     // rate when the ramp is over [unit/s]
    std::array<Phase, 2> following{};
    int left = 0;  // of them
  };
  // A limit: since when it has been passed (kNever: it is not), and whether it has tripped.
  struct Guard {
    Time since;
    bool tripped;
  };
  struct Progress {
    Time due;  // kNever: the condition has not held yet
    bool fired;
  };
  struct Entry {
    cases::ScriptEntry::Condition condition;
    Time at, after;
    std::vector<ValueReference> watched;  // one of them has to satisfy the condition (locked: all)
    double threshold;
    struct Rate {
      std::size_t drive;
      double rate;    // of its value
      double within;  // [s]; 0: as fast as the limits allow
    };
    std::vector<Rate> rates;
    std::vector<std::pair<std::size_t, double>> values;  // command's place in `values_`, 0 or 1
    bool emergency_stop = false;
  };

  crane_models::DriveMotion motion(std::size_t drive) const;
  bool holds(const Entry& entry) const;
  bool waits_for_what_holds() const;
  double commanded(std::size_t place) const { return values_[first_command_input_ + place]; }
  double commanded_rate(std::size_t drive) const;
  Time next_breakpoint() const;
  ValueReference watch(const Variable& signal);
  // Whether an emergency stop keeps this drive from moving.
  bool held(std::size_t drive) const { return stopped_ && drives_[drive].emergency_stop > 0; }
  // Limits: the scene's load limits, then the limit switches of each drive.
  double tension(std::size_t load_limit) const;
  bool over(std::size_t limit) const;
  Time delay(std::size_t limit) const;
  void watch_limits();
  void stop_all(EventKind kind, const std::string& subject);
  void finish_phase(Segment& segment);
  void start_ramp(std::size_t drive, double target, double acceleration, double jerk);
  void fire(const Entry& entry);

  std::string name_;
  std::vector<crane_models::Drive> drives_;
  std::vector<Entry> script_;
  std::vector<Variable> variables_;  // three per drive, then what stands in `values_`
  std::size_t commands_ = 0;             // at the begin of `values_`
  std::size_t first_command_input_ = 0;  // in `values_`: one per drive, then one per command
  std::vector<bool> by_input_;           // per drive, then per command
  std::vector<crane_models::LoadLimit> limits_;
  std::vector<std::vector<ValueReference>> tensions_;  // that each limit sums up

  // The state.
  Time time_ = 0;
  std::vector<Segment> segments_;  // per drive
  std::vector<Progress> progress_;  // per entry of the script
  std::vector<double> values_;      // commands and inputs
  std::vector<Guard> guards_;       // per limit
  bool stopped_ = false;
  std::vector<Event> events_;
};

// Connects the two both ways, by the names that their variables share.
void connect_drives(Master& master, const Unit& plant, const DriveUnit& drives);

}  // namespace quayside::harness
