// A linear system as a co-simulation unit, integrated exactly: what is wrong with a run of such units is the coupling.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "harness/unit.h"

namespace quayside::harness {

// x' = A x + B u, y = C x + D u. Any of the sizes may be zero.
struct LinearSystem {
  Eigen::MatrixXd A, B, C, D;
  Eigen::VectorXd start;                                       // x at the start
  std::vector<std::pair<std::string, std::string>> inputs, outputs;  // names and units of measurement, as u and y
};

// x and u at the end of a step follow from those at its beginning as Φ x + Γ u, for u held over the step:
// exp([A B; 0 0] h) = [Φ Γ; 0 1].
struct HeldInputStep {
  Eigen::MatrixXd Phi, Gamma;
};
HeldInputStep held_input_step(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double h);

// Inputs come first among the variables. Outputs follow from inputs at once where D says so.
class LinearUnit final : public Unit {
 public:
  // Throws std::invalid_argument for matrices whose sizes do not fit.
  LinearUnit(std::string name, LinearSystem system);

  const std::string& name() const override { return name_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  double get(ValueReference variable) const override;
  void set(ValueReference variable, double value) override;
  void enter_initialization_mode(Time start) override { time_ = start; }
  void exit_initialization_mode() override {}
  void enter_event_mode() override {}
  std::optional<Time> update_discrete_states() override { return std::nullopt; }
  void enter_step_mode() override {}
  StepResult do_step(Time now, Time step) override;
  UnitState save() override;
  void restore(const UnitState& state) override;
  void terminate() override {}
  void reset() override;

  std::size_t steps() const { return steps_; }  // made so far, those taken back as well

 private:
  const std::string name_;
  const LinearSystem system_;
  std::vector<Variable> variables_;
  std::size_t steps_ = 0;
  Time step_ = 0;  // that `held_` belongs to
  HeldInputStep held_;

  Time time_ = 0;
  Eigen::VectorXd x_, u_;
};

}  // namespace quayside::harness
