// A foreign FMU as a unit: FMI 3.0 or 2.0 for Co-Simulation, with the life cycle of every other unit.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "harness/fmi/archive.h"
#include "harness/fmi/foreign_fmu.h"

namespace quayside::harness {

// Variables are the FMU's scalar parameters, inputs and outputs that are real or boolean (parameters: integer as well),
// by its names, in SI units whatever the FMU's own are. Numbers whose unit the FMU does not tell have the unit "".
//
// The FMU deals with its events itself, at most at the next communication point. Errors of the FMU come as StepFailed
// with this unit's name, the time, and the FMU's own words; so do outputs that are not finite. The FMU runs in a process
// of its own (fmu_process.h): if it crashes, calls exit or does not come back within `patience`, that is an error too.
class FmuUnit final : public Unit {
 public:
  static constexpr double kPatience = 60;  // for every call [s]

  // Parameters keep the FMU's start value unless given. Throws std::invalid_argument "unit NAME: FILE: ..." for what is
  // no FMU that can be run here.
  FmuUnit(const std::string& name, const std::filesystem::path& fmu,
          const std::vector<std::pair<std::string, double>>& parameters = {}, double patience = kPatience);

  const std::string& name() const override { return name_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  double get(ValueReference variable) const override;
  void set(ValueReference variable, double value) override;
  void enter_initialization_mode(Time start) override;
  void exit_initialization_mode() override;
  void enter_event_mode() override {}
  std::optional<Time> update_discrete_states() override { return std::nullopt; }
  void enter_step_mode() override {}
  StepResult do_step(Time now, Time step) override;
  // Throw std::logic_error for an FMU that cannot serialize its state.
  UnitState save() override;
  void restore(const UnitState& state) override;
  void terminate() override;
  void reset() override;

 private:
  void demand_state() const;
  template <typename Action>
  void guarded(Action action) const;

  std::string name_;
  TemporaryFolder folder_;
  FmuDescription description_;
  std::vector<Variable> variables_;
  std::unique_ptr<ForeignFmu> fmu_;
  std::vector<std::pair<ValueReference, double>> parameters_;
  Time time_ = 0;
  bool broken_ = false;  // an error came: nothing but reset and restore is allowed
};

}  // namespace quayside::harness
