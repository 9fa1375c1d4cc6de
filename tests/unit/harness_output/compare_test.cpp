#include "harness/compare.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/harness_output/hand_made_run.h"

namespace quayside::harness {
namespace {

constexpr double kRounding = 1e-12;  // of sums over some hundred samples of order 1

const SignalDifference& find(const TrajectoryComparison& comparison, const std::string& name) {
  for (const SignalDifference& signal : comparison.signals)
    if (signal.signal == name) return signal;
  throw std::out_of_range(name);
}

// A sin(ωt + φ) − A sin(ωt) = 2A sin(φ/2) cos(ωt + φ/2). Over whole periods the mean of cos² is ½, and the trapezoidal rule
// is exact for it. The largest sample misses the crest by at most half a step: 1 − cos(ω dt / 2) of it.
TEST(CompareTrajectories, SinesWithAPhaseAreApartAsTrigonometrySays) {
  const double amplitude = 3, omega = 2 * M_PI, phase = 0.2;
  const int steps = 400;
  const auto times = evenly(0, 2, steps);
  const Recording a = recorded(times, {{"s", "m", [=](double t) { return amplitude * std::sin(omega * t); }}});
  const Recording b = recorded(times, {{"s", "m", [=](double t) { return amplitude * std::sin(omega * t + phase); }}});
  const TrajectoryComparison comparison = compare_trajectories(a, b);
  ASSERT_EQ(comparison.signals.size(), 1u);
  const SignalDifference& s = comparison.signals[0];
  const double crest = 2 * amplitude * std::sin(phase / 2);
  EXPECT_NEAR(s.rms, crest / std::sqrt(2.0), kRounding);
  EXPECT_LE(s.max, crest + kRounding);
  EXPECT_GE(s.max, crest * std::cos(omega * 2 / steps / 2) - kRounding);
  EXPECT_NEAR(s.end, crest * std::cos(phase / 2), kRounding);
  EXPECT_EQ(s.unit, "m");
  EXPECT_EQ(comparison.samples, times.size());
}

TEST(CompareTrajectories, VectorsAreComparedByTheNormOfTheDifference) {
  const auto times = evenly(0, 1, 10);
  const auto vector = [&](double x, double y, double z) {
    return recorded(times, {{"p.x", "m", constant(x)}, {"p.y", "m", constant(y)}, {"p.z", "m", constant(z)}});
  };
  const TrajectoryComparison comparison = compare_trajectories(vector(1, 2, 3), vector(4, 2, -1));  // (3, 0, -4)
  ASSERT_EQ(comparison.signals.size(), 1u);
  EXPECT_EQ(comparison.signals[0].signal, "p");
  EXPECT_NEAR(comparison.signals[0].rms, 5, kRounding);
  EXPECT_NEAR(comparison.signals[0].max, 5, kRounding);
  EXPECT_NEAR(comparison.signals[0].end, 5, kRounding);
}

Recording turning(const std::vector<double>& times, double rate, double offset, bool flips) {
  // About the axis (1, 2, 2)/3 by rate·t + offset; q and −q in turns where `flips`.
  const auto sign = [=](double t) { return flips && std::lround(10 * t) % 2 ? -1.0 : 1.0; };
  const auto angle = [=](double t) { return (rate * t + offset) / 2; };
  return recorded(times, {{"q.w", "1", [=](double t) { return sign(t) * std::cos(angle(t)); }},
                          {"q.x", "1", [=](double t) { return sign(t) * std::sin(angle(t)) / 3; }},
                          {"q.y", "1", [=](double t) { return sign(t) * std::sin(angle(t)) * 2 / 3; }},
                          {"q.z", "1", [=](double t) { return sign(t) * std::sin(angle(t)) * 2 / 3; }}});
}

TEST(CompareTrajectories, OrientationsAreComparedByTheAngleBetweenThem) {
  const auto times = evenly(0, 1, 10);
  const TrajectoryComparison comparison = compare_trajectories(turning(times, 1, 0, false), turning(times, 1, 1e-7, true));
  ASSERT_EQ(comparison.signals.size(), 1u);
  EXPECT_EQ(comparison.signals[0].unit, "rad");
  EXPECT_NEAR(comparison.signals[0].rms, 1e-7, 1e-15);  // rounding of the components, 1e-16 each
  EXPECT_NEAR(comparison.signals[0].max, 1e-7, 1e-15);
}

// Between two samples 0.1 rad apart the straight line between quaternions, made a unit again, leaves the great circle's
// angle by less than θ³/24 of each half angle: 0.05³/24 · 2 ≈ 1e-5; without care for the sign it would be wrong by π.
TEST(CompareTrajectories, OrientationsOfEitherSignAreInterpolated) {
  const Recording fine = turning(evenly(0, 1, 100), 1, 0, false);
  const Recording coarse_but_shifted = turning({0, 0.25, 0.5, 0.75, 1}, 1, 0, false);
  const Recording flipping = turning(evenly(0, 1, 10), 1, 0, true);
  EXPECT_LT(find(compare_trajectories(fine, flipping), "q").max, kRounding);  // the rows of the coarser one
  EXPECT_LT(find(compare_trajectories(flipping, coarse_but_shifted), "q").max, 1e-5);
}

// Straight lines are interpolated exactly, whatever the rows; the rows of the coarser recording count.
TEST(CompareTrajectories, InterpolatesOnTheRowsOfTheCoarserRecording) {
  const auto line = [](double t) { return 2 * t - 1; };
  const Recording run = recorded(evenly(0, 10, 1000), {{"s", "m", line}});
  const Recording measured = recorded({-1, 0.123, 3.3331, 7.77, 12}, {{"s", "m", [&](double t) { return line(t) + 0.5; }}});
  for (const auto& comparison : {compare_trajectories(run, measured), compare_trajectories(measured, run)}) {
    EXPECT_EQ(comparison.samples, 3u);
    EXPECT_EQ(comparison.from, 0);
    EXPECT_EQ(comparison.to, 10);
    EXPECT_NEAR(find(comparison, "s").rms, 0.5, kRounding);
    EXPECT_NEAR(find(comparison, "s").max, 0.5, kRounding);
  }
}

// A difference of 1 during the first second, none during nine more: the mean square is 1/10, however densely the first
// second was recorded. The trapezoidal rule adds half a square over the gap of 1e-3 s in between.
TEST(CompareTrajectories, MeansAreOverTimeNotOverRows) {
  std::vector<double> times = evenly(0, 1, 500);
  for (const double t : evenly(1.001, 10, 4)) times.push_back(t);
  const Recording a = recorded(times, {{"s", "m", constant(0)}});
  const Recording b = recorded(times, {{"s", "m", [](double t) { return t <= 1 ? 1.0 : 0.0; }}});
  EXPECT_NEAR(find(compare_trajectories(a, b), "s").rms, std::sqrt((1 + 0.5e-3) / 10), kRounding);
}

TEST(CompareTrajectories, AVectorThatLacksAComponentFallsApart) {
  const auto times = evenly(0, 1, 4);
  const Recording run = recorded(times, {{"p.x", "m", constant(1)}, {"p.y", "m", constant(1)}, {"p.z", "m", constant(1)}});
  const Recording measured = recorded(times, {{"p.z", "m", constant(3)}, {"p.x", "m", constant(2)}, {"other", "m", constant(0)}});
  const TrajectoryComparison comparison = compare_trajectories(run, measured);
  ASSERT_EQ(comparison.signals.size(), 2u);
  EXPECT_NEAR(find(comparison, "p.x").max, 1, kRounding);
  EXPECT_NEAR(find(comparison, "p.z").max, 2, kRounding);
}

TEST(CompareTrajectories, WithoutCommonTimeThereIsNothing) {
  const Recording a = recorded(evenly(0, 1, 4), {{"s", "m", constant(0)}});
  const Recording b = recorded(evenly(2, 3, 4), {{"s", "m", constant(0)}});
  EXPECT_EQ(compare_trajectories(a, b).samples, 0u);
  EXPECT_EQ(compare_trajectories(a, Recording{}).samples, 0u);
  EXPECT_THROW(compare_signal(a, b, "s"), std::invalid_argument);
}

TEST(CompareTrajectories, ANumberThatIsNoneIsNotLost) {
  const auto times = evenly(0, 1, 4);
  const Recording a = recorded(times, {{"s", "m", constant(0)}});
  const Recording b = recorded(times, {{"s", "m", [](double t) {
                                          return t == 0.5 ? std::numeric_limits<double>::quiet_NaN() : 1.0;
                                        }}});
  const SignalDifference s = compare_signal(a, b, "s");
  EXPECT_TRUE(std::isnan(s.max));
  EXPECT_TRUE(std::isnan(s.rms));
  EXPECT_EQ(s.max_time, 0.5);
}

TEST(CompareSignal, KnowsVectorsByTheirNameAndTellsWhatIsMissing) {
  const EngineRun a = sinking_load("simbody"), b = sinking_load("mujoco", 0.25);
  EXPECT_NEAR(compare_signal(a.trajectory, b.trajectory, "load.position").rms, 0.25, kRounding);
  EXPECT_NEAR(compare_signal(a.trajectory, b.trajectory, "load.position.x").rms, 0.25, kRounding);
  EXPECT_NEAR(compare_signal(a.trajectory, b.trajectory, "load.position.z").rms, 0, kRounding);
  EXPECT_EQ(compare_signal(a.trajectory, b.trajectory, "load.orientation").unit, "rad");
  EXPECT_THROW(compare_signal(a.trajectory, b.trajectory, "load.positon"), std::out_of_range);
}

TEST(CompareEvents, PairsHaveShiftAndDifferences) {
  const std::vector<Event> a{event_at(1.0, EventKind::contact_broken, "load/upper", 100, 2000, 0.1)};
  const std::vector<Event> b{event_at(1.25, EventKind::contact_broken, "load/upper", 90, 2500, 0.1)};
  const EventComparison comparison = compare_events(a, b);
  ASSERT_EQ(comparison.pairs.size(), 1u);
  EXPECT_NEAR(comparison.pairs[0].time_shift(), 0.25, kRounding);
  EXPECT_NEAR(comparison.pairs[0].impulse_difference(), -10, kRounding);
  EXPECT_NEAR(comparison.pairs[0].peak_force_difference(), 500, kRounding);
  EXPECT_TRUE(comparison.only_a.empty());
  EXPECT_TRUE(comparison.only_b.empty());
}

TEST(CompareEvents, KindAndSubjectHaveToAgree) {
  const std::vector<Event> a{event_at(1, EventKind::rope_slack, "rope.left"), event_at(2, EventKind::rope_taut, "rope.left")};
  const std::vector<Event> b{event_at(1, EventKind::rope_slack, "rope.right"), event_at(2, EventKind::rope_taut, "rope.left")};
  const EventComparison comparison = compare_events(a, b);
  ASSERT_EQ(comparison.pairs.size(), 1u);
  EXPECT_EQ(comparison.pairs[0].a.kind, EventKind::rope_taut);
  EXPECT_EQ(comparison.only_a.size(), 1u);
  EXPECT_EQ(comparison.only_b.size(), 1u);
}

// One run has a short touch more at the beginning: the bounces after it keep their partners.
TEST(CompareEvents, ATouchMoreShiftsNoOther) {
  std::vector<Event> a, b{event_at(0.2, EventKind::contact_made, "box/ground")};
  for (const double t : {1.0, 2.0, 3.0}) {
    a.push_back(event_at(t, EventKind::contact_made, "box/ground"));
    b.push_back(event_at(t + 0.01, EventKind::contact_made, "box/ground"));
  }
  const EventComparison comparison = compare_events(a, b);
  ASSERT_EQ(comparison.pairs.size(), 3u);
  for (const EventPair& pair : comparison.pairs) EXPECT_NEAR(pair.time_shift(), 0.01, kRounding);
  ASSERT_EQ(comparison.only_b.size(), 1u);
  EXPECT_EQ(comparison.only_b[0].time, nanoseconds(0.2));
}

TEST(CompareEngines, ContactsStillMadeTakePart) {
  EngineRun a = sinking_load("simbody"), b = sinking_load("mujoco", 0, 0.02);
  b.open_contacts[0].peak_force += 1000;
  const EngineComparison comparison = compare_engines(a, b);
  EXPECT_EQ(comparison.reference, "simbody");
  EXPECT_EQ(comparison.engine, "mujoco");
  ASSERT_EQ(comparison.events.pairs.size(), 5u);
  EXPECT_NEAR(comparison.events.pairs[1].time_shift(), 0.02, kRounding);
  EXPECT_NEAR(comparison.events.pairs[4].peak_force_difference(), 1000, kRounding);
}

}  // namespace
}  // namespace quayside::harness
