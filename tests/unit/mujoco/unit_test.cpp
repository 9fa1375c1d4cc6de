// What both MuJoCo engines promise as units.
#include <thread>

#include <gtest/gtest.h>

#include "tests/unit/mujoco/scenes.h"

namespace quayside::harness {
namespace {

using crane_models::Scene;

// A load that is lowered with a swing onto the ground: ropes, slack, contact, friction, drives.
Scene lowering() {
  Scene scene = crane(10);
  scene.bodies[1].X_WB.translation().y() = 0.2;
  scene.bodies[1].X_WB.rotate(Eigen::AngleAxisd(0.03, Eigen::Vector3d(1, 2, 3).normalized()));
  scene.bodies.push_back(ground());
  scene.bodies[2].boxes[0].X_BG.translation().z() = 28.4 - 1;
  scene.pairs.push_back({2, 0, 1, 0});
  scene.landed_switches.push_back({"landed", {1}, 4000});
  return scene;
}

std::vector<double> outputs(const Unit& unit) {
  std::vector<double> values;
  for (std::size_t i = 0; i < unit.variables().size(); ++i) values.push_back(unit.get(static_cast<ValueReference>(i)));
  return values;
}

class MujocoUnit : public ::testing::TestWithParam<bool> {
 protected:
  std::unique_ptr<EngineUnit> make(const Scene& scene, const SolverSettings& solver = {}) const {
    return make_mujoco_engine(GetParam(), scene, exact_contact(), solver);
  }
  std::unique_ptr<EngineUnit> make_lowering() const {
    auto unit = make(lowering());
    start(*unit);
    set(*unit, "hoist.rate", 0.4);
    set(*unit, "trolley.acceleration", 0.1);
    return unit;
  }
};

INSTANTIATE_TEST_SUITE_P(Engines, MujocoUnit, ::testing::Bool(),
                         [](const auto& same_law) { return same_law.param ? "SameLaw" : "Native"; });

TEST_P(MujocoUnit, VariablesAreThoseOfAllEngines) {
  const Scene scene = lowering();
  const auto unit = make(scene);
  EXPECT_EQ(unit->name(), GetParam() ? "mujoco_same_law" : "mujoco");
  const auto expected = engine_variables(scene);
  ASSERT_EQ(unit->variables().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(unit->variables()[i].name, expected[i].name);
}

TEST_P(MujocoUnit, RepeatsItselfToTheLastBit) {
  const auto first = make_lowering(), second = make_lowering();
  run(*first, 0, kSecond, 10 * kMillisecond);
  run(*second, 0, kSecond, 10 * kMillisecond);
  EXPECT_EQ(outputs(*first), outputs(*second));
}

TEST_P(MujocoUnit, InstancesDoNotDisturbEachOther) {
  const auto run_to_600_ms = [](EngineUnit& unit, EngineUnit* between) {
    for (Time now = 0; now < 600 * kMillisecond; now += 10 * kMillisecond) {
      run(unit, now, now + 10 * kMillisecond, 10 * kMillisecond);
      if (between) run(*between, now, now + 10 * kMillisecond, 10 * kMillisecond);
    }
  };
  const auto alone = make_lowering();
  run_to_600_ms(*alone, nullptr);
  // Step about with one of the other kind and another scene.
  const auto one = make_lowering();
  const auto other = make_mujoco_engine(!GetParam(), crane(20), exact_contact(), {});
  start(*other);
  run_to_600_ms(*one, other.get());
  EXPECT_EQ(outputs(*one), outputs(*alone));
  // And on two threads at once.
  const auto left = make_lowering(), right = make_lowering();
  std::thread thread([&] { run_to_600_ms(*left, nullptr); });
  run_to_600_ms(*right, nullptr);
  thread.join();
  EXPECT_EQ(outputs(*left), outputs(*alone));
  EXPECT_EQ(outputs(*right), outputs(*alone));
}

// Saved at a time when the load rests on an edge: the run that goes on, the same unit restored and a new unit restored
// end in the same bits.
TEST_P(MujocoUnit, SavedRunsContinueToTheLastBit) {
  const auto unit = make_lowering();
  Time now = run(*unit, 0, 500 * kMillisecond, 10 * kMillisecond);
  const UnitState state = unit->save();
  EXPECT_EQ(unit->save(), state);
  const auto saved = outputs(*unit);
  run(*unit, now, kSecond, 10 * kMillisecond);
  const auto expected = outputs(*unit);
  const auto events = unit->take_events();

  unit->restore(state);
  EXPECT_EQ(outputs(*unit), saved);
  run(*unit, now, kSecond, 10 * kMillisecond);
  EXPECT_EQ(outputs(*unit), expected);
  EXPECT_EQ(unit->take_events().size(), events.size());

  const auto fresh = make(lowering());
  fresh->restore(state);
  EXPECT_EQ(fresh->save(), state);
  run(*fresh, now, kSecond, 10 * kMillisecond);
  EXPECT_EQ(outputs(*fresh), expected);

  EXPECT_THROW(fresh->restore(UnitState(state.begin(), state.end() - 1)), std::invalid_argument);
}

TEST_P(MujocoUnit, CommunicationTimesAreHitWhateverTheStep) {
  const auto unit = make_lowering();
  Time now = 0;
  for (const Time step : {Time{1}, Time{999'983}, 7 * kMillisecond, Time{12'345'677}}) {
    const StepResult result = unit->do_step(now, step);
    ASSERT_FALSE(result.event);
    now += step;
    EXPECT_EQ(result.time, now);
    EXPECT_NEAR(get(*unit, "trolley.position.y"), 0.05 * seconds(now) * seconds(now), 1e-15);
  }
  EXPECT_THROW(unit->do_step(now + 1, 10), std::invalid_argument);
  EXPECT_THROW(unit->do_step(now, 0), std::invalid_argument);
}

TEST_P(MujocoUnit, ResetBeginsAgain) {
  const auto unit = make_lowering();
  run(*unit, 0, 600 * kMillisecond, 10 * kMillisecond);
  const auto expected = outputs(*unit);
  unit->reset();
  start(*unit);
  set(*unit, "hoist.rate", 0.4);
  set(*unit, "trolley.acceleration", 0.1);
  run(*unit, 0, 600 * kMillisecond, 10 * kMillisecond);
  EXPECT_EQ(outputs(*unit), expected);
}

TEST_P(MujocoUnit, WrongUseIsRefused) {
  const auto unit = make(crane(20));
  EXPECT_THROW(unit->do_step(0, kMillisecond), std::logic_error);
  EXPECT_THROW(unit->set(find(*unit, "load.position.x"), 1), std::invalid_argument);
  EXPECT_THROW(set(*unit, "hoist.rate", NAN), std::invalid_argument);
  EXPECT_THROW(unit->get(100000), std::invalid_argument);
  SolverSettings solver;
  solver.relative_tolerance = 0;
  EXPECT_THROW(make(crane(20), solver), std::invalid_argument);
  solver = {};
  solver.mujoco_step = -1;
  EXPECT_THROW(make(crane(20), solver), std::invalid_argument);
  Scene scene = crane(20);
  scene.bodies[1].mass = 0;
  EXPECT_THROW(make(scene), std::invalid_argument);
}

// The hoist winds the rope away altogether: no rest length, no force. The unit says so and stands where it last was
// good.
TEST_P(MujocoUnit, FailureLeavesTheLastGoodState) {
  const auto unit = make(crane(20));
  start(*unit);
  set(*unit, "hoist.rate", -15);
  try {
    run(*unit, 0, 10 * kSecond, 100 * kMillisecond);
    FAIL() << "no failure";
  } catch (const StepFailed& failure) {
    EXPECT_GT(failure.time, kSecond);
    EXPECT_LT(failure.time, 1334 * kMillisecond);  // 20 m at 15 m/s
    EXPECT_NE(std::string(failure.what()).find(unit->name()), std::string::npos);
    for (const double value : outputs(*unit)) EXPECT_TRUE(std::isfinite(value));
    EXPECT_NEAR(get(*unit, "hoist.value"), 20 - 15 * seconds(failure.time), 1e-9);
  }
}

// A contact of 1e5 N/m does not stop 1 t at 20 m/s within the half metre that the box is thick.
TEST_P(MujocoUnit, PassingThroughIsAFailure) {
  Scene scene;
  scene.bodies.push_back(ground());
  scene.bodies.push_back(box_body("box", 1000, {1, 1, 1}, {0, 0, 1}));
  scene.bodies[1].v_WB.z() = -20;
  scene.pairs.push_back({0, 0, 1, 0});
  auto contact = exact_contact();
  contact.stiffness = 1e5;
  const auto unit = make_mujoco_engine(GetParam(), scene, contact, {});
  start(*unit);
  try {
    run(*unit, 0, kSecond, 100 * kMillisecond);
    FAIL() << "no failure";
  } catch (const StepFailed& failure) {
    EXPECT_NE(std::string(failure.what()).find("box passed through ground"), std::string::npos) << failure.what();
  }
}

// MuJoCo warns of positions beyond 1e10 m: reached after 5 s at 2e9 m/s.
TEST_P(MujocoUnit, WarningsAreFailures) {
  Scene scene;
  scene.bodies.push_back(box_body("box", 1000, {1, 1, 1}, {0, 0, 0}));
  scene.bodies[0].v_WB.x() = 2e9;
  report(scene, "box");
  const auto unit = make(scene);
  start(*unit);
  try {
    run(*unit, 0, 10 * kSecond, kSecond);
    FAIL() << "no failure";
  } catch (const StepFailed& failure) {
    EXPECT_NEAR(seconds(failure.time), 5, 0.011);  // the last good state: a step of 10 ms before
    EXPECT_NE(std::string(failure.what()).find("QPOS"), std::string::npos) << failure.what();
    EXPECT_NEAR(get(*unit, "box.position.x"), 2e9 * seconds(failure.time), 1e-3);
  }
}

}  // namespace
}  // namespace quayside::harness
