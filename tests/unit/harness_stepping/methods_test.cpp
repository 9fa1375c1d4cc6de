// What every method of a master has to get right beside its numbers: who sees what when, events, going back, failures.
#include "harness/masters/method.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "harness/drive_unit.h"
#include "harness/master.h"
#include "tests/unit/harness_stepping/mock_unit.h"

namespace quayside::harness {
namespace {

constexpr Time kMillisecond = 1'000'000;
constexpr Time kSecond = 1'000'000'000;

MasterSettings settings(const std::string& method, double tolerance = 1e-9) { return {method, tolerance, 1}; }

class EveryMethod : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod, testing::Values("jacobi", "gauss_seidel", "iterated", "error_controlled"),
                         [](const auto& info) { return info.param; });

// Two units in a ring that add up what they hold: each one's output is a decay of the other.
struct Ring {
  MockUnit a{"a"}, b{"b"};
  Master master;
  explicit Ring(const MasterSettings& settings) : master(settings) {
    for (MockUnit* unit : {&a, &b}) {
      unit->input("in");
      unit->add("out", Causality::output, "1", 1);
      unit->on_step = [unit](Time now, Time step) {
        unit->values[1] -= 0.5 * seconds(step) * unit->values[0];
        return StepResult{now + step};
      };
      master.add(*unit);
    }
    master.connect("a::out", "b::in");
    master.connect("b::out", "a::in");
  }
};

// By symmetry both are exp(−t/2). The iteration is the trapezoidal rule, ((1 − h/4)/(1 + h/4))^n.
TEST(Methods, HoldWhatTheySay) {
  const auto run = [](const MasterSettings& settings) {
    Ring ring(settings);
    ring.master.initialize(0);
    for (int i = 1; i <= 10; ++i) ring.master.advance_to(i * 100 * kMillisecond);
    return std::pair(ring.a.values[1], ring.b.values[1]);
  };
  const double h = 0.1;
  EXPECT_NEAR(run(settings("jacobi")).first, std::pow(1 - h / 2, 10), 1e-14);
  EXPECT_NEAR(run(settings("jacobi")).second, std::pow(1 - h / 2, 10), 1e-14);
  EXPECT_GT(run(settings("gauss_seidel")).second, run(settings("gauss_seidel")).first) << "b holds less of a than a of b";
  EXPECT_NEAR(run(settings("iterated", 1e-14)).first, std::pow((1 - h / 4) / (1 + h / 4), 10), 1e-12);
  EXPECT_NEAR(run(settings("error_controlled", 1e-7)).first, std::exp(-0.5), 1e-3);
}

TEST_P(EveryMethod, LeavesAllUnitsWithTheInputsOfTheEnd) {
  Ring ring(settings(GetParam()));
  ring.master.initialize(0);
  ring.master.advance_to(kSecond / 10);
  EXPECT_EQ(ring.a.now, kSecond / 10);
  EXPECT_EQ(ring.b.now, kSecond / 10);
  EXPECT_EQ(ring.a.values[0], ring.b.values[1]);
  EXPECT_EQ(ring.b.values[0], ring.a.values[1]);
}

// A drive's value, rate and acceleration describe all of the step: the plant that follows them is exact with any method.
TEST_P(EveryMethod, GivesDrivesAtTheBeginningOfAStep) {
  crane_models::Scene scene;
  scene.drives.push_back({"hoist", "m", "length of the ropes", 10, -1, 1.5, 0.5});
  cases::Case description;
  description.script.resize(1);
  description.script[0].speeds = {{"hoist", -0.4}};
  DriveUnit drives("drives", description, scene);
  MockUnit plant("plant");
  const auto value = plant.add("hoist.value", Causality::input, "m", 10), rate = plant.input("hoist.rate", "m/s");
  const auto acceleration = plant.input("hoist.acceleration", "m/s2");
  const auto length = plant.add("length", Causality::output, "m", 10);
  plant.on_step = [&](Time now, Time step) {
    const crane_models::DriveMotion told{plant.values[value], plant.values[rate], plant.values[acceleration]};
    plant.values[length] = told.after(seconds(step)).value;
    return StepResult{now + step};
  };
  Master master(settings(GetParam(), 1e-3));
  master.add(plant);
  master.add(drives);
  connect_drives(master, plant, drives);
  master.initialize(0);
  master.advance_to(3 * kSecond);
  EXPECT_NEAR(plant.values[length], 10 + 0.4 * (3 - 0.4), 1e-12);  // the ramp took 0.8 s at half the speed
}

// The plant's value passes 1 at 0.7 s, where it stops, once, and the others are told there: a script's condition on it and
// one on its switch hold at that time, whatever the method.
TEST_P(EveryMethod, EventsHappenAtTheirTimeAndOnce) {
  crane_models::Scene scene;
  scene.drives.push_back({"hoist", "m", "length of the ropes", 10, -1, 1.5, 0.5});
  scene.landed_switches.push_back({"landed", {}, 1e4});
  cases::Case description;
  description.script.resize(1);
  description.script[0].condition = cases::ScriptEntry::Condition::landed;
  description.script[0].speeds = {{"hoist", -0.4}};
  DriveUnit drives("drives", description, scene);

  const Time touch = 700 * kMillisecond;
  MockUnit plant("plant");
  plant.add("hoist.value", Causality::input, "m", 10);
  plant.input("hoist.rate", "m/s");
  const auto acceleration = plant.input("hoist.acceleration", "m/s2");
  const auto landed = plant.add("landed", Causality::output, "", 0, Type::boolean);
  plant.on_step = [&](Time now, Time step) {
    if (plant.values[landed] == 0 && now + step >= touch) {
      plant.values[landed] = 1;
      return StepResult{touch, true};
    }
    return StepResult{now + step};
  };
  std::vector<std::pair<Time, double>> told;
  plant.on_event = [&](Time now) {
    if (told.empty() || told.back().second != plant.values[acceleration]) told.emplace_back(now, plant.values[acceleration]);
    return std::nullopt;
  };
  Master master(settings(GetParam()));
  master.add(plant);
  master.add(drives);
  connect_drives(master, plant, drives);
  master.initialize(0);
  for (const Time time : {400 * kMillisecond, kSecond, 3 * kSecond}) EXPECT_TRUE(master.advance_to(time));
  EXPECT_EQ(std::count(plant.event_modes.begin(), plant.event_modes.end(), touch), 1);
  EXPECT_EQ(told, (std::vector<std::pair<Time, double>>{{0, 0}, {touch, 0.5}, {touch + 800 * kMillisecond, 0}}));
}

// A signal that satisfies a script's condition is seen at the communication point where it does, not one later.
TEST_P(EveryMethod, ConditionsAreSeenAtTheCommunicationPoint) {
  crane_models::Scene scene;
  scene.drives.push_back({"hoist", "m", "length of the ropes", 10, -1, 1.5, 0.5});
  scene.frames.push_back({"load", -1, {}});
  cases::Case description;
  description.script.resize(1);
  description.script[0].condition = cases::ScriptEntry::Condition::signal_below;
  description.script[0].signal = "load.position.z";
  description.script[0].threshold = 0.75;
  description.script[0].speeds = {{"hoist", 0.4}};
  DriveUnit drives("drives", description, scene);
  MockUnit plant("plant");
  plant.add("load.position.z", Causality::output, "m", 1);
  plant.on_step = [&](Time now, Time step) {
    plant.values[0] = 1 - seconds(now + step);
    return StepResult{now + step};
  };
  Master master(settings(GetParam(), 0.1));
  master.add(plant);
  master.add(drives);
  connect_drives(master, plant, drives);
  master.initialize(0);
  for (int i = 1; i <= 2; ++i) master.advance_to(i * kSecond / 10);
  EXPECT_EQ(drives.get(2), 0) << "0.8 m is not below";
  master.advance_to(3 * kSecond / 10);
  EXPECT_EQ(drives.get(2), -0.5) << "up: shorter ropes";
}

TEST_P(EveryMethod, AUnitMayAskForTheEnd) {
  MockUnit plant("plant");
  plant.on_step = [](Time now, Time step) { return StepResult{now + step, false, now + step >= 2 * kSecond}; };
  Master master(settings(GetParam()));
  master.add(plant);
  master.initialize(0);
  EXPECT_TRUE(master.advance_to(kSecond));
  EXPECT_FALSE(master.advance_to(2 * kSecond));
  EXPECT_EQ(master.time(), 2 * kSecond);
}

TEST_P(EveryMethod, FailuresCarryUnitAndTime) {
  Ring ring(settings(GetParam()));
  ring.b.on_step = [&](Time now, Time step) {
    if (now + step > kSecond) throw StepFailed("b", now, "enough");
    return StepResult{now + step};
  };
  ring.master.initialize(0);
  ring.master.advance_to(kSecond);
  try {
    ring.master.advance_to(2 * kSecond);
    FAIL() << "a failure was swallowed";
  } catch (const StepFailed& failure) {
    EXPECT_EQ(failure.time, kSecond);
    EXPECT_NE(std::string(failure.what()).find("b stopped at 1.0"), std::string::npos) << failure.what();
  }
  EXPECT_EQ(ring.master.time(), kSecond);
}

// Masters that go back leave the last good state behind when a step cannot be done.
TEST(Methods, AFailedStepIsTakenBack) {
  for (const char* method : {"iterated", "error_controlled"}) {
    Ring ring(settings(method));
    ring.b.on_step = [](Time now, Time) -> StepResult { throw StepFailed("b", now, "enough"); };
    ring.master.initialize(0);
    EXPECT_THROW(ring.master.advance_to(kSecond), StepFailed);
    EXPECT_EQ(ring.a.now, 0) << method;
    EXPECT_EQ(ring.a.values[1], 1) << method;
  }
}

// With an iteration any unit may stop early: all others go back and step to there.
TEST(Methods, IteratedStopsWhereAnyUnitHasItsEvent) {
  Ring ring(settings("iterated"));
  const Time event = kSecond / 3;
  const auto decay = ring.b.on_step;
  bool done = false;
  ring.b.on_step = [&](Time now, Time step) {
    const Time end = !done && now + step >= event ? event : now + step;
    StepResult result = decay(now, end - now);
    result.event = end == event;
    return result;
  };
  ring.b.on_event = [&](Time now) {
    done = now == event;
    return std::nullopt;
  };
  ring.master.initialize(0);
  ring.master.advance_to(kSecond);
  EXPECT_EQ(ring.b.event_modes, (std::vector<Time>{event}));
  EXPECT_EQ(ring.a.event_modes, (std::vector<Time>{event}));
  EXPECT_EQ(ring.a.now, kSecond);
  const auto trapezoid = [](double h) { return (1 - h / 4) / (1 + h / 4); };
  EXPECT_NEAR(ring.a.values[1], trapezoid(1.0 / 3) * trapezoid(2.0 / 3), 1e-8);  // the tolerance, and a nanosecond
}

// The step that fails is a step too long: b cannot make more than 10 ms at once.
TEST(Methods, ErrorControlTakesShorterStepsWhereAUnitFails) {
  Ring ring(settings("error_controlled", 0.1));
  const auto decay = ring.b.on_step;
  ring.b.on_step = [&](Time now, Time step) {
    if (step > 10 * kMillisecond) throw StepFailed("b", now, "too long");
    return decay(now, step);
  };
  ring.master.initialize(0);
  ring.master.advance_to(kSecond);
  EXPECT_EQ(ring.master.time(), kSecond);
  EXPECT_NEAR(ring.a.values[1], std::exp(-0.5), 0.01);
}

// An output that alternates whatever the step: no step is short enough, and the message says what is wrong.
TEST(Methods, ErrorControlSaysWhenNoStepIsShortEnough) {
  Ring ring(settings("error_controlled", 1e-3));
  ring.b.on_step = [&](Time now, Time step) {
    ring.b.values[1] = static_cast<double>(ring.b.steps.size() % 5);
    return StepResult{now + step};
  };
  ring.master.initialize(0);
  try {
    ring.master.advance_to(kSecond);
    FAIL();
  } catch (const StepFailed& failure) {
    EXPECT_NE(std::string(failure.what()).find("raise master.tolerance"), std::string::npos) << failure.what();
  }
}

TEST(Methods, IterationsWithoutEndAreAFailureThatSaysWhatToDo) {
  Ring ring(settings("iterated", 1e-6));
  ring.b.on_step = [&](Time now, Time step) {
    ring.b.values[1] = static_cast<double>(ring.b.steps.size());
    return StepResult{now + step};
  };
  ring.master.initialize(0);
  try {
    ring.master.advance_to(kSecond);
    FAIL();
  } catch (const StepFailed& failure) {
    EXPECT_NE(std::string(failure.what()).find("does not converge"), std::string::npos) << failure.what();
    EXPECT_NE(std::string(failure.what()).find("master.relaxation"), std::string::npos) << failure.what();
  }
  EXPECT_EQ(ring.a.now, 0);
}

// A saved master continues with the step that it had come to: the same steps as if nothing had been saved.
TEST(Methods, ErrorControlContinuesFromASavedState) {
  Ring ring(settings("error_controlled", 1e-5));
  ring.master.initialize(0);
  ring.master.advance_to(kSecond / 2);
  const UnitState a = ring.a.save(), b = ring.b.save();
  ByteWriter out;
  ring.master.save(out);
  const UnitState master = out.take();
  const auto go_on = [&] {
    ring.a.steps.clear();
    ring.master.advance_to(kSecond);
    return std::pair(ring.a.steps, ring.a.values);
  };
  const auto first = go_on();
  ring.a.restore(a);
  ring.b.restore(b);
  ByteReader in(master);
  ring.master.restore(in);
  in.finish();
  EXPECT_EQ(go_on(), first);
}

TEST(Methods, RefusesSettingsThatMakeNoSense) {
  for (const MasterSettings& wrong : {MasterSettings{"euler", 1e-6, 1}, {"iterated", 0, 1}, {"iterated", 1e-6, 0}, {"iterated", 1e-6, 1.5}}) {
    EXPECT_THROW(Master{wrong}, std::invalid_argument);
  }
  try {
    Master{{"euler"}};
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("jacobi, gauss_seidel, iterated, error_controlled"), std::string::npos);
  }
}

}  // namespace
}  // namespace quayside::harness
