// A whole case as one unit: the scene in Simbody, its drives and the master that steps them, in one box.
//
// Nothing of the scene is left out, since an operator outside may move what the script does not.
//
// Variables
//   parameter script (boolean, true): the case's script moves drives and commands. false: the inputs do, and the script
//   rests. inputs    command.<drive> [m/s]: speed, cut to the drive's limit and reached at its acceleration;
//   command.<command>
//             (boolean). Without effect while `script` is true.
//   outputs   the columns of a trajectory of the case
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cases/case.h"
#include "harness/drive_unit.h"
#include "harness/engine_unit.h"
#include "harness/master.h"

namespace quayside::harness {

class CaseUnit final : public Unit {
 public:
  // Throws what building the scene throws.
  CaseUnit(const std::string& name, const cases::Case& description);

  // Whether a step ends where an event is, for event mode to be entered there; else events inside a step are dealt with
  // inside.
  void set_stop_at_events(bool stop) { stop_at_events_ = stop; }

  const std::string& name() const override { return name_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  double get(ValueReference variable) const override;
  void set(ValueReference variable, double value) override;
  void enter_initialization_mode(Time start) override;
  void exit_initialization_mode() override;
  void enter_event_mode() override {
    demand(is_running(), "event mode");
    mode_ = Mode::event;
  }
  std::optional<Time> update_discrete_states() override;
  void enter_step_mode() override {
    demand(is_running(), "step mode");
    mode_ = Mode::step;
  }
  StepResult do_step(Time now, Time step) override;
  bool needs_event_mode() const override { return drives_.needs_event_mode(); }
  UnitState save() override;
  void restore(const UnitState& state) override;
  void terminate() override;
  void reset() override;

  Time time() const { return time_; }
  std::vector<Event> take_events() { return plant_->take_events(); }

 private:
  enum class Mode : std::uint8_t { instantiated, initialization, event, step, terminated };

  bool is_running() const { return mode_ == Mode::event || mode_ == Mode::step; }
  void demand(bool legal, const char* what) const;
  void start();
  void obey();

  std::string name_;
  crane_models::Scene scene_;
  std::unique_ptr<EngineUnit> plant_;
  DriveUnit drives_;
  Master master_;
  std::vector<Variable> variables_;
  std::vector<std::pair<Unit*, ValueReference>> places_;  // of each variable; null: `script`
  bool stop_at_events_ = false;

  Mode mode_ = Mode::instantiated;
  Time time_ = 0;
  bool script_ = true;
  bool event_pending_ = false;  // a step ended at it, and nobody has dealt with it yet
};

}  // namespace quayside::harness
