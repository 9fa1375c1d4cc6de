// Every integrator on one problem with a known answer, through one interface.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/simbody/oscillator.h"

namespace quayside::harness {
namespace {

constexpr double kTolerance = 1e-8;
// Local errors of 1e-8 a step add up over some hundred steps of a neutral oscillator; RMS norms and relative parts of
// the tolerances leave a factor between the libraries.
constexpr double kError = 1e-5;

class EveryIntegrator : public ::testing::TestWithParam<std::string> {
 protected:
  Oscillator oscillator;
  std::unique_ptr<Integrator> integrator = make_integrator(GetParam(), oscillator, {{kTolerance, kTolerance}, 1, 0});
  double y[2] = {1, 0}, z[1] = {0};

  void expect_exact(double t) {
    integrator->interpolate(t, y, z);
    EXPECT_NEAR(y[0], std::cos(t), kError) << "at " << t;
    EXPECT_NEAR(y[1], -std::sin(t), kError) << "at " << t;
    EXPECT_NEAR(z[0], std::sin(t), kError) << "at " << t;
  }
};

TEST_P(EveryIntegrator, FollowsTheSolutionAtAndBetweenItsSteps) {
  integrator->restart(0, y, z, Integrator::kHighestOrder);
  while (integrator->time() < 5) {
    integrator->step(1e9);
    ASSERT_LT(integrator->step_begin(), integrator->time());
    for (const double part : {0.0, 0.3, 0.7, 1.0}) {
      expect_exact((1 - part) * integrator->step_begin() + part * integrator->time());
    }
  }
  EXPECT_GT(integrator->steps(), 10u);
}

TEST_P(EveryIntegrator, StopsWhereItIsToldAndGoesOn) {
  integrator->restart(0, y, z, Integrator::kHighestOrder);
  for (const double stop : {0.1, 0.1001, 1.0, 2.5}) {
    while (integrator->time() < stop) ASSERT_LE(integrator->step(stop), stop);
    EXPECT_EQ(integrator->time(), stop);
    expect_exact(stop);
  }
}

TEST_P(EveryIntegrator, StartsAnewFromAnyPoint) {
  integrator->restart(0, y, z, Integrator::kHighestOrder);
  while (integrator->time() < 1) integrator->step(1e9);
  y[0] = std::cos(7);
  y[1] = -std::sin(7);
  z[0] = std::sin(7);
  integrator->restart(7, y, z, 2);
  expect_exact(7);
  while (integrator->time() < 8) integrator->step(1e9);
  expect_exact(integrator->time());
}

TEST_P(EveryIntegrator, RepeatsItselfToTheLastBit) {
  double first = 0;
  for (const bool again : {false, true}) {
    const double y_start[] = {1, 0}, z_start[] = {0};
    integrator->restart(0, y_start, z_start, Integrator::kHighestOrder);
    for (int i = 0; i < 20; ++i) integrator->step(1e9);
    integrator->interpolate(integrator->time(), y, z);
    if (again) {
      EXPECT_EQ(y[0], first);
    }
    first = y[0];
  }
}

TEST_P(EveryIntegrator, FailsInWordsWhereNothingIsFinite) {
  oscillator.broken_after = 1;
  integrator->restart(0, y, z, Integrator::kHighestOrder);
  EXPECT_THROW(
      while (integrator->time() < 2) integrator->step(1e9), IntegrationFailed);
  EXPECT_LE(integrator->time(), 1);
  EXPECT_GT(integrator->time(), 0.5);
  expect_exact(integrator->time());  // still there
}

TEST_P(EveryIntegrator, LetsExceptionsThrough) {
  oscillator.thrown_after = 1;
  integrator->restart(0, y, z, Integrator::kHighestOrder);
  EXPECT_THROW(
      while (integrator->time() < 2) integrator->step(1e9), std::logic_error);
}

INSTANTIATE_TEST_SUITE_P(All, EveryIntegrator,
                         ::testing::Values("bdf", "adams", "erk", "dirk", "merson", "feldberg", "rk3", "cpodes"),
                         [](const auto& name) { return name.param; });

TEST(MakeIntegrator, NamesWhatThereIs) {
  Oscillator oscillator;
  try {
    make_integrator("euler", oscillator, {{1, 1}, 0, 0});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("cpodes"), std::string::npos);
  }
}

}  // namespace
}  // namespace quayside::harness
