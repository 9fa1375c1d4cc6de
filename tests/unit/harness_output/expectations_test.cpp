#include "harness/expectations.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/harness_output/hand_made_run.h"

namespace quayside::harness {
namespace {

using cases::Expectation;

Expectation value_expectation(const std::string& signal, Expectation::Moment moment, double value, double tolerance) {
  Expectation expected;
  expected.signal = signal;
  expected.moment = moment;
  expected.value = value;
  expected.tolerance = tolerance;
  expected.line = 12;
  return expected;
}

ExpectationResult evaluated(const Expectation& expected, RunResult run) {
  run.description.expectations = {expected};
  return evaluate_expectations(run).at(0);
}

RunResult both() { return hand_made_run({sinking_load("simbody"), sinking_load("mujoco", 0.25, 0.1)}); }

struct ValueCase {
  const char* signal;
  Expectation::Moment moment;
  double time, value;
};

// z = 1 − 0.1 t over 10 s; the velocity (0, 0.3, −0.4) counts by its norm.
class ValueExpectation : public testing::TestWithParam<ValueCase> {};

TEST_P(ValueExpectation, HoldsAtItsValueAndFailsBesideIt) {
  const ValueCase& known = GetParam();
  Expectation expected = value_expectation(known.signal, known.moment, known.value, 1e-9);
  expected.time = known.time;
  const ExpectationResult right = evaluated(expected, both());
  EXPECT_EQ(right.verdict, Verdict::passed) << right.text << ": " << right.finding;
  ASSERT_TRUE(right.measured);
  EXPECT_NEAR(*right.measured, known.value, 1e-9);

  expected.value = known.value + 1e-6;
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::failed);
}

INSTANTIATE_TEST_SUITE_P(Moments, ValueExpectation,
                         testing::Values(ValueCase{"load.position.z", Expectation::Moment::end, 0, 0},
                                         ValueCase{"load.position.z", Expectation::Moment::time, 2.55, 0.745},
                                         ValueCase{"load.position.z", Expectation::Moment::minimum, 0, 0},
                                         ValueCase{"load.position.z", Expectation::Moment::maximum, 0, 1},
                                         ValueCase{"load.velocity", Expectation::Moment::maximum, 0, 0.5}));

TEST(Expectations, BoundsBelowAndAbove) {
  Expectation expected;
  expected.signal = "load.position.z";
  expected.moment = Expectation::Moment::time;
  expected.time = 5;  // 0.5 m
  expected.below = 0.6;
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::passed);
  expected.above = 0.55;
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::failed);
  expected.above = 0.4;
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::passed);
  expected.below = 0.45;
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::failed);
}

TEST(Expectations, OfAnotherEngine) {
  Expectation expected = value_expectation("load.position.x", Expectation::Moment::end, 0.25, 1e-9);
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::failed);
  expected.engine = "mujoco";
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::passed);
}

TEST(Expectations, ComparisonOfTwoEngines) {
  Expectation expected;
  expected.kind = Expectation::Kind::comparison;
  expected.compare = "mujoco";
  expected.signal = "load.position";
  expected.rms = 0.26;
  ExpectationResult result = evaluated(expected, both());
  EXPECT_EQ(result.verdict, Verdict::passed);
  EXPECT_NEAR(result.measured.value(), 0.25, 1e-12);
  expected.rms = 0.24;
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::failed);
  expected.rms.reset();
  expected.max = 0.26;
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::passed);
  expected.max = 0.24;
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::failed);
}

TEST(Expectations, FirstEventWithinItsWindow) {
  Expectation expected;
  expected.kind = Expectation::Kind::event;
  expected.event = "contact_broken";
  expected.earliest = 6.95;
  expected.latest = 7.05;
  ExpectationResult result = evaluated(expected, both());
  EXPECT_EQ(result.verdict, Verdict::passed) << result.finding;
  EXPECT_NEAR(result.measured.value(), 7.0, 1e-9);

  expected.subject = "upper/load";  // either way round
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::passed);
  expected.subject = "load/lower";
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::failed);  // open at the end: not broken
  expected.subject = "";
  expected.engine = "mujoco";  // 0.1 s later
  EXPECT_EQ(evaluated(expected, both()).verdict, Verdict::failed);
  expected.event = "lock_opened";
  EXPECT_EQ(evaluated(expected, both()).finding, "did not happen");
}

TEST(Expectations, OfAnEngineThatWasNotRunAreNotChecked) {
  const RunResult alone = hand_made_run({sinking_load("simbody")});
  Expectation expected;
  expected.kind = Expectation::Kind::comparison;
  expected.compare = "mujoco";
  expected.signal = "load.position";
  expected.rms = 1;
  const ExpectationResult result = evaluated(expected, alone);
  EXPECT_EQ(result.verdict, Verdict::not_checked);
  EXPECT_FALSE(result.measured);
  EXPECT_EQ(result.finding, "mujoco was not run");

  Expectation value = value_expectation("load.position.z", Expectation::Moment::end, 0, 1);
  value.engine = "mujoco_same_law";
  EXPECT_EQ(evaluated(value, alone).verdict, Verdict::not_checked);
}

TEST(Expectations, OfAnEngineThatStoppedHaveFailed) {
  EngineRun stopped = sinking_load("simbody");
  stopped.failure = "a reason";
  stopped.simulated_s = 3.25;
  const ExpectationResult result =
      evaluated(value_expectation("load.position.z", Expectation::Moment::maximum, 1, 1e-9), hand_made_run({stopped}));
  EXPECT_EQ(result.verdict, Verdict::failed);
  EXPECT_EQ(result.finding, "simbody stopped at 3.25 s");
}

TEST(Expectations, OfAnInterruptedRunAreNotChecked) {
  RunResult run = both();
  run.interrupted = true;
  EXPECT_EQ(evaluated(value_expectation("load.position.z", Expectation::Moment::end, 0, 1), run).verdict, Verdict::not_checked);
}

TEST(Expectations, ANumberThatIsNoneFailsEveryBound) {
  EngineRun blown_up = sinking_load("simbody");
  for (auto& column : blown_up.trajectory.columns) column[50] = std::numeric_limits<double>::quiet_NaN();
  Expectation expected;
  expected.signal = "load.position.z";
  expected.moment = Expectation::Moment::maximum;
  expected.below = 1e9;
  EXPECT_EQ(evaluated(expected, hand_made_run({blown_up})).verdict, Verdict::failed);
  expected.below.reset();
  expected.above = -1e9;
  EXPECT_EQ(evaluated(expected, hand_made_run({blown_up})).verdict, Verdict::failed);
  expected.kind = Expectation::Kind::comparison;
  expected.compare = "mujoco";
  expected.rms = 1e9;
  EXPECT_EQ(evaluated(expected, hand_made_run({blown_up, sinking_load("mujoco")})).verdict, Verdict::failed);
}

TEST(Expectations, ASignalThatWasNotRecordedHasFailedWithItsName) {
  const ExpectationResult result =
      evaluated(value_expectation("load.positon.z", Expectation::Moment::end, 0, 1), both());
  EXPECT_EQ(result.verdict, Verdict::failed);
  EXPECT_NE(result.finding.find("load.position.z"), std::string::npos) << result.finding;
}

TEST(Expectations, ATimeThatWasNotRecordedHasFailed) {
  Expectation expected = value_expectation("load.position.z", Expectation::Moment::time, 0, 10);
  expected.time = 10.5;
  const ExpectationResult result = evaluated(expected, both());
  EXPECT_EQ(result.verdict, Verdict::failed);
  EXPECT_FALSE(result.measured);
}

TEST(Expectations, AreToldInOneLineWithTheirUnit) {
  Expectation expected = value_expectation("load.position.z", Expectation::Moment::end, 0.002, 0.005);
  expected.why = "half a stack";
  const ExpectationResult result = evaluated(expected, both());
  EXPECT_EQ(result.text, "simbody: load.position.z at the end = 0.002 ± 0.005 m");
  EXPECT_EQ(result.why, "half a stack");
  EXPECT_EQ(result.line, 12);
}

TEST(CheckExpectations, RefusesSignalsThatARunWillNotHave) {
  cases::Case description;
  description.file = "cases/x.yaml";
  const std::vector<std::string> signals{"load.position.x", "load.position.y", "load.position.z", "hoist.value"};
  description.expectations = {value_expectation("load.position", Expectation::Moment::end, 0, 1),
                              value_expectation("hoist.value", Expectation::Moment::end, 0, 1)};
  EXPECT_NO_THROW(check_expectations(description, signals));
  description.expectations.push_back(value_expectation("load.position.q", Expectation::Moment::end, 0, 1));
  try {
    check_expectations(description, signals);
    FAIL() << "accepted";
  } catch (const cases::CaseError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind("cases/x.yaml:12: expect.2.signal: found 'load.position.q'", 0), 0u) << message;
    EXPECT_NE(message.find("load.position.x"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace quayside::harness
