// Running a case: lock-step over the communication points, recordings, failures of one engine, interruption.
#include "harness/run.h"

#include <algorithm>
#include <chrono>
#include <map>

#include <gtest/gtest.h>

#include "tests/unit/harness_stepping/mock_unit.h"

namespace quayside::harness {
namespace {

// A box in free fall from 100 m.
cases::Case falling_box(double duration, double interval) {
  cases::Case description;
  description.file = "box.yaml";
  description.duration = duration;
  description.output_interval = interval;
  description.ground = false;
  cases::BodySpec box;
  box.name = "box";
  box.mass = 1000;
  box.position = {0, 0, 100};
  description.bodies.push_back(box);
  return description;
}

// A mock engine with the variables that the scene asks for.
std::unique_ptr<MockUnit> mock_engine(const std::string& name, const crane_models::Scene& scene) {
  auto engine = std::make_unique<MockUnit>(name);
  for (const Variable& variable : engine_variables(scene)) {
    engine->add(variable.name, variable.causality, variable.unit, variable.start, variable.type);
  }
  return engine;
}

std::size_t place(const MockUnit& unit, const std::string& name) {
  const auto& variables = unit.variables();
  const auto found = std::find_if(variables.begin(), variables.end(), [&](const Variable& v) { return v.name == name; });
  EXPECT_NE(found, variables.end()) << name;
  return static_cast<std::size_t>(found - variables.begin());
}

// Engines whose box falls as 100 m − ½ g t², stepped exactly; `steps` notes who stepped to when.
struct Fall {
  std::vector<std::pair<std::string, Time>> steps;
  std::map<std::string, Time> fails_at;

  EngineFactory factory() {
    return [this](const std::string& name, const crane_models::Scene& scene, const auto&, const auto&) {
      auto engine = mock_engine(name, scene);
      MockUnit* unit = engine.get();
      const std::size_t z = place(*unit, "box.position.z");
      unit->values[z] = 100;
      unit->events.push_back({7, EventKind::landed, name});
      unit->on_step = [this, unit, z, name](Time now, Time step) {
        const Time end = now + step;
        if (fails_at.count(name) && end > fails_at[name]) throw StepFailed(name, now, "the corrector did not converge");
        steps.emplace_back(name, end);
        unit->values[z] = 100 - 0.5 * 9.81 * seconds(end) * seconds(end);
        return StepResult{end};
      };
      return engine;
    };
  }
};

TEST(RunCase, RecordsEveryEngineAtTheSameCommunicationPoints) {
  Fall fall;
  RunOptions options;
  options.engines = {"simbody", "mujoco"};
  options.cpu_times = true;
  const RunResult result = run_case(falling_box(1, 0.3), options, fall.factory());
  const std::vector<double> times{0, 0.3, 0.6, 0.9, 1};
  ASSERT_EQ(result.engines.size(), 2u);
  for (const EngineRun& run : result.engines) {
    EXPECT_EQ(run.trajectory.times, times);
    const std::size_t z = run.trajectory.index("box.position.z");
    EXPECT_EQ(run.trajectory.units[z], "m");
    for (std::size_t i = 0; i < times.size(); ++i) {
      EXPECT_EQ(run.trajectory.columns[z][i], 100 - 0.5 * 9.81 * times[i] * times[i]);
    }
    for (const auto& column : run.trajectory.columns) EXPECT_EQ(column.size(), times.size());
    EXPECT_EQ(run.step_times_s.size(), 4u);
    EXPECT_EQ(run.step_cpu_s.size(), 4u);
    EXPECT_EQ(run.simulated_s, 1);
    EXPECT_FALSE(run.failure);
    ASSERT_EQ(run.events.size(), 1u);
    EXPECT_EQ(run.events[0].subject, run.engine);
  }
  EXPECT_EQ(result.engines[0].engine, "simbody");
  EXPECT_FALSE(result.interrupted);
  // In lock-step: no engine is a communication point ahead of another.
  for (std::size_t i = 0; i + 1 < fall.steps.size(); i += 2) EXPECT_EQ(fall.steps[i].second, fall.steps[i + 1].second);
}

// 3000 intervals of 0.01 s are 30 s, though 0.01 is no binary fraction and 3000 × 0.01 may round either way.
TEST(RunCase, CommunicationPointsAreMultiplesOfTheInterval) {
  Fall fall;
  RunOptions options;
  options.engines = {"simbody"};
  const RunResult result = run_case(falling_box(30, 0.01), options, fall.factory());
  const std::vector<double>& times = result.engines[0].trajectory.times;
  ASSERT_EQ(times.size(), 3001u);
  for (std::size_t i = 0; i < times.size(); ++i) ASSERT_EQ(times[i], static_cast<double>(i) / 100);
}

TEST(RunCase, AFailureKeepsTheRecordingAndTheOthersGoOn) {
  Fall fall;
  fall.fails_at["mujoco"] = nanoseconds(0.5);
  RunOptions options;
  options.engines = {"simbody", "mujoco"};
  const RunResult result = run_case(falling_box(1, 0.1), options, fall.factory());
  const EngineRun &whole = result.engines[0], &failed = result.engines[1];
  EXPECT_FALSE(whole.failure);
  EXPECT_EQ(whole.trajectory.times.size(), 11u);
  ASSERT_TRUE(failed.failure);
  EXPECT_NE(failed.failure->find("mujoco stopped at 0.5"), std::string::npos) << *failed.failure;
  EXPECT_NE(failed.failure->find("the corrector did not converge"), std::string::npos);
  EXPECT_EQ(failed.trajectory.times, (std::vector<double>{0, 0.1, 0.2, 0.3, 0.4, 0.5}));
  for (const auto& column : failed.trajectory.columns) EXPECT_EQ(column.size(), 6u);
  EXPECT_EQ(failed.simulated_s, 0.5);
  EXPECT_EQ(failed.events.size(), 1u) << "events up to the failure are kept";
}

TEST(RunCase, AnEngineThatCannotStartIsAFailureOfItsOwn) {
  Fall fall;
  RunOptions options;
  options.engines = {"simbody", "mujoco"};
  const auto make = fall.factory();
  const RunResult result = run_case(falling_box(1, 0.1), options, [&](const auto& name, const auto& scene, const auto& contact,
                                                                      const auto& solver) {
    auto engine = make(name, scene, contact, solver);
    if (name == "mujoco") {
      static_cast<MockUnit&>(*engine).on_initialize = [] { throw StepFailed("mujoco", 0, "no consistent start"); };
    }
    return engine;
  });
  EXPECT_FALSE(result.engines[0].failure);
  EXPECT_TRUE(result.engines[1].failure);
  EXPECT_TRUE(result.engines[1].trajectory.times.empty());
}

TEST(RunCase, InterruptionEndsAllEnginesAtTheSamePoint) {
  Fall fall;
  RunOptions options;
  options.engines = {"simbody", "mujoco"};
  std::vector<std::pair<double, std::string>> told;
  options.progress = [&](double time, const std::string& engine) {
    told.emplace_back(time, engine);
    return time < 0.3;
  };
  const RunResult result = run_case(falling_box(1, 0.1), options, fall.factory());
  EXPECT_TRUE(result.interrupted);
  for (const EngineRun& run : result.engines) {
    EXPECT_EQ(run.trajectory.times, (std::vector<double>{0, 0.1, 0.2, 0.3}));
    EXPECT_FALSE(run.failure);
    EXPECT_EQ(run.events.size(), 1u);
  }
  ASSERT_EQ(told.size(), 6u);
  EXPECT_EQ(told[5], std::make_pair(0.3, std::string("mujoco")));
}

// Drives follow their script in every engine and stand in the trajectory: at −0.4 m/s after a ramp of 0.4/a the ropes have grown by
// 0.4 (t − 0.2/a).
TEST(RunCase, RecordsTheDrivesBesideTheEngine) {
  cases::Case description;
  description.file = "crane.yaml";
  description.duration = 4;
  description.output_interval = 0.5;
  description.crane.type = "quayside";
  description.crane.trolley_position = 20;
  description.crane.trolley_height = 32;
  description.crane.rope_length = 18;
  description.crane.hoist.max_speed = 1.5;
  description.crane.hoist.max_acceleration = 0.5;
  description.spreader.emplace();
  description.script.resize(1);
  description.script[0].speeds = {{"hoist", -0.4}};
  RunOptions options;
  options.engines = {"simbody"};
  double told = 0;
  const RunResult result = run_case(description, options, [&](const std::string& name, const crane_models::Scene& scene,
                                                              const auto&, const auto&) {
    auto engine = mock_engine(name, scene);
    MockUnit* unit = engine.get();
    const std::size_t hoist = place(*unit, "hoist.value");
    unit->on_step = [unit, hoist, &told](Time now, Time step) {
      told = unit->values[hoist];
      return StepResult{now + step};
    };
    return engine;
  });
  const Recording& trajectory = result.engines[0].trajectory;
  EXPECT_FALSE(result.engines[0].failure) << *result.engines[0].failure;
  const auto& hoist = trajectory.columns[trajectory.index("hoist.value")];
  EXPECT_NEAR(hoist.back() - hoist.front(), 0.4 * (4 - 0.4), 1e-12);  // rounding of lengths of 20 m
  EXPECT_NEAR(told - hoist.front(), 0.4 * (3.5 - 0.4), 1e-12) << "the engine was told its drive at the step's beginning";
  EXPECT_EQ(trajectory.columns[trajectory.index("hoist.rate")].back(), 0.4);
  EXPECT_NO_THROW(trajectory.index("trolley.value"));
}

// Pacing only ever waits, so that the wall time has a lower bound.
TEST(RunCase, RealTimeRunsTakeTheirTime) {
  Fall fall;
  RunOptions options;
  options.engines = {"simbody"};
  options.real_time = true;
  const auto begin = std::chrono::steady_clock::now();
  run_case(falling_box(0.05, 0.01), options, fall.factory());
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(50));
}

TEST(RunCase, RefusesListsOfEnginesThatMakeNoSense) {
  Fall fall;
  RunOptions options;
  options.engines = {};
  EXPECT_THROW(run_case(falling_box(1, 0.1), options, fall.factory()), std::invalid_argument);
  options.engines = {"simbody", "simbody"};
  EXPECT_THROW(run_case(falling_box(1, 0.1), options, fall.factory()), std::invalid_argument);
  options.engines = {"bullet"};
  try {
    run_case(falling_box(1, 0.1), options);
    FAIL() << "there is no such engine";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("simbody, mujoco_same_law, mujoco"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace quayside::harness
