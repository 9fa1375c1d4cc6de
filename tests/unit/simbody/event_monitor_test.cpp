// The monitor on signals that are known functions of time; no engine behind it.
#include <cmath>

#include <gtest/gtest.h>

#include "harness/event_monitor.h"
#include "tests/acceptance/scenes.h"

namespace quayside::harness {
namespace {

// One rope, one pair of bodies, one landed switch, and whatever functions the test gives them.
class EventMonitorTest : public ::testing::Test {
 protected:
  EventMonitorTest() {
    add_body(scene_, ground());
    hang_container(scene_, {25, 2.5, 0.8, 1.8e6});
    scene_.ropes.resize(1);
    scene_.landed_switches.push_back({"landed", {1}, 1e5});
    monitor_ = std::make_unique<EventMonitor>(scene_);
    at_ = [this](double t, EventMonitor::Sample& sample) { sample = sample_at(t); };
  }

  EventMonitor::Sample sample_at(double t) const {
    EventMonitor::Sample sample = monitor_->make_sample();
    sample.time = t;
    sample.indicators.ropes[0] = rope_(t);
    sample.indicators.pairs[0] = depth_(t);
    sample.indicators.switches[0] = switch_(t);
    sample.forces[0] = force_(t);
    sample.impulses[0] = Eigen::Vector3d(0, 0, impulse_(t));
    return sample;
  }
  // In steps of `step`, on from flips, as a unit does.
  std::vector<Event> run(double end, double step) {
    monitor_->start(sample_at(0));
    double time = 0;
    while (time < end - 1e-12) {
      const double next = std::min(end, time + step);
      const auto flip = monitor_->advance(sample_at(time), sample_at(next), at_);
      flips_ += flip.has_value();
      time = flip ? seconds(*flip) : next;
    }
    return monitor_->take_events();
  }

  crane_models::Scene scene_;
  std::unique_ptr<EventMonitor> monitor_;
  EventMonitor::SampleAt at_;
  int flips_ = 0;
  std::function<double(double)> rope_ = [](double) { return 1; }, depth_ = [](double) { return -1; },
                                switch_ = [](double) { return -1; }, force_ = [](double) { return 0; },
                                impulse_ = [](double) { return 0; };
};

// 3 ns: the location's nanosecond, its rounding to the next, and the dead band of 1e-9 m at about 1 m/s.
constexpr double kTimeError = 3e-9;

TEST_F(EventMonitorTest, LocatesCrossingsInOrder) {
  rope_ = [](double t) { return std::cos(t); };           // slack at π/2, taut at 3π/2
  depth_ = [](double t) { return std::sin(t - 1); };      // made at 1, broken at 1 + π
  force_ = [this](double t) { return std::max(0.0, 100 * depth_(t)); };
  impulse_ = [](double t) { return -100 * std::cos(t - 1); };
  const auto events = run(5, 0.3);
  ASSERT_EQ(events.size(), 4u);
  EXPECT_EQ(events[0].kind, EventKind::contact_made);
  EXPECT_EQ(events[1].kind, EventKind::rope_slack);
  EXPECT_EQ(events[2].kind, EventKind::contact_broken);
  EXPECT_EQ(events[3].kind, EventKind::rope_taut);
  EXPECT_NEAR(seconds(events[0].time), 1, kTimeError);
  EXPECT_NEAR(seconds(events[1].time), kPi / 2, kTimeError);
  EXPECT_NEAR(seconds(events[2].time), 1 + kPi, kTimeError);
  EXPECT_NEAR(seconds(events[3].time), 3 * kPi / 2, kTimeError);
  EXPECT_EQ(events[2].subject, "ground/load");
  EXPECT_EQ(events[1].subject, "rope0");
  EXPECT_NEAR(events[2].impulse, 200, 1e-4);
  EXPECT_NEAR(events[2].duration, kPi, 2 * kTimeError);
  // The peak is taken at the steps' ends: at most half a step, 0.15 rad, from the top of the sine.
  EXPECT_NEAR(events[2].peak_force, 100, 100 * (1 - std::cos(0.15)));
}

TEST_F(EventMonitorTest, EndsTheStepWhereASwitchFlips) {
  switch_ = [](double t) { return t - 0.45; };
  depth_ = [](double t) { return t - 0.47; };  // in the same step, but after the flip
  monitor_->start(sample_at(0));
  const auto flip = monitor_->advance(sample_at(0.4), sample_at(0.5), at_);
  ASSERT_TRUE(flip);
  EXPECT_NEAR(seconds(*flip), 0.45, kTimeError);
  EXPECT_TRUE(monitor_->landed(0));
  auto events = monitor_->take_events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, EventKind::landed);
  EXPECT_FALSE(monitor_->advance(sample_at(seconds(*flip)), sample_at(0.5), at_));
  events = monitor_->take_events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, EventKind::contact_made);
  EXPECT_NEAR(seconds(events[0].time), 0.47, kTimeError);
}

// Exactly zero at the start, and rounding about zero after it, is no event.
TEST_F(EventMonitorTest, DoesNotChatterAtZero) {
  depth_ = rope_ = switch_ = [](double t) { return t == 0 ? 0.0 : 1e-13 * std::sin(1e4 * t); };
  EXPECT_TRUE(run(1, 0.01).empty());
  depth_ = [](double t) { return t; };  // leaves zero at once
  const auto events = run(1, 0.01);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_LE(events[0].time, 2);
}

TEST_F(EventMonitorTest, ReportsContactsThatAreMadeAtTheStart) {
  depth_ = [](double) { return 1e-3; };
  force_ = [](double) { return 5; };
  impulse_ = [](double t) { return 7 + 5 * t; };
  const auto events = run(2, 0.1);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, EventKind::contact_made);
  EXPECT_EQ(events[0].time, 0);
  const auto open = monitor_->open_contacts(sample_at(2));
  ASSERT_EQ(open.size(), 1u);
  EXPECT_DOUBLE_EQ(open[0].impulse, 10);
  EXPECT_DOUBLE_EQ(open[0].duration, 2);
  EXPECT_DOUBLE_EQ(open[0].peak_force, 5);
}

TEST_F(EventMonitorTest, ContinuesFromItsBytes) {
  depth_ = [](double t) { return std::sin(t - 1); };
  impulse_ = [](double t) { return -100 * std::cos(t - 1); };
  run(3, 0.3);  // taken: contact made
  ByteWriter out;
  monitor_->save(out);
  const UnitState bytes = out.take();

  EventMonitor other(scene_);
  ByteReader in(bytes);
  other.restore(in);
  in.finish();
  other.advance(sample_at(3), sample_at(5), at_);
  monitor_->advance(sample_at(3), sample_at(5), at_);
  const auto a = monitor_->take_events(), b = other.take_events();
  ASSERT_EQ(a.size(), 1u);
  ASSERT_EQ(b.size(), 1u);
  EXPECT_EQ(a[0].time, b[0].time);
  EXPECT_EQ(a[0].impulse, b[0].impulse);
  EXPECT_NEAR(a[0].impulse, 200, 1e-4);
  EXPECT_EQ(a[0].duration, b[0].duration);

  UnitState shorter = bytes;
  shorter.pop_back();
  ByteReader damaged(shorter);
  EXPECT_THROW(other.restore(damaged), std::invalid_argument);
}

}  // namespace
}  // namespace quayside::harness
