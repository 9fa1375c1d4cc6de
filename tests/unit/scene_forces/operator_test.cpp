// Jerk limits, ramps, emergency stops, load limits and limit switches of the drives.
#include <cmath>

#include <gtest/gtest.h>

#include "harness/drive_unit.h"

namespace quayside::harness {
namespace {

using cases::ScriptEntry;

// Positions of some metres carry rounding of 1e-15 m per operation; phases end at whole nanoseconds, which at 1 m/s is a
// nanometre.
constexpr double kNanosecondsWay = 4e-9;

crane_models::Scene crane(double jerk) {
  crane_models::Scene scene;
  crane_models::Drive trolley{"trolley", "m", "position along the boom", 0, 1, 4, 0.8};
  trolley.max_jerk = jerk;
  trolley.emergency_stop = 2;
  crane_models::Drive boom{"boom", "rad", "angle", 0.5, 1, 0.1, 0.05};
  boom.emergency_stop = 0.1;
  crane_models::Drive wind{"wind", "m", "way of the air", 0, 1, 60, 50};  // no emergency stop stops it
  crane_models::Drive telescope{"telescope", "m", "length", 0, 1, 4, 0.8};
  telescope.emergency_stop = 2;
  telescope.highest = 10;
  scene.drives = {trolley, boom, wind, telescope};
  spreader::Rope rope;
  rope.name = "rope.only";
  scene.ropes = {rope};
  scene.load_limits = {{"overload", {0}, 1000, 0.5}};
  return scene;
}

ScriptEntry at(double time, const std::string& drive, double speed, double within = 0) {
  ScriptEntry entry;
  entry.time = time;
  entry.speeds = {{drive, speed}};
  if (within > 0) entry.ramps = {{drive, within}};
  return entry;
}

// Plays a drive unit alone, as a master would: never across an announced event.
class Player {
 public:
  Player(std::vector<ScriptEntry> script, double jerk = 0) : unit_("drives", with(std::move(script)), crane(jerk)) {
    unit_.enter_initialization_mode(0);
    unit_.exit_initialization_mode();
    next_ = unit_.update_discrete_states();
  }
  double get(const std::string& name) const { return unit_.get(reference(name)); }
  void set(const std::string& name, double value) { unit_.set(reference(name), value); }
  void event() { next_ = unit_.update_discrete_states(); }
  void advance_to(double seconds_then) {
    const Time target = nanoseconds(seconds_then);
    while (now_ < target) {
      const Time goal = std::min(target, next_.value_or(target));
      const StepResult step = unit_.do_step(now_, goal - now_);
      now_ = step.time;
      if (step.event || now_ == goal) event();
    }
  }
  std::vector<Event> events() { return unit_.take_events(); }

 private:
  static cases::Case with(std::vector<ScriptEntry> script) {
    cases::Case description;
    description.file = "some.yaml";
    description.script = std::move(script);
    return description;
  }
  ValueReference reference(const std::string& name) const {
    for (ValueReference i = 0; i < unit_.variables().size(); ++i) {
      if (unit_.variables()[i].name == name) return i;
    }
    ADD_FAILURE() << "no variable " << name;
    return 0;
  }
  DriveUnit unit_;
  Time now_ = 0;
  std::optional<Time> next_;
};

// Up to 3 m/s with 0.8 m/s² and 0.4 m/s³: two jerk phases of 2 s, each 0.8 m/s, and 1.4 m/s between them in 1.75 s. By
// symmetry the way is half of 3 m/s times 5.75 s.
TEST(Operator, RampsHaveTheShapeOfAnS) {
  Player player({at(0, "trolley", 3)}, 0.4);
  player.advance_to(1);
  EXPECT_NEAR(player.get("trolley.acceleration"), 0.4, 1e-9);
  EXPECT_NEAR(player.get("trolley.rate"), 0.2, 1e-9);
  EXPECT_NEAR(player.get("trolley.value"), 0.4 / 6, 1e-9);
  player.advance_to(3);
  EXPECT_NEAR(player.get("trolley.acceleration"), 0.8, 1e-9);
  player.advance_to(5.75);
  EXPECT_NEAR(player.get("trolley.rate"), 3, 1e-9);
  EXPECT_NEAR(player.get("trolley.value"), 0.5 * 3 * 5.75, kNanosecondsWay);
  player.advance_to(6.75);
  EXPECT_EQ(player.get("trolley.rate"), 3);
  EXPECT_EQ(player.get("trolley.acceleration"), 0);
  EXPECT_NEAR(player.get("trolley.value"), 0.5 * 3 * 5.75 + 3, kNanosecondsWay);
}

// A small change of speed does not reach the limit of acceleration: p² = j Δv, here √(0.4 · 0.1) = 0.2 m/s².
TEST(Operator, SmallChangesStayBelowTheAcceleration) {
  Player player({at(0, "trolley", 0.1)}, 0.4);
  player.advance_to(0.5);
  EXPECT_NEAR(player.get("trolley.acceleration"), 0.2, 1e-8);
  player.advance_to(1);
  EXPECT_NEAR(player.get("trolley.rate"), 0.1, 1e-9);
  player.advance_to(2);
  EXPECT_EQ(player.get("trolley.rate"), 0.1);
}

// Called back while it speeds up, a drive with a limit of jerk goes on speeding up for a while, and its rate and
// acceleration have no jump anywhere.
TEST(Operator, InterruptedRampsHaveNoJump) {
  Player player({at(0, "trolley", 3), at(2.5, "trolley", 0), at(4, "trolley", -1)}, 0.4);
  double rate = 0, acceleration = 0, time = 0;
  for (int i = 1; i < 2000; ++i) {
    player.advance_to(i * 0.01);
    const double dt = i * 0.01 - time;
    EXPECT_LE(std::abs(player.get("trolley.rate") - rate), 0.8 * dt + 1e-8) << time;
    EXPECT_LE(std::abs(player.get("trolley.acceleration") - acceleration), 0.4 * dt + 1e-7) << time;
    EXPECT_LE(std::abs(player.get("trolley.acceleration")), 0.8 + 1e-7) << time;
    rate = player.get("trolley.rate");
    acceleration = player.get("trolley.acceleration");
    time = i * 0.01;
  }
  EXPECT_EQ(rate, -1);
}

TEST(Operator, RampsTakeTheTimeThatTheScriptSays) {
  Player player({at(1, "trolley", 2, 4)});
  player.advance_to(3);
  EXPECT_NEAR(player.get("trolley.rate"), 1, 1e-9);
  player.advance_to(6);
  EXPECT_EQ(player.get("trolley.rate"), 2);
}

// What a person writes in degrees is in radians for the engines: 3 degrees/s in 3 degrees/s · π/180 / 0.05 s.
TEST(Operator, AnglesAreWrittenInDegrees) {
  Player player({at(0, "boom", -3)});
  player.advance_to(3);
  EXPECT_NEAR(player.get("boom.rate"), -3 * EIGEN_PI / 180, 1e-15);
  EXPECT_THROW(Player({at(0, "boom", -6)}), cases::CaseError);  // 0.1 rad/s are 5.7 degrees/s
}

TEST(Operator, AnEmergencyStopIsForGood) {
  ScriptEntry stop;
  stop.time = 6;
  stop.emergency_stop = true;
  Player player({at(0, "trolley", 3), at(0, "wind", 10), stop, at(8, "trolley", 1), at(9, "wind", 20)}, 0.4);
  player.advance_to(7);
  EXPECT_NEAR(player.get("trolley.rate"), 3 - 2, 1e-9);  // brakes know no jerk limit
  player.advance_to(12);
  EXPECT_EQ(player.get("trolley.rate"), 0);
  EXPECT_EQ(player.get("wind.rate"), 20);
  const auto events = player.events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, EventKind::stopped);
  EXPECT_EQ(events[0].time, 6'000'000'000);
}

// Above the threshold for half a second without a break: a shorter peak does not trip.
TEST(Operator, LoadLimitsTripAfterTheirDelay) {
  Player player({at(0, "trolley", 3)});
  player.advance_to(1);
  player.set("rope.only.tension", 1500);
  player.event();
  player.advance_to(1.3);
  player.set("rope.only.tension", 500);
  player.event();
  player.advance_to(2);
  EXPECT_TRUE(player.events().empty());
  player.set("rope.only.tension", 1500);
  player.event();
  player.advance_to(5);
  EXPECT_EQ(player.get("trolley.rate"), 0);
  const auto events = player.events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, EventKind::tripped);
  EXPECT_EQ(events[0].subject, "overload");
  EXPECT_EQ(events[0].time, 2'500'000'000);
}

// To 2 m/s in 2.5 s and 2.5 m, as far again at that speed and down again: 10 m, right to the switch. Without braking past it
// 3.75 s after the ramp, when it takes 2²/(2 · 2) m to stop.
TEST(Operator, LimitSwitchesTripWhereADriveLeavesItsRange) {
  const auto run = [](Player& player, double end) {
    for (int step = 1; step * 0.01 <= end; ++step) player.advance_to(step * 0.01);
  };
  Player within({at(0, "telescope", 2), at(5, "telescope", 0)});
  run(within, 8);
  EXPECT_NEAR(within.get("telescope.value"), 10, kNanosecondsWay);
  EXPECT_TRUE(within.events().empty());

  Player beyond({at(0, "telescope", 2), at(8, "telescope", -1)});
  run(beyond, 10);
  EXPECT_EQ(beyond.get("telescope.rate"), 0);
  EXPECT_NEAR(beyond.get("telescope.value"), 10 + 1, 0.02 + kNanosecondsWay);  // seen a step late
  const auto events = beyond.events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, EventKind::tripped);
  EXPECT_EQ(events[0].subject, "range.telescope");
  EXPECT_NEAR(seconds(events[0].time), 2.5 + 3.75, 0.011);
}

}  // namespace
}  // namespace quayside::harness
