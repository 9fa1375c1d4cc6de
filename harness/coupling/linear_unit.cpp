#include "harness/coupling/linear_unit.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "harness/state_bytes.h"

namespace quayside::harness {

HeldInputStep held_input_step(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double h) {
  const Eigen::Index n = A.rows(), m = B.cols();
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(n + m, n + m);
  both.topLeftCorner(n, n) = A * h;
  both.topRightCorner(n, m) = B * h;
  const Eigen::MatrixXd exponential = both.exp();
  return {exponential.topLeftCorner(n, n), exponential.topRightCorner(n, m)};
}

LinearUnit::LinearUnit(std::string name, LinearSystem system) : name_(std::move(name)), system_(std::move(system)) {
  const Eigen::Index n = system_.start.size(), in = static_cast<Eigen::Index>(system_.inputs.size()),
                     out = static_cast<Eigen::Index>(system_.outputs.size());
  const auto fits = [](const Eigen::MatrixXd& M, Eigen::Index rows, Eigen::Index columns) {
    return M.rows() == rows && M.cols() == columns;
  };
  if (!fits(system_.A, n, n) || !fits(system_.B, n, in) || !fits(system_.C, out, n) || !fits(system_.D, out, in)) {
    throw std::invalid_argument(fmt::format("{}: the matrices do not fit {} states, {} inputs and {} outputs", name_, n, in, out));
  }
  for (const auto& [input, unit] : system_.inputs) variables_.push_back({input, unit, Causality::input, Type::float64, "", 0});
  for (const auto& [output, unit] : system_.outputs) variables_.push_back({output, unit, Causality::output, Type::float64, "", 0});
  reset();
}

void LinearUnit::reset() {
  time_ = 0;
  x_ = system_.start;
  u_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system_.inputs.size()));
}

double LinearUnit::get(ValueReference variable) const {
  if (variable >= variables_.size()) throw std::invalid_argument(fmt::format("{}: no variable {}", name_, variable));
  const Eigen::Index i = variable;
  if (i < u_.size()) return u_[i];
  return system_.C.row(i - u_.size()).dot(x_) + system_.D.row(i - u_.size()).dot(u_);
}

void LinearUnit::set(ValueReference variable, double value) {
  if (variable >= static_cast<ValueReference>(u_.size())) {
    throw std::invalid_argument(fmt::format("{}: variable {} is not an input", name_, variable));
  }
  u_[variable] = value;
}

StepResult LinearUnit::do_step(Time now, Time step) {
  if (now != time_ || step <= 0) throw std::invalid_argument(fmt::format("{}: a step of {} ns from {} ns", name_, step, now));
  if (step != step_) {
    held_ = held_input_step(system_.A, system_.B, seconds(step));
    step_ = step;
  }
  const Eigen::VectorXd next = held_.Phi * x_ + held_.Gamma * u_;
  if (!next.allFinite()) throw StepFailed(name_, now, "its state is not finite");
  x_ = next;
  time_ = now + step;
  ++steps_;
  return {time_};
}

UnitState LinearUnit::save() {
  ByteWriter out;
  out.put(time_);
  out.put(x_.data(), x_.size());
  out.put(u_.data(), u_.size());
  return out.take();
}

void LinearUnit::restore(const UnitState& state) {
  ByteReader in(state);
  in.get(time_);
  in.get(x_.data(), x_.size());
  in.get(u_.data(), u_.size());
  in.finish();
}

}  // namespace quayside::harness
