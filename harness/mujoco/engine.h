// What both MuJoCo engines share: life cycle, inputs and outputs, stepping, events, energy. Where forces come from is
// left to `SameLawEngine` and `NativeEngine`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "harness/engine_outputs.h"
#include "harness/engine_unit.h"
#include "harness/event_monitor.h"
#include "harness/mujoco/model.h"
#include "harness/mujoco/step_limit.h"
#include "harness/scene_forces.h"

namespace quayside::harness::mujoco {

class Engine : public EngineUnit {
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
  EngineStatistics statistics() const override { return statistics_; }

 protected:
  // `laws`: what `SceneForces` needs; `mjcf`: see to_mjcf.
  Engine(std::string name, const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
         const SolverSettings& solver, std::shared_ptr<const contact_nn::ContactModule> laws, const std::string& mjcf);

  // Before an evaluation at `time_` and before the stages of a step of `h` seconds from there.
  virtual void prepare_evaluation() {}
  virtual void prepare_stages(double h) {}
  // After an evaluation: `loads_` and `rates_`.
  virtual void read_loads() {}
  // After the stages of a step of `h` seconds and the evaluation at its end: adds ∫ rates dt to `integrals_`.
  virtual void integrate(double h, const std::vector<double>& rates_at_begin) = 0;
  virtual PassiveLaw* law() { return nullptr; }

  // Motion of a drive `after` seconds from `time_`.
  crane_models::DriveMotion drive(std::size_t index, double after) const;
  void fill_drives(double after);
  void write_rates(double work_in, double dissipated);

  // Rates and integrals: work of the ropes' drives, dissipation, then the force on `b` of each contact group.
  static constexpr int kWorkIn = 0, kDissipated = 1, kImpulses = 2;

  ProcessHooks hooks_;
  const std::string name_;
  const crane_models::Scene scene_;
  const SceneForces forces_;
  Model model_;
  EventMonitor monitor_;
  EngineStatistics statistics_;

  Time time_ = 0;
  std::vector<char> locks_closed_;
  std::vector<crane_models::DriveMotion> drives_;  // at the evaluation at hand
  std::vector<BodyMotion> motions_;
  SceneLoads loads_;
  std::vector<double> rates_, integrals_;

 private:
  enum class Mode : std::uint8_t { instantiated, initialization, event, step, terminated };
  static const char* to_string(Mode mode);

  struct DriveInput {
    Time since = 0;
    crane_models::DriveMotion motion;  // at `since`
  };
  // What a step starts from, so that it can be taken again.
  struct Point {
    Time time = 0;
    std::vector<double> qpos, qvel, qacc, integrals, rates, reactions;
  };

  void demand(Mode mode, const char* what) const;
  void begin_simulation();
  void apply_inputs();
  bool change_drive(std::size_t index);
  template <typename Function>
  void run(const Function& function);
  void place_drives();
  void evaluate();
  void keep(Point& point) const;
  void rewind(const Point& point);
  void advance(Time step);
  void advance_to(Time time);
  Time next_step(Time end) const;
  void check_depths() const;
  void fill(EventMonitor::Sample& sample) const;
  void update_ledger();
  void publish();
  void recover();

  const std::vector<Variable> variables_;
  const StepLimit step_limit_;
  EventMonitor::SampleAt sample_at_;

  Mode mode_ = Mode::instantiated;
  std::vector<double> inputs_;      // as last set
  std::vector<char> input_is_set_;  // since they were last applied
  std::vector<DriveInput> drive_inputs_;
  std::vector<double> outputs_;
  std::vector<double> reactions_;   // force of each driven joint's drive [N or N m]
  Point point_;                     // where the step at hand starts
  EnergyLedger ledger_;
  double start_kinetic_ = 0, start_potential_ = 0;  // [J]
  EventMonitor::Sample begin_, end_;
};

}  // namespace quayside::harness::mujoco
