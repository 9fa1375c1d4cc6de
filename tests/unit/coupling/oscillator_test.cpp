// Masters on the linear two-mass oscillator: orders, stability limits and convergence, against what can be derived.
#include "harness/coupling/oscillator_study.h"

#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace quayside::harness {
namespace {

// Masses of 2 and 1 kg, of which one can be alone: without the wall's spring only the distance of the masses is moved by the
// spring between them, as a mass of 2/3 kg would be.
TwoMassOscillator free_oscillator() {
  TwoMassOscillator oscillator;
  oscillator.k1 = oscillator.c1 = 0;
  return oscillator;
}
constexpr double kReducedMass = 2.0 / 3;  // [kg]

TEST(TwoMassOscillator, TheExactSolutionMovesAsTheEquationSays) {
  const TwoMassOscillator oscillator;
  constexpr double kDelta = 1e-5;  // [s]; the difference quotient is wrong by its square times a third derivative of 1e3
  for (const double t : {0.3, 2.0}) {
    const Eigen::Vector4d quotient = (oscillator.at(t + kDelta) - oscillator.at(t - kDelta)) / (2 * kDelta);
    EXPECT_LT((quotient - oscillator.dynamics() * oscillator.at(t)).norm(), 1e-6);
  }
  EXPECT_EQ(oscillator.at(0), oscillator.start);
}

// The masters do what the theory's matrices say, to rounding over a hundred steps of 5 ms.
TEST(TwoMassOscillator, MastersMakeTheStepsOfTheTheory) {
  const TwoMassOscillator oscillator;
  constexpr double kStep = 0.005;
  for (const Cut cut : {Cut::displacement_force, Cut::force_force}) {
    for (const std::string method : {"jacobi", "gauss_seidel", "iterated"}) {
      CutOscillator units(oscillator, cut, {method, 1e-14, 1});
      Eigen::Vector4d expected = oscillator.start;
      units.master().initialize(0);
      for (int i = 1; i <= 100; ++i) {
        units.master().advance_to(nanoseconds(i * kStep));
        expected = macro_step(oscillator, cut, method, kStep) * expected;
      }
      EXPECT_LT((units.state() - expected).norm(), 1e-12) << to_string(cut) << " " << method;
    }
  }
}

// A held input is wrong by h within a step, and the state by h² at its end, which adds up to h; a mean of both ends by h²,
// h³ and h². The steps from 3.1 to 0.39 ms resolve the faster mode (17 rad/s) by a hundred points and more, so the order
// that two runs show is off by less than 0.1.
TEST(Masters, HaveTheirOrders) {
  const TwoMassOscillator oscillator;
  for (const Cut cut : {Cut::displacement_force, Cut::force_force}) {
    for (const auto& [method, order] : {std::pair("jacobi", 1), {"gauss_seidel", 1}, {"iterated", 2}}) {
      for (const double step : {0.1 / 32, 0.1 / 64, 0.1 / 128}) {
        const double error = oscillator_run(oscillator, cut, {method, 1e-13, 1}, step).error;
        const double half = oscillator_run(oscillator, cut, {method, 1e-13, 1}, step / 2).error;
        EXPECT_NEAR(std::log2(error / half), order, 0.1) << to_string(cut) << " " << method << " " << step;
      }
    }
  }
}

// The error of a step goes with h², so steps are as the root of the tolerance, and so is the error in the end (order one in
// the step): a hundredth of the tolerance for a tenth of the error, at ten times the steps. Both to a third, since steps end
// at communication points and the scale of each value is what it has been so far.
TEST(Masters, ErrorControlKeepsWhatItIsAskedFor) {
  const TwoMassOscillator oscillator;
  for (const Cut cut : {Cut::displacement_force, Cut::force_force}) {
    const OscillatorPoint coarse = oscillator_run(oscillator, cut, {"error_controlled", 1e-4, 1}, 0.1);
    const OscillatorPoint fine = oscillator_run(oscillator, cut, {"error_controlled", 1e-6, 1}, 0.1);
    EXPECT_NEAR(std::log10(coarse.error / fine.error), 1, 0.13) << to_string(cut);
    EXPECT_NEAR(std::log10(static_cast<double>(fine.unit_steps) / static_cast<double>(coarse.unit_steps)), 1, 0.13);
    // Some 1e4 steps in which 1e-6 may go wrong [m].
    EXPECT_LT(fine.error, 1e4 * 1e-6 * 2 * oscillator.start.norm());
  }
}

// Between mass and spring alone a held force makes, with a = ω²h² and b = 2ζωh,
//   x' = x + h v − ½ h² (ω² x + 2ζω v),  v' = v − h (ω² x + 2ζω v):  trace 2 − a/2 − b, determinant 1 + a/2 − b.
// Both eigenvalues stay within the circle while determinant < 1 and 1 + trace + determinant > 0: ω h < 4ζ and b < 2. What
// holds for the matrix has to hold for the master as well; the search for it ends within a hundredth.
TEST(Masters, AreStableUpToTheLimitOfTheTheory) {
  TwoMassOscillator oscillator = free_oscillator();
  oscillator.start = {0.1, 0, -0.2, 0};  // the centre of mass at rest at 0: it would stay where it is, not die away
  const double omega = std::sqrt(oscillator.k / kReducedMass);
  const auto zeta = [&] { return oscillator.c / (2 * kReducedMass * omega); };
  for (const double c : {2.0, 25.0}) {  // limited by the determinant, by the trace
    oscillator.c = c;
    const double limit = std::min(4 * zeta() / omega, 1 / (zeta() * omega));
    for (const char* method : {"jacobi", "gauss_seidel"}) {
      EXPECT_TRUE(dies_away(oscillator, Cut::force_force, {method}, 0.99 * limit)) << method << " " << c;
      EXPECT_FALSE(dies_away(oscillator, Cut::force_force, {method}, 1.01 * limit)) << method << " " << c;
    }
  }
}

// With a wall there is no formula, but the eigenvalues of the same step.
TEST(Masters, AreStableUpToTheLimitOfTheirEigenvalues) {
  const TwoMassOscillator oscillator;
  for (const Cut cut : {Cut::displacement_force, Cut::force_force}) {
    for (const char* method : {"jacobi", "gauss_seidel"}) {
      const double limit = stability_limit(oscillator, cut, method, 1);
      EXPECT_LT(limit, 1);
      EXPECT_TRUE(dies_away(oscillator, cut, {method}, 0.99 * limit)) << to_string(cut) << " " << method << " " << limit;
      EXPECT_FALSE(dies_away(oscillator, cut, {method}, 1.01 * limit)) << to_string(cut) << " " << method << " " << limit;
    }
  }
}

// Who steps second knows the end of the step, and holds it from the beginning: it sees the motion h/2 too early, where with
// Jacobi it is h/2 too late. In the slow mode, in which both masses move as one, the spring between them so pulls with
// ∓k h/2 times the speed, and the force that arrives h/2 late adds m2 ω² h/2. Gauss-Seidel is stable until that has used up
// the wall's damping: c1 = (k − m2 ω²) h/2 with ω² = k1/(m1 + m2). To 2 %: the masses do not quite move as one (k1/k).
TEST(Masters, SteppingSecondCanBeWorseThanKnowingNothing) {
  const TwoMassOscillator o;
  const double limit = 2 * o.c1 / (o.k - o.m2 * o.k1 / (o.m1 + o.m2));
  EXPECT_NEAR(stability_limit(o, Cut::displacement_force, "gauss_seidel", 1) / limit, 1, 0.02);
  EXPECT_GT(stability_limit(o, Cut::displacement_force, "jacobi", 1), 10 * limit);
}

// Held at the mean of both ends, the force between mass and spring makes the trapezoidal rule: without damping the energy of
// the free oscillator stays as it is, however long the step. Rounding, and an iteration to 1e-14, over 1000 steps: 1e-10.
TEST(Masters, TheIterationKeepsEnergy) {
  TwoMassOscillator oscillator = free_oscillator();
  oscillator.c = 0;
  oscillator.start = {0.1, 0, -0.2, 0};
  const auto energy = [&](const Eigen::Vector4d& z) {
    return 0.5 * (oscillator.m1 * z[1] * z[1] + oscillator.m2 * z[3] * z[3] + oscillator.k * (z[2] - z[0]) * (z[2] - z[0]));
  };
  CutOscillator units(oscillator, Cut::force_force, {"iterated", 1e-14, 1});
  units.master().initialize(0);
  for (int i = 1; i <= 1000; ++i) units.master().advance_to(nanoseconds(i * 0.05));  // ω h = 0.87
  EXPECT_NEAR(energy(units.state()) / energy(oscillator.start), 1, 1e-10);

  // Held forces gain: the determinant says 1 + a/2 a step, which is (1 + a/2)^n of the energy after n steps.
  CutOscillator explicit_units(oscillator, Cut::force_force, {"jacobi"});
  explicit_units.master().initialize(0);
  constexpr double kStep = 0.002;
  for (int i = 1; i <= 1000; ++i) explicit_units.master().advance_to(nanoseconds(i * kStep));
  const double a = oscillator.k / kReducedMass * kStep * kStep;
  // The energy of a discrete motion swings by √a/2 about the invariant of the matrix.
  EXPECT_NEAR(std::log(energy(explicit_units.state()) / energy(oscillator.start)), 1000 * std::log1p(a / 2), std::sqrt(a));
}

// In a round the force at the end changes by −(a/4 + b/2) times what it was changed by: half of it is held, which moves the
// mass by h²/4m and its speed by h/2m. Relaxed by r, the factor is 1 − r (1 + a/4 + b/2).
TEST(Masters, IterationsConvergeUpToTheLimitAndFurtherWithRelaxation) {
  TwoMassOscillator oscillator = free_oscillator();
  const double omega = std::sqrt(oscillator.k / kReducedMass);
  const auto factor = [&](double h) { return omega * omega * h * h / 4 + oscillator.c / kReducedMass * h / 2; };
  for (const double h : {0.01, 0.1}) EXPECT_NEAR(iteration_factor(oscillator, Cut::force_force, h), -factor(h), 1e-12);
  const auto converges = [&](double h, double relaxation) {
    return std::isfinite(oscillator_run(oscillator, Cut::force_force, {"iterated", 1e-6, relaxation}, h).error);
  };
  // 0.75 of the last error in every round is 1e-6 after 48 rounds. Steps in s with factors of 0.7, 1.1 and 2.9.
  const auto step_for = [&](double wanted) {
    double h = 0;
    while (factor(h) < wanted) h += 1e-5;
    return h;
  };
  EXPECT_TRUE(converges(step_for(0.7), 1));
  EXPECT_FALSE(converges(step_for(1.1), 1));
  EXPECT_TRUE(converges(step_for(1.1), 0.5));   // 1 − 0.5 × 2.1
  EXPECT_FALSE(converges(step_for(2.9), 0.6));  // 1 − 0.6 × 3.9 = −1.34
  EXPECT_TRUE(converges(step_for(2.9), 0.3));   // −0.17
}

}  // namespace
}  // namespace quayside::harness
