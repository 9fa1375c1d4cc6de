// The drives move exactly as their limits say, and the script fires in order and once.
#include "harness/drive_unit.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace quayside::harness {
namespace {

using cases::ScriptEntry;

constexpr Time kMillisecond = 1'000'000;
constexpr Time kSecond = 1'000'000'000;

// Positions of a few metres carry rounding of 2⁻⁵² × 10 m ≈ 2e-15 m per operation; a thousandfold of that.
constexpr double kRounding = 1e-12;

crane_models::Scene crane() {
  crane_models::Scene scene;
  scene.drives.push_back({"trolley", "m", "position along the boom", 20, 1, 4, 0.8});
  scene.drives.push_back({"hoist", "m", "length of the ropes", 18, -1, 1.5, 0.5});
  scene.commands.push_back({"twistlocks", "closed", true});
  scene.landed_switches.push_back({"landed", {}, 1e4});
  scene.bodies.emplace_back();
  scene.frames.push_back({"load", 0, crane_models::Pose::Identity()});
  return scene;
}

ScriptEntry at(double time, std::vector<std::pair<std::string, double>> speeds) {
  ScriptEntry entry;
  entry.time = time;
  entry.speeds = std::move(speeds);
  return entry;
}

ScriptEntry when(ScriptEntry::Condition condition, const std::string& signal, double threshold, double after) {
  ScriptEntry entry;
  entry.condition = condition;
  entry.signal = signal;
  entry.threshold = threshold;
  entry.after = after;
  return entry;
}

cases::Case script(std::vector<ScriptEntry> entries) {
  cases::Case description;
  description.file = "some.yaml";
  description.script = std::move(entries);
  return description;
}

// Plays a drive unit alone, as a master would: never across an announced event.
class Player {
 public:
  explicit Player(std::vector<ScriptEntry> entries) : unit("drives", script(std::move(entries)), crane()) {
    unit.enter_initialization_mode(0);
    unit.exit_initialization_mode();
    next_ = unit.update_discrete_states();
  }

  ValueReference reference(const std::string& name) const {
    for (ValueReference i = 0; i < unit.variables().size(); ++i) {
      if (unit.variables()[i].name == name) return i;
    }
    ADD_FAILURE() << "no variable " << name;
    return 0;
  }
  double get(const std::string& name) const { return unit.get(reference(name)); }
  void set(const std::string& name, double value) { unit.set(reference(name), value); }

  void advance_to(Time target) {
    while (now < target) {
      const Time goal = std::min(target, next_.value_or(target));
      const StepResult result = unit.do_step(now, goal - now);
      EXPECT_EQ(result.time, goal) << "stopped at an event that was not announced";
      EXPECT_TRUE(goal != next_ || result.event) << "an announced event did not happen";
      now = goal;
      if (result.event) {
        events.push_back(now);
        next_ = unit.update_discrete_states();
      }
    }
  }

  DriveUnit unit;
  Time now = 0;
  std::vector<Time> events;

 private:
  std::optional<Time> next_;
};

// From rest at speed v over time T with ramps of t_a = v/a: s(t) = ½at² up to t_a, then v(t − t_a/2), and after the stop
// is commanded at T it ends as s = v T, since the two ramps are mirror images.
TEST(DriveUnit, TrapezoidalMoveMeetsTheClosedForm) {
  const double v = 2, a = 0.8, T = 10, t_a = v / a;
  Player player({at(0, {{"trolley", v}}), at(T, {{"trolley", 0}})});
  for (int i = 1; i <= 2000; ++i) {
    player.advance_to(i * 7 * kMillisecond);
    const double t = seconds(player.now);
    const double stopped = std::min(std::max(t - T, 0.0), t_a);
    const double moved = t < t_a ? 0.5 * a * t * t : v * (t - t_a / 2);
    const double expected = t < T ? moved : v * (T - t_a / 2) + stopped * (v - 0.5 * a * stopped);
    ASSERT_NEAR(player.get("trolley.value"), 20 + expected, kRounding) << "at " << t << " s";
  }
  EXPECT_NEAR(player.get("trolley.value"), 20 + v * T, kRounding);
  EXPECT_EQ(player.get("trolley.rate"), 0);
  EXPECT_EQ(player.get("trolley.acceleration"), 0);
  EXPECT_EQ(player.events, (std::vector<Time>{2500 * kMillisecond, 10 * kSecond, 12500 * kMillisecond}));
}

// Hoisting shortens the ropes: a positive command makes the rest length fall.
TEST(DriveUnit, SignTurnsSpeedIntoRate) {
  Player player({at(0, {{"hoist", 1.0}})});
  player.advance_to(3 * kSecond);  // 2 s of ramp to 1 m/s: 1 m, then 1 s: 1 m
  EXPECT_EQ(player.get("hoist.rate"), -1.0);
  EXPECT_NEAR(player.get("hoist.value"), 16, kRounding);
}

// 0.7 / 0.8 s is a whole number of nanoseconds, 0.1 / 0.3... is not: ramps end at the commanded speed all the same, to the
// last bit, without a jump in rate or value at their end, and within the acceleration limit to half a nanosecond over
// the ramp's duration.
TEST(DriveUnit, RampsEndExactlyAtTheCommandedSpeed) {
  for (const double speed : {0.7, 0.1, 1.0 / 3, 3.9999999, 1e-3, 1e-12}) {
    Player player({at(0, {{"trolley", speed}}), at(20, {{"trolley", -speed}}), at(40, {{"trolley", 0}})});
    ASSERT_FALSE(player.get("trolley.acceleration") == 0);
    const Time ramp = std::max<Time>(1, nanoseconds(speed / 0.8));
    // From the initial ramp alone, so that the end of the ramp is seen from both sides.
    const double before = player.get("trolley.acceleration") * seconds(ramp);
    EXPECT_NEAR(before, speed, 1e-15);
    EXPECT_LE(player.get("trolley.acceleration"), 0.8 * (1 + 0.5e-9 / seconds(ramp)) * (1 + 1e-15));
    player.advance_to(ramp);
    EXPECT_EQ(player.get("trolley.rate"), speed);
    EXPECT_EQ(player.get("trolley.acceleration"), 0);
    EXPECT_NEAR(player.get("trolley.value"), 20 + 0.5 * speed * seconds(ramp), kRounding);
    player.advance_to(39 * kSecond);
    EXPECT_EQ(player.get("trolley.rate"), -speed);
    player.advance_to(50 * kSecond);
    EXPECT_EQ(player.get("trolley.rate"), 0);
    const double at_rest = player.get("trolley.value");
    player.advance_to(5000 * kSecond);
    EXPECT_EQ(player.get("trolley.value"), at_rest) << "a stopped drive creeps";
  }
}

// A command in the middle of a ramp starts from the speed reached: after 1 s at 0.8 m/s² 0.8 m/s and 0.4 m; from there to −0.8 m/s
// in 2 s, back at 0.4 m by symmetry.
TEST(DriveUnit, NewCommandStartsFromTheSpeedReached) {
  Player player({at(0, {{"trolley", 4.0}}), at(1, {{"trolley", -0.8}})});
  player.advance_to(3 * kSecond);
  EXPECT_EQ(player.get("trolley.rate"), -0.8);
  EXPECT_NEAR(player.get("trolley.value"), 20.4, kRounding);
  EXPECT_EQ(player.events, (std::vector<Time>{kSecond, 3 * kSecond}));
}

// How far a step goes changes nothing: values at a time are the same to rounding for steps of 1 ms and of whole events.
TEST(DriveUnit, DoesNotDependOnTheSteps) {
  const std::vector<ScriptEntry> entries{at(0.3, {{"trolley", 3.3}, {"hoist", -1.1}}), at(2.2, {{"trolley", -1}})};
  Player fine(entries), coarse(entries);
  for (int i = 1; i <= 9000; ++i) fine.advance_to(i * kMillisecond);
  coarse.advance_to(9 * kSecond);
  EXPECT_EQ(fine.get("trolley.value"), coarse.get("trolley.value"));
  EXPECT_EQ(fine.get("hoist.value"), coarse.get("hoist.value"));
}

// What an engine is told: value, rate and acceleration at the beginning of a step give the value at its end.
TEST(DriveUnit, OutputsExtrapolateOverAnyStepBetweenEvents) {
  Player player({at(0, {{"trolley", 3.0}})});
  for (int i = 1; i <= 1000; ++i) {
    const crane_models::DriveMotion told{player.get("trolley.value"), player.get("trolley.rate"),
                                         player.get("trolley.acceleration")};
    player.advance_to(i * 5 * kMillisecond);  // the ramp ends at 3.75 s, a multiple of 5 ms
    ASSERT_NEAR(told.after(0.005).value, player.get("trolley.value"), kRounding);
  }
}

TEST(DriveUnit, EntriesDueTogetherFireInTheOrderOfTheScript) {
  ScriptEntry open = at(1, {});
  open.commands = {{"twistlocks", false}};
  ScriptEntry close = open;
  close.commands = {{"twistlocks", true}};
  Player last_closes({open, close}), last_opens({close, open});
  EXPECT_EQ(last_opens.get("twistlocks"), 1);
  last_closes.advance_to(2 * kSecond);
  last_opens.advance_to(2 * kSecond);
  EXPECT_EQ(last_closes.get("twistlocks"), 1);
  EXPECT_EQ(last_opens.get("twistlocks"), 0);
}

TEST(DriveUnit, LandedFiresOnceAfterItsDelay) {
  ScriptEntry stop = when(ScriptEntry::Condition::landed, "", 0, 0.25);
  stop.commands = {{"twistlocks", false}};
  ScriptEntry close = at(2, {});
  close.commands = {{"twistlocks", true}};
  Player player({stop, close});
  player.advance_to(kSecond);
  player.set("landed", 1);
  player.advance_to(kSecond + 1);  // units meet: from here the delay runs
  player.set("landed", 0);         // a bounce does not call it back
  player.advance_to(kSecond + 1 + 250 * kMillisecond - 1);
  EXPECT_EQ(player.get("twistlocks"), 1);
  player.advance_to(kSecond + 1 + 250 * kMillisecond);
  EXPECT_EQ(player.get("twistlocks"), 0);
  player.advance_to(2 * kSecond);
  EXPECT_EQ(player.get("twistlocks"), 1);
  player.set("landed", 1);
  player.advance_to(5 * kSecond);
  EXPECT_EQ(player.get("twistlocks"), 1) << "fired twice";
}

TEST(DriveUnit, SignalsAboveAndBelowTheirThresholds) {
  ScriptEntry up = when(ScriptEntry::Condition::signal_above, "load.position.z", 2.0, 0);
  up.speeds = {{"trolley", 1.0}};
  ScriptEntry down = when(ScriptEntry::Condition::signal_below, "load.velocity.z", -1.0, 0);
  down.speeds = {{"hoist", 1.0}};
  Player player({up, down});
  player.set("load.position.z", 2.0);  // not above
  player.set("load.velocity.z", -1.0);
  player.advance_to(kSecond);
  EXPECT_TRUE(player.events.empty());
  player.set("load.position.z", 2.0000001);
  player.advance_to(2 * kSecond);
  EXPECT_EQ(player.get("trolley.acceleration"), 0.8);
  EXPECT_EQ(player.get("hoist.acceleration"), 0);
  player.set("load.velocity.z", -1.1);
  player.advance_to(3 * kSecond);
  EXPECT_EQ(player.get("hoist.acceleration"), -0.5);
}

// The unit's own outputs are signals too: 18 m of rope paid out at 1 m/s after a 2 s ramp pass 20.5 m at 3.5 s.
TEST(DriveUnit, WaitsForItsOwnOutputs) {
  ScriptEntry stop = when(ScriptEntry::Condition::signal_above, "hoist.value", 20.4995, 0);
  stop.speeds = {{"hoist", 0.0}};
  Player player({at(0, {{"hoist", -1.0}}), stop});
  for (int i = 1; i <= 3499; ++i) player.advance_to(i * kMillisecond);
  EXPECT_EQ(player.get("hoist.acceleration"), 0);
  player.advance_to(3500 * kMillisecond);
  EXPECT_EQ(player.get("hoist.acceleration"), -0.5);
}

// The same state gives the same bytes, and the run from a restored state is the run that was saved.
TEST(DriveUnit, RestoredStateContinuesIdentically) {
  const std::vector<ScriptEntry> entries{at(0.3, {{"trolley", 3.3}}), at(2.2, {{"trolley", -1}, {"hoist", 0.2}})};
  Player player(entries);
  player.advance_to(1234567891);
  const UnitState saved = player.unit.save();
  EXPECT_EQ(saved, player.unit.save());
  player.advance_to(4 * kSecond);
  const double expected = player.get("trolley.value");
  const UnitState end = player.unit.save();

  Player other(entries);
  other.unit.restore(saved);
  EXPECT_EQ(other.unit.save(), saved);
  for (Time now = 1234567891; now < 4 * kSecond;) {
    now = other.unit.do_step(now, 4 * kSecond - now).time;  // stops at its own events
    other.unit.update_discrete_states();
  }
  EXPECT_EQ(other.get("trolley.value"), expected);
  EXPECT_EQ(other.unit.save(), end);
  EXPECT_THROW(other.unit.restore(UnitState(3)), std::invalid_argument);
}

// --- Drives that obey an input in place of the script ---------------------------------------------------------------

ValueReference reference(const DriveUnit& unit, const std::string& name) {
  for (ValueReference i = 0; i < unit.variables().size(); ++i) {
    if (unit.variables()[i].name == name) return i;
  }
  throw std::invalid_argument(name);
}

// The trolley is asked for 2 m/s from 1 s on, which it has after 2.5 s at 0.8 m/s²; the script, which asked for −1 m/s at the
// start, does not move it, and goes on moving the hoist.
TEST(DriveUnit, ADriveThatIsHandedOverObeysItsInputAlone) {
  Player player({at(0, {{"trolley", -1.0}, {"hoist", 0.5}})});
  DriveUnit unit = player.unit;
  unit.reset();
  unit.hand_over("trolley", true);
  unit.enter_initialization_mode(0);
  unit.update_discrete_states();
  EXPECT_FALSE(unit.needs_event_mode());
  Time now = unit.do_step(0, kSecond).time;
  EXPECT_EQ(unit.get(reference(unit, "trolley.value")), 20);
  EXPECT_NEAR(unit.get(reference(unit, "hoist.rate")), -0.5, kRounding) << "up: shorter ropes";

  unit.set(reference(unit, "command.trolley"), 2);
  EXPECT_TRUE(unit.needs_event_mode()) << "only an event can start a ramp";
  EXPECT_EQ(unit.get(reference(unit, "trolley.acceleration")), 0) << "and none has happened";
  EXPECT_EQ(unit.update_discrete_states(), std::optional<Time>(3500 * kMillisecond)) << "the end of the ramp is announced";
  EXPECT_FALSE(unit.needs_event_mode());
  now = unit.do_step(now, 2500 * kMillisecond).time;
  unit.update_discrete_states();
  EXPECT_EQ(now, 3500 * kMillisecond);
  EXPECT_EQ(unit.get(reference(unit, "trolley.rate")), 2);
  EXPECT_NEAR(unit.get(reference(unit, "trolley.value")), 20 + 0.5 * 2 * 2.5, kRounding);

  unit.set(reference(unit, "command.trolley"), 100);  // cut to 4 m/s, 2 m/s away
  EXPECT_EQ(unit.update_discrete_states(), std::optional<Time>(now + 2500 * kMillisecond));
}

TEST(DriveUnit, ACommandThatIsHandedOverObeysItsInputAlone) {
  ScriptEntry open = at(0, {});
  open.commands = {{"twistlocks", false}};
  Player player({open});
  DriveUnit unit = player.unit;
  unit.reset();
  unit.hand_over("twistlocks", true);
  unit.enter_initialization_mode(0);
  unit.update_discrete_states();
  EXPECT_EQ(unit.get(reference(unit, "twistlocks")), 1) << "the script would have opened them";
  unit.set(reference(unit, "command.twistlocks"), 0);
  EXPECT_TRUE(unit.needs_event_mode());
  EXPECT_EQ(unit.get(reference(unit, "twistlocks")), 1);
  unit.update_discrete_states();
  EXPECT_EQ(unit.get(reference(unit, "twistlocks")), 0);
  EXPECT_THROW(unit.hand_over("boom", true), std::invalid_argument);
}

// What an input asked for is part of the state; whom a drive obeys is not.
TEST(DriveUnit, InputsAreSavedAndRestored) {
  Player player({});
  DriveUnit unit = player.unit;
  unit.hand_over("trolley", true);
  unit.set(reference(unit, "command.trolley"), 2);
  unit.update_discrete_states();
  unit.do_step(0, kSecond);
  const UnitState saved = unit.save();
  unit.do_step(kSecond, kSecond);
  const UnitState end = unit.save();
  unit.set(reference(unit, "command.trolley"), -2);
  unit.update_discrete_states();
  unit.restore(saved);
  EXPECT_FALSE(unit.needs_event_mode());
  unit.do_step(kSecond, kSecond);
  EXPECT_EQ(unit.save(), end);
}

TEST(DriveUnit, ResetStartsAgain) {
  Player player({at(0, {{"trolley", 1.0}})});
  const UnitState begin = player.unit.save();
  player.advance_to(3 * kSecond);
  player.unit.reset();
  player.unit.enter_initialization_mode(0);
  player.unit.update_discrete_states();
  EXPECT_EQ(player.unit.save(), begin);
}

TEST(DriveUnit, TakesValuesForInputsOnly) {
  Player player({});
  EXPECT_THROW(player.set("trolley.value", 3), std::invalid_argument);
  EXPECT_THROW(player.unit.set(99, 1), std::invalid_argument);
  EXPECT_THROW(player.unit.get(99), std::invalid_argument);
}

// The message that a refusal gives, or nothing.
std::string refusal(ScriptEntry entry, const crane_models::Scene& scene = crane()) {
  try {
    DriveUnit("drives", script({at(0, {}), std::move(entry)}), scene);
  } catch (const cases::CaseError& error) {
    return error.what();
  }
  return "";
}

TEST(DriveUnit, RefusesWhatTheMachineCannotDoAndSaysWhatToChange) {
  const auto contains = [](const std::string& message, const std::vector<std::string>& parts) {
    for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
  };
  EXPECT_EQ(refusal(at(0, {{"trolley", -4.0}})), "");
  contains(refusal(at(0, {{"trolley", -4.1}})), {"some.yaml: script[1].trolley", "-4.1 m/s", "limit of 4 m/s", "max_speed"});
  contains(refusal(at(0, {{"trolley", std::nan("")}})), {"script[1].trolley"});
  contains(refusal(at(0, {{"troley", 1.0}})), {"script[1].troley", "trolley, hoist"});
  contains(refusal(at(1e300, {})), {"script[1].at"});
  ScriptEntry locks = at(0, {});
  locks.commands = {{"locks", true}};
  contains(refusal(locks), {"script[1].locks", "twistlocks"});
  contains(refusal(when(ScriptEntry::Condition::signal_above, "load.position", 1, 0)), {"script[1].when", "load.position.x"});
  crane_models::Scene scene = crane();
  scene.drives[0].max_acceleration = 0;
  contains(refusal(at(0, {{"trolley", 1.0}}), scene), {"script[1].trolley", "max_acceleration"});
  scene.landed_switches.clear();
  contains(refusal(when(ScriptEntry::Condition::landed, "", 0, 0), scene), {"script[1].when", "spreader"});
}

}  // namespace
}  // namespace quayside::harness
