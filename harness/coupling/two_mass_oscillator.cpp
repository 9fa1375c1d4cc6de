#include "harness/coupling/two_mass_oscillator.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <unsupported/Eigen/MatrixFunctions>

namespace quayside::harness {

namespace {

using Eigen::Matrix2d;
using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::RowVector4d;

using Names = std::vector<std::pair<std::string, std::string>>;

const Names kMotion{{"position", "m"}, {"velocity", "m/s"}};

// A mass on a spring and damper to something at rest.
Matrix2d mass_on_spring(double m, double k, double c) { return (Matrix2d() << 0, 1, -k / m, -c / m).finished(); }

Eigen::Vector2d by_force(double m) { return {0, 1 / m}; }

// The force on the left mass is this times z.
RowVector4d force(const TwoMassOscillator& o) { return {-o.k, -o.c, o.k, o.c}; }

// Φ and G of `macro_step`, and how the sides answer to what they hold.
struct Held {
  Matrix4d Phi = Matrix4d::Zero(), G = Matrix4d::Zero();
  MatrixXd left, right;  // Γ of each side
};

Held held(const TwoMassOscillator& o, Cut cut, double h) {
  const HeldInputStep left = held_input_step(mass_on_spring(o.m1, o.k1, o.c1), by_force(o.m1), h);
  Held result;
  result.left = left.Gamma;
  result.Phi.topLeftCorner<2, 2>() = left.Phi;
  result.G.topRows<2>() = left.Gamma * force(o);
  if (cut == Cut::force_force) {
    const HeldInputStep right = held_input_step(mass_on_spring(o.m2, 0, 0), by_force(o.m2), h);
    result.right = right.Gamma;
    result.Phi.bottomRightCorner<2, 2>() = right.Phi;
    result.G.bottomRows<2>() = -right.Gamma * force(o);
  } else {
    const Matrix2d by_motion = (Matrix2d() << 0, 0, o.k / o.m2, o.c / o.m2).finished();
    const HeldInputStep right = held_input_step(mass_on_spring(o.m2, o.k, o.c), by_motion, h);
    result.right = right.Gamma;
    result.Phi.bottomRightCorner<2, 2>() = right.Phi;
    result.G.bottomLeftCorner<2, 2>() = right.Gamma;
  }
  return result;
}

}  // namespace

const char* to_string(Cut cut) { return cut == Cut::displacement_force ? "displacement_force" : "force_force"; }

Matrix4d TwoMassOscillator::dynamics() const {
  Matrix4d A = Matrix4d::Zero();
  A(0, 1) = A(2, 3) = 1;
  A.row(1) = force(*this) / m1;
  A.row(3) = -force(*this) / m2;
  A(1, 0) -= k1 / m1;
  A(1, 1) -= c1 / m1;
  return A;
}

Eigen::Vector4d TwoMassOscillator::at(double t) const { return Matrix4d(dynamics() * t).exp() * start; }

CutOscillator::CutOscillator(const TwoMassOscillator& o, Cut cut, const MasterSettings& settings) : master_(settings) {
  const auto add = [&](const char* name, const MatrixXd& A, const MatrixXd& B, const MatrixXd& C, const MatrixXd& D,
                       const Eigen::VectorXd& start, const Names& inputs, const Names& outputs) {
    units_.push_back(std::make_unique<LinearUnit>(name, LinearSystem{A, B, C, D, start, inputs, outputs}));
    master_.add(*units_.back());
  };
  const MatrixXd identity = Matrix2d::Identity(), none = MatrixXd::Zero(2, 1);
  const Names force_in{{"force", "N"}};
  add("left", mass_on_spring(o.m1, o.k1, o.c1), by_force(o.m1), identity, none, o.start.head<2>(), force_in, kMotion);
  if (cut == Cut::displacement_force) {
    const Matrix2d by_motion = (Matrix2d() << 0, 0, o.k / o.m2, o.c / o.m2).finished();
    MatrixXd C(3, 2), D = MatrixXd::Zero(3, 2);
    C << o.k, o.c, 1, 0, 0, 1;
    D.row(0) << -o.k, -o.c;
    add("right", mass_on_spring(o.m2, o.k, o.c), by_motion, C, D, o.start.tail<2>(), kMotion,
        {{"force", "N"}, kMotion[0], kMotion[1]});
    master_.connect("left::position", "right::position");
    master_.connect("left::velocity", "right::velocity");
    master_.connect("right::force", "left::force");
    return;
  }
  add("right", mass_on_spring(o.m2, 0, 0), by_force(o.m2), identity, none, o.start.tail<2>(), force_in, kMotion);
  MatrixXd D(2, 4);
  D << force(o), -force(o);
  add("spring", MatrixXd(0, 0), MatrixXd(0, 4), MatrixXd(2, 0), D, Eigen::VectorXd(0),
      {{"left.position", "m"}, {"left.velocity", "m/s"}, {"right.position", "m"}, {"right.velocity", "m/s"}},
      {{"left.force", "N"}, {"right.force", "N"}});
  for (const std::string side : {"left", "right"}) {
    for (const std::string motion : {"position", "velocity"}) master_.connect(side + "::" + motion, "spring::" + side + "." + motion);
  }
  master_.connect("spring::left.force", "left::force");
  master_.connect("spring::right.force", "right::force");
}

Eigen::Vector4d CutOscillator::state() const {
  Eigen::Vector4d state;
  for (int side = 0; side < 2; ++side) {
    const auto at = static_cast<ValueReference>(units_[side]->variables().size() - 2);  // motion comes last
    state[2 * side] = units_[side]->get(at);
    state[2 * side + 1] = units_[side]->get(at + 1);
  }
  return state;
}

std::size_t CutOscillator::unit_steps() const {
  std::size_t steps = 0;
  for (const auto& unit : units_) steps += unit->steps();
  return steps;
}

Matrix4d macro_step(const TwoMassOscillator& oscillator, Cut cut, const std::string& method, double h) {
  const Held held = harness::held(oscillator, cut, h);
  Matrix4d step = held.Phi + held.G;
  if (method == "jacobi") return step;
  if (method == "gauss_seidel") {
    // The spring of the other cut has no state: it tells the same whoever steps first.
    if (cut == Cut::displacement_force) {
      step.bottomRows<2>() = held.right * step.topRows<2>();
      step.bottomRightCorner<2, 2>() += held.Phi.bottomRightCorner<2, 2>();
    }
    return step;
  }
  if (method == "iterated") return (Matrix4d::Identity() - 0.5 * held.G).partialPivLu().solve(held.Phi + 0.5 * held.G);
  throw std::invalid_argument(fmt::format("no theory for master.method \"{}\"", method));
}

// A change of the force at the end changes what is held by half of it, what the left side comes to, and with the other
// cut half of that what the right side holds.
double iteration_factor(const TwoMassOscillator& oscillator, Cut cut, double h) {
  const Held held = harness::held(oscillator, cut, h);
  Eigen::Vector4d change;
  change.head<2>() = 0.5 * held.left;
  if (cut == Cut::displacement_force) change.tail<2>() = 0.5 * held.right * change.head<2>();
  else change.tail<2>() = -0.5 * held.right;
  return force(oscillator).dot(change);
}

double stability_limit(const TwoMassOscillator& oscillator, Cut cut, const std::string& method, double longest) {
  const auto stable = [&](double h) {
    return macro_step(oscillator, cut, method, h).eigenvalues().cwiseAbs().maxCoeff() <= 1;
  };
  constexpr double kRatio = 1.01;  // what is stable again within a hundredth is not looked for
  double low = longest * 1e-6;
  while (low < longest && stable(low * kRatio)) low *= kRatio;
  if (low >= longest) return longest;
  double high = low * kRatio;
  for (int i = 0; i < 40; ++i) (stable(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
  return low;
}

}  // namespace quayside::harness
