// The master steps units to communication points and events, hands values over at the right time and never drifts.
#include "harness/master.h"

#include <cmath>
#include <limits>
#include <tuple>

#include <gtest/gtest.h>

#include "harness/drive_unit.h"
#include "tests/unit/harness_stepping/mock_unit.h"

namespace quayside::harness {
namespace {

constexpr Time kMillisecond = 1'000'000;
constexpr Time kSecond = 1'000'000'000;

TEST(Master, FollowersSeeThePlantAtTheNewTimeAndThePlantSeesThemAtTheOld) {
  MockUnit plant("plant"), follower("follower");
  const auto out = plant.output("position", "m"), in = follower.input("position", "m");
  const auto back = follower.output("force", "N"), force = plant.input("force", "N");
  std::vector<double> seen_by_plant, seen_by_follower;
  plant.on_step = [&](Time now, Time step) {
    seen_by_plant.push_back(plant.values[force]);
    plant.values[out] = seconds(now + step);
    return StepResult{now + step};
  };
  follower.on_step = [&](Time now, Time step) {
    seen_by_follower.push_back(follower.values[in]);
    follower.values[back] = 10 * seconds(now + step);
    return StepResult{now + step};
  };
  Master master;
  master.add(plant);
  master.add(follower);
  master.connect("plant::position", "follower::position");
  master.connect("follower::force", "plant::force");
  master.initialize(0);
  for (int i = 1; i <= 3; ++i) EXPECT_TRUE(master.advance_to(i * kSecond));
  EXPECT_EQ(seen_by_follower, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(seen_by_plant, (std::vector<double>{0, 10, 20}));
  EXPECT_EQ(plant.values[force], 30) << "outputs at a communication point follow from inputs at that time";
}

// A million steps of 1/60 s, which is no whole number of nanoseconds: every time is the rounded multiple itself.
TEST(Master, TimeDoesNotDriftOverAMillionSteps) {
  MockUnit plant("plant"), follower("follower");
  Time reached = 0;
  plant.on_step = [&](Time now, Time step) {
    EXPECT_EQ(now, reached);
    return StepResult{reached = now + step};
  };
  Master master;
  master.add(plant);
  master.add(follower);
  master.initialize(0);
  constexpr int kSteps = 1'000'000;
  for (int i = 1; i <= kSteps; ++i) {
    master.advance_to(nanoseconds(i / 60.0));
    ASSERT_EQ(reached, nanoseconds(i / 60.0));
    plant.steps.clear();
    follower.steps.clear();
  }
  EXPECT_EQ(master.time(), 16'666'666'666'667);
  EXPECT_EQ(follower.now, master.time());
}

TEST(Master, NeverStepsAcrossAnAnnouncedEvent) {
  MockUnit plant("plant"), timer("timer");
  timer.on_event = [](Time now) -> std::optional<Time> {
    return (now / 300 + 1) * 300;  // every 300 ns
  };
  Master master;
  master.add(plant);
  master.add(timer);
  master.initialize(0);
  master.advance_to(700);
  EXPECT_EQ(plant.steps, (std::vector<std::pair<Time, Time>>{{0, 300}, {300, 300}, {600, 100}}));
  EXPECT_EQ(timer.steps, plant.steps);
  EXPECT_EQ(plant.event_modes, (std::vector<Time>{300, 600}));
  EXPECT_EQ(timer.event_modes, (std::vector<Time>{300, 600}));
}

// A load is lowered at 0.4 m/s from 1 m above the ground (ramp 0.8 s, so it touches at 0.4 + 2.5 s) while the plant knows
// nothing but the drive's motion; it stops at the touch, between two communication points, and the script stops the
// hoist there and opens the locks 0.1 s later.
TEST(Master, LandedSwitchIsHandedOverAtItsTime) {
  crane_models::Scene scene;
  scene.drives.push_back({"hoist", "m", "length of the ropes", 10, -1, 1.5, 0.5});
  scene.commands.push_back({"twistlocks", "closed", true});
  scene.landed_switches.push_back({"landed", {}, 1e4});
  cases::Case description;
  description.script.resize(3);
  description.script[0].speeds = {{"hoist", -0.4}};
  description.script[1].condition = cases::ScriptEntry::Condition::landed;
  description.script[1].speeds = {{"hoist", 0.0}};
  description.script[2].condition = cases::ScriptEntry::Condition::landed;
  description.script[2].after = 0.1;
  description.script[2].commands = {{"twistlocks", false}};
  DriveUnit drives("drives", description, scene);

  MockUnit plant("plant");
  const auto value = plant.add("hoist.value", Causality::input, "m", 10), rate = plant.input("hoist.rate", "m/s");
  const auto acceleration = plant.input("hoist.acceleration", "m/s2");
  const auto locks = plant.add("twistlocks", Causality::input, "", 1, Type::boolean);
  const auto landed = plant.add("landed", Causality::output, "", 0, Type::boolean);
  double deepest = 0;
  std::vector<std::pair<Time, double>> lock_changes;
  plant.on_step = [&](Time now, Time step) {
    const crane_models::DriveMotion told{plant.values[value], plant.values[rate], plant.values[acceleration]};
    const double end = told.after(seconds(step)).value;
    deepest = std::max(deepest, end);
    if (plant.values[landed] == 1 || end < 11) return StepResult{now + step};
    EXPECT_EQ(told.acceleration, 0);
    plant.values[landed] = 1;
    return StepResult{now + nanoseconds((11 - told.value) / told.rate), true};
  };
  plant.on_event = [&](Time now) {
    if (lock_changes.empty() || plant.values[locks] != lock_changes.back().second) {
      lock_changes.emplace_back(now, plant.values[locks]);
    }
    return std::nullopt;
  };

  Master master;
  master.add(plant);
  master.add(drives);
  for (const char* name : {"hoist.value", "hoist.rate", "hoist.acceleration", "twistlocks"}) {
    master.connect(std::string("drives::") + name, std::string("plant::") + name);
  }
  master.connect("plant::landed", "drives::landed");
  master.initialize(0);
  for (int i = 1; i <= 600; ++i) master.advance_to(i * 7 * kMillisecond);

  // ½·0.5·0.8² = 0.16 m after the ramp, the other 0.84 m at 0.4 m/s: 0.8 + 2.1 = 2.9 s; 2.9 s lies between 2.898 and 2.905.
  const Time touch = 2'900'000'000;
  EXPECT_EQ(plant.event_modes.at(1), touch);  // the first is the end of the ramp
  EXPECT_EQ(plant.event_modes.at(2), touch + 100 * kMillisecond);
  ASSERT_EQ(lock_changes.size(), 2u);
  EXPECT_EQ(lock_changes[1], std::make_pair(touch + 100 * kMillisecond, 0.0));
  EXPECT_EQ(plant.event_modes.at(3), touch + 800 * kMillisecond);  // the hoist has stopped
  // It stops in 0.8 s over 0.16 m from where it touched, to rounding of the rope's length and the nanosecond of the touch.
  EXPECT_NEAR(plant.values[value], 11.16, 0.4e-9);
  EXPECT_EQ(plant.values[rate], 0);
  EXPECT_EQ(plant.now, 4200 * kMillisecond);
}

// a → b → c: each passes on in event mode what it is given, so it takes three rounds until c's answer is back at a.
TEST(Master, EventModeIsIteratedUntilNothingChanges) {
  MockUnit a("a"), b("b"), c("c");
  std::vector<MockUnit*> chain{&a, &b, &c};
  for (MockUnit* unit : chain) {
    unit->input("in");
    unit->output("out");
    unit->on_event = [unit](Time) {
      unit->values[1] = unit->values[0];
      return std::nullopt;
    };
  }
  a.on_event = [&](Time now) -> std::optional<Time> {
    a.values[1] = now < kSecond ? 0 : 1;
    return now < kSecond ? std::optional<Time>(kSecond) : std::nullopt;
  };
  Master master;
  for (MockUnit* unit : {&c, &b, &a}) master.add(*unit);  // the worst order
  master.connect("b::out", "c::in");
  master.connect("a::out", "b::in");
  master.connect("c::out", "a::in");
  master.initialize(0);
  EXPECT_EQ(a.values[0], 0);
  master.advance_to(2 * kSecond - 1);
  EXPECT_EQ(a.values[0], 1);
}

TEST(Master, EventsWithoutEndAreAFailureThatSaysSo) {
  MockUnit a("a"), b("b");
  for (MockUnit* unit : {&a, &b}) {
    unit->input("in");
    unit->output("out");
  }
  a.on_event = [&](Time) { return a.values[1] = 1 - a.values[0], std::nullopt; };  // a = not b, b = a
  b.on_event = [&](Time) { return b.values[1] = b.values[0], std::nullopt; };
  Master master;
  master.add(a);
  master.add(b);
  master.connect("a::out", "b::in");
  master.connect("b::out", "a::in");
  EXPECT_THROW(master.initialize(0), StepFailed);
}

TEST(Master, EventsWithoutProgressInTimeAreAFailure) {
  MockUnit plant("plant");
  plant.on_step = [](Time now, Time) { return StepResult{now, true}; };
  Master master;
  master.add(plant);
  master.initialize(0);
  EXPECT_THROW(master.advance_to(kSecond), StepFailed);
}

TEST(Master, AnEventMayHappenWithinTheNanosecond) {
  MockUnit plant("plant"), follower("follower");
  int stalls = 3;
  plant.on_step = [&](Time now, Time step) { return stalls-- > 0 ? StepResult{now, true} : StepResult{now + step}; };
  Master master;
  master.add(plant);
  master.add(follower);
  master.initialize(5);
  EXPECT_TRUE(master.advance_to(kSecond));
  EXPECT_EQ(plant.event_modes, (std::vector<Time>{5, 5, 5}));
  EXPECT_EQ(follower.steps, (std::vector<std::pair<Time, Time>>{{5, kSecond - 5}})) << "steps are longer than zero";
}

TEST(Master, OnlyTheFirstUnitMayStopEarly) {
  MockUnit plant("plant"), follower("follower");
  follower.on_step = [](Time now, Time step) { return StepResult{now + step / 2, true}; };
  Master master;
  master.add(plant);
  master.add(follower);
  master.initialize(0);
  EXPECT_THROW(master.advance_to(kSecond), StepFailed);
}

TEST(Master, AUnitMayAskForTheEnd) {
  MockUnit plant("plant");
  plant.on_step = [](Time now, Time step) { return StepResult{now + step, false, now + step >= 2 * kSecond}; };
  Master master;
  master.add(plant);
  master.initialize(0);
  EXPECT_TRUE(master.advance_to(kSecond));
  EXPECT_FALSE(master.advance_to(2 * kSecond));
  EXPECT_FALSE(master.advance_to(3 * kSecond));
  EXPECT_EQ(master.time(), 2 * kSecond);
  master.terminate();
  EXPECT_TRUE(plant.terminated);
}

// For a master above this one: a step ends at an event, which is dealt with when that one says so.
TEST(Master, CanBeSteppedInPieces) {
  MockUnit plant("plant"), timer("timer");
  bool wish = false;
  timer.on_event = [](Time now) -> std::optional<Time> { return now < kSecond ? std::optional<Time>(kSecond) : std::nullopt; };
  plant.on_step = [&](Time now, Time step) {
    const Time end = now + step > 1500 * kMillisecond && now < 1500 * kMillisecond ? 1500 * kMillisecond : now + step;
    return StepResult{end, end == 1500 * kMillisecond};
  };
  plant.asks_for_event = [&] { return wish; };
  Master master;
  master.add(plant);
  master.add(timer);
  master.initialize(0);
  EXPECT_EQ(master.next_event(), std::optional<Time>(kSecond));
  EXPECT_FALSE(master.advance_to_event(kSecond / 2));
  EXPECT_EQ(master.time(), kSecond / 2);
  EXPECT_TRUE(master.advance_to_event(2 * kSecond)) << "the timer's";
  EXPECT_EQ(master.time(), kSecond);
  EXPECT_TRUE(plant.event_modes.empty()) << "nobody has dealt with it";
  master.handle_event();
  EXPECT_EQ(plant.event_modes, (std::vector<Time>{kSecond}));
  EXPECT_EQ(master.next_event(), std::nullopt);
  EXPECT_TRUE(master.advance_to_event(2 * kSecond)) << "the plant's own";
  EXPECT_EQ(master.time(), 1500 * kMillisecond);
  master.handle_event();
  EXPECT_FALSE(master.needs_event_mode());
  wish = true;
  EXPECT_TRUE(master.needs_event_mode());
  EXPECT_TRUE(master.advance_to_event(2 * kSecond)) << "a unit asks for event mode";
  EXPECT_EQ(master.time(), 2 * kSecond);
}

// Saved together with its units, it goes on as if nothing had happened: it knows its time, the next event, and what it has
// handed over already.
TEST(Master, ContinuesFromASavedState) {
  MockUnit plant("plant"), timer("timer");
  const auto out = plant.output("x"), in = timer.input("x");
  plant.on_step = [&](Time now, Time step) {
    plant.values[out] = seconds(now + step);
    return StepResult{now + step};
  };
  timer.on_event = [](Time now) -> std::optional<Time> { return (now / 300 + 1) * 300; };
  Master master;
  master.add(plant);
  master.add(timer);
  master.connect("plant::x", "timer::x");
  master.initialize(0);
  master.advance_to(700);
  const UnitState plant_then = plant.save(), timer_then = timer.save();
  ByteWriter out_bytes;
  master.save(out_bytes);
  const UnitState master_then = out_bytes.take();
  const auto go_on = [&] {
    plant.steps.clear();
    master.advance_to(1300);
    return std::tuple(plant.steps, timer.values, master.time(), master.next_event());
  };
  const auto first = go_on();
  plant.restore(plant_then);
  timer.restore(timer_then);
  ByteReader in_bytes(master_then);
  master.restore(in_bytes);
  in_bytes.finish();
  EXPECT_EQ(master.time(), 700);
  EXPECT_EQ(go_on(), first);
  EXPECT_EQ(timer.values[in], seconds(1300));
}

TEST(Master, ValuesThatAreNotFiniteAreNotPassedOn) {
  MockUnit plant("plant"), follower("follower");
  const auto out = plant.output("x");
  follower.input("x");
  plant.on_step = [&](Time now, Time step) {
    plant.values[out] = std::numeric_limits<double>::quiet_NaN();
    return StepResult{now + step};
  };
  Master master;
  master.add(plant);
  master.add(follower);
  master.connect("plant::x", "follower::x");
  master.initialize(0);
  try {
    master.advance_to(kSecond);
    FAIL() << "NaN was passed on";
  } catch (const StepFailed& failure) {
    EXPECT_NE(std::string(failure.what()).find("plant::x"), std::string::npos) << failure.what();
  }
}

TEST(Master, InputsAreSetOnlyWhenTheyChange) {
  MockUnit plant("plant"), follower("follower");
  const auto out = plant.output("x"), in = follower.input("x");
  Master master;
  master.add(plant);
  master.add(follower);
  master.connect("plant::x", "follower::x");
  master.initialize(0);
  follower.values[in] = -7;  // would be overwritten by another set
  master.advance_to(kSecond);
  EXPECT_EQ(follower.values[in], -7);
  plant.values[out] = 3;
  master.advance_to(2 * kSecond);
  EXPECT_EQ(follower.values[in], 3);
}

TEST(Master, RefusesConnectionsThatCannotBe) {
  MockUnit a("a"), b("b"), twin("a");
  a.output("x", "m");
  a.input("u", "m");
  b.input("x", "m");
  b.input("mm", "mm");
  b.add("flag", Causality::input, "", 0, Type::boolean);
  Master master;
  master.add(a);
  master.add(b);
  EXPECT_THROW(master.add(twin), std::invalid_argument);
  const auto refusal = [&](const char* output, const char* input) -> std::string {
    try {
      master.connect(output, input);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const auto says = [](const std::string& message, const char* part) { return message.find(part) != std::string::npos; };
  EXPECT_PRED2(says, refusal("c::x", "b::x"), "no unit \"c\"; there are: a, b");
  EXPECT_PRED2(says, refusal("a::y", "b::x"), "no variable \"y\"");
  EXPECT_PRED2(says, refusal("a", "b::x"), "no variable");
  EXPECT_PRED2(says, refusal("a::u", "b::x"), "not an output");
  EXPECT_PRED2(says, refusal("a::x", "a::x"), "not an input");
  EXPECT_PRED2(says, refusal("a::x", "b::mm"), "[m] and [mm]");
  EXPECT_PRED2(says, refusal("a::x", "b::flag"), "boolean");
  EXPECT_EQ(refusal("a::x", "b::x"), "");
  EXPECT_PRED2(says, refusal("a::x", "b::x"), "already");
}

}  // namespace
}  // namespace quayside::harness
