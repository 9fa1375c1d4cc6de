// What all engines of a Scene do alike: the life cycle, inputs that become motions of drives and states of locks,
// events, the energy ledger, and what the interface shows. How the bodies move is left to the engine.
#pragma once

#include <string>
#include <vector>

#include "harness/engine_unit.h"
#include "harness/event_monitor.h"
#include "harness/scene_forces.h"
#include "harness/state_bytes.h"

namespace quayside::harness {

// Integrals over time that every engine carries along: work of the drives, dissipation, then the three components of the
// force on `b` of each contact group.
constexpr int kWorkIn = 0, kDissipated = 1, kImpulses = 2;

// Inputs of every drive: value, rate, acceleration, jerk.
constexpr std::size_t kPerDrive = 4;

class SceneEngine : public EngineUnit {
 public:
  const std::string& name() const override { return name_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  double get(ValueReference variable) const override;
  void set(ValueReference variable, double value) override;
  void enter_initialization_mode(Time start) override;
  void exit_initialization_mode() override;
  void enter_event_mode() override;
  std::optional<Time> update_discrete_states() override;
  void enter_step_mode() override;
  StepResult do_step(Time now, Time step) override;
  UnitState save() override;
  void restore(const UnitState& state) override;
  void terminate() override { mode_ = Mode::terminated; }
  void reset() override;
  std::vector<Event> take_events() override { return monitor_.take_events(); }
  std::vector<Event> open_contacts() const override { return monitor_.open_contacts(begin_); }
  EnergyLedger energy() const override { return ledger_; }

 protected:
  // An engine's constructor ends with `reset()`. Throws std::invalid_argument for a scene or settings that make no sense.
  SceneEngine(std::string name, const crane_models::Scene& scene, const SolverSettings& solver);

  // --- What an engine does. Failures are std::runtime_error with the reason in words.

  // The scene's start, as drives and locks are now.
  virtual void place_start() = 0;
  // Motions, loads and energies at `time_`, with drives and locks as they are.
  virtual void evaluate() = 0;
  // Whether evaluations take contacts as they were at the last one. For engines with contacts of their own: without effect.
  virtual void hold_contacts(bool) {}
  // The state at `time_` is a new beginning: the start, restored, saved, or inputs made the motion jump or kink there.
  virtual void restart() = 0;
  // On to `target`, or to where the monitor says that a switch flips.
  virtual StepResult advance_to(Time target) = 0;
  // Back to the last good state, which is published; returns why the step failed.
  virtual std::string recover(const std::runtime_error& failure) = 0;
  virtual void save_motion(ByteWriter& out) const = 0;
  virtual void restore_motion(ByteReader& in) = 0;

  // As of the last evaluation:
  virtual const std::vector<BodyMotion>& motions() const = 0;
  virtual const SceneLoads& loads() const = 0;
  virtual void indicators(SceneForces::Indicators& out) const = 0;
  virtual double kinetic_energy() const = 0;
  virtual double potential_energy() const = 0;

  // --- What it is given for that.

  struct DriveInput {
    Time since = 0;
    crane_models::DriveMotion motion;  // at `since`
  };
  // Motion of a drive `after` seconds from `time_`.
  crane_models::DriveMotion drive(std::size_t index, double after) const;

  // What the monitor wants to know, at the last evaluation.
  void fill(double time, const std::vector<double>& integrals, EventMonitor::Sample& sample) const;
  void update_ledger(const std::vector<double>& integrals) { update_ledger(integrals, kinetic_energy(), potential_energy()); }
  void update_ledger(const std::vector<double>& integrals, double kinetic, double potential);
  // Makes the last evaluation, at `time_` with `integrals_`, what the interface shows.
  void publish();
  // Throws where a body is about to come out of another on the far side.
  void check_depths(const EventMonitor::Sample& sample) const;

  const std::string name_;
  const crane_models::Scene scene_;
  EventMonitor monitor_;
  Time time_ = 0;
  std::vector<DriveInput> drives_;
  std::vector<char> locks_closed_;
  std::vector<double> integrals_;       // at time_
  EnergyLedger ledger_;
  EventMonitor::Sample begin_, end_;    // of the step at hand; begin_: where the monitor stands

 private:
  enum class Mode : std::uint8_t { instantiated, initialization, event, step, terminated };
  static const char* to_string(Mode mode);

  void demand(Mode mode, const char* what) const;
  template <typename Function>
  auto attempt(const Function& function);
  void begin_simulation();
  void evaluate_contacts_too();
  void show_anew();
  void apply_inputs();
  bool change_drive(std::size_t index);
  bool change_lock(std::size_t index);
  bool in_place(std::size_t lock) const;

  const std::vector<Variable> variables_;
  const bool sampled_contact_;
  std::vector<double> alarming_depths_;  // per pair [m]
  Mode mode_ = Mode::instantiated;
  std::vector<double> inputs_;           // as last set
  std::vector<char> input_is_set_;       // since they were last applied
  std::vector<char> locks_told_;         // closed or open, by the command of each
  std::vector<double> outputs_;
  double kinetic_start_ = 0, potential_start_ = 0;  // [J]
};

}  // namespace quayside::harness
