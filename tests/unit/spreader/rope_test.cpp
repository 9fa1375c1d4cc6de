#include "spreader/rope.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace quayside::spreader {
namespace {

Rope hoist_rope() {
  Rope rope;
  rope.name = "rope";
  rope.axial_stiffness = 84e6;
  rope.damping_time = 0.01;
  return rope;
}

TEST(Rope, HangsAtItsStretch) {
  // T = EA x / L0: 84 MN over 20 m is 4.2 MN/m, so 10 mm of stretch pull with 42 kN and store ½·42 kN·10 mm = 210 J.
  const RopeTension state = rope_tension(hoist_rope(), 20.01, 0, 20, 0);
  EXPECT_NEAR(state.tension, 42e3, 1e-6);  // 20.01 − 20 is exact to 4e-15 m, times 4.2e6 N/m
  EXPECT_NEAR(state.energy, 210, 1e-7);
  EXPECT_EQ(state.work_in, 0);
  EXPECT_EQ(state.dissipated_power, 0);
}

TEST(Rope, IsSlackAtItsRestLengthHoweverFastItMoves) {
  const RopeTension state = rope_tension(hoist_rope(), 20, 3, 20, -1);
  EXPECT_EQ(state.tension, 0);
  EXPECT_EQ(state.dissipated_power, 0);
  EXPECT_EQ(rope_tension(hoist_rope(), 19, -3, 20, 0).stretch, -1);
}

TEST(Rope, CatchesWithoutAJump) {
  // A rope that is stretched at 1 m/s: between two stretches a micrometre apart the tension changes by no more than the
  // steepest slope allows, k + c·1.5/ramp·v (1.5: the smooth ramp's steepest slope).
  const Rope rope = hoist_rope();
  const double rest = 20, speed = 1, step = 1e-6;
  const double k = rope.axial_stiffness / rest, c = rope.damping_time * k;
  const double steepest = k + 1.5 * c * speed / kDampingRamp;
  double before = 0;
  for (double x = -10 * step; x < 2 * kDampingRamp; x += step) {
    const double tension = rope_tension(rope, rest + x, speed, rest, 0).tension;
    EXPECT_LE(std::abs(tension - before), 1.01 * steepest * step) << "at a stretch of " << x;
    before = tension;
  }
}

TEST(Rope, NeitherPushesNorCreatesEnergy) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> rest(1, 40), stretch(-0.02, 0.1), rate(-5, 5);
  for (int i = 0; i < 100000; ++i) {
    const double L0 = rest(random);
    const RopeTension state = rope_tension(hoist_rope(), L0 + stretch(random), rate(random), L0, rate(random));
    EXPECT_GE(state.tension, 0);
    EXPECT_GE(state.dissipated_power, 0);
  }
}

TEST(Rope, AccountsForAllOfItsEnergy) {
  // What goes in at the ends and at the drum is stored or dissipated: T l̇ + work_in = dU/dt + dissipated. Central
  // differences of U over ±1 µs: U is quadratic in the lengths but for 1/L0, whose part of the error, h² U‴, is 1e-9 W.
  // Rounding leaves ε l k x / h ≈ 1e-16·40 m·T / (1e-6 s), which is 1e-9 of the scale of 4 m/s times T.
  std::mt19937 random(2);
  std::uniform_real_distribution<double> rest(5, 40), stretch(1e-5, 0.1), rate(-2, 2);
  const double h = 1e-6;
  for (int i = 0; i < 10000; ++i) {
    const double L0 = rest(random), l = L0 + stretch(random), L0_rate = rate(random), l_rate = rate(random);
    const auto energy = [&](double t) {
      return rope_tension(hoist_rope(), l + l_rate * t, l_rate, L0 + L0_rate * t, L0_rate).energy;
    };
    const RopeTension state = rope_tension(hoist_rope(), l, l_rate, L0, L0_rate);
    const double energy_rate = (energy(h) - energy(-h)) / (2 * h);
    const double scale = std::max(1e3, state.tension * 4);
    EXPECT_NEAR(state.tension * l_rate + state.work_in, energy_rate + state.dissipated_power, 1e-5 * scale);
  }
}

TEST(Rope, ARestLengthThatIsGoneIsNotANumber) {
  EXPECT_TRUE(std::isnan(rope_tension(hoist_rope(), 1, 0, 0, 0).tension));
  EXPECT_TRUE(std::isnan(rope_tension(hoist_rope(), 1, 0, -1, 0).energy));
}

}  // namespace
}  // namespace quayside::spreader
