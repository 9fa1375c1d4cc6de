#include "harness/summary.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "harness/output_directory.h"
#include "harness/run_text.h"
#include "tests/unit/harness_output/hand_made_run.h"

namespace quayside::harness {
namespace {

namespace fs = std::filesystem;

EvaluatedRun evaluated_run() {
  RunResult run = hand_made_run({sinking_load("simbody"), sinking_load("mujoco", 0.25, 0.1)});
  cases::Expectation good, bad, elsewhere;
  good.signal = bad.signal = elsewhere.signal = "load.position.z";
  good.value = bad.value = elsewhere.value = 0;
  good.tolerance = elsewhere.tolerance = 1e-9;
  bad.value = 1;
  bad.tolerance = 0.5;
  elsewhere.engine = "mujoco_same_law";
  run.description.expectations = {good, bad, elsewhere};
  return evaluate(std::move(run));
}

TEST(Summary, HoldsWhatIsPromised) {
  const auto json = summary(evaluated_run(), "quayside run cases/sinking.yaml");
  EXPECT_EQ(json.at("case").at("name"), "sinking");
  EXPECT_EQ(json.at("command"), "quayside run cases/sinking.yaml");
  for (const char* part : {"quayside", "simbody", "sundials", "mujoco"}) EXPECT_NE(json.at("versions").at(part), "") << part;

  EXPECT_EQ(json.at("scene").at("bodies"), 2);
  EXPECT_EQ(json.at("scene").at("degrees_of_freedom"), 6);
  EXPECT_EQ(json.at("scene").at("contact_pairs"), 1);
  EXPECT_EQ(json.at("scene").at("before_reduction").at("bodies"), 3);
  EXPECT_EQ(json.at("scene").at("left_out").at(0).at("what"), "spreader merged into load");

  EXPECT_EQ(json.at("contact").at("law"), "potential");
  EXPECT_EQ(json.at("contact").at("model"), "committee");
  EXPECT_EQ(json.at("solver").at("relative_tolerance"), 1e-6);

  const auto& simbody = json.at("engines").at("simbody");
  EXPECT_EQ(simbody.at("wall_s"), 0.5);
  EXPECT_EQ(simbody.at("simulated_s"), 10);
  EXPECT_EQ(simbody.at("real_time_factor"), 20);
  EXPECT_EQ(simbody.at("steps"), 250);
  EXPECT_EQ(simbody.at("rhs_evaluations"), 700);
  EXPECT_EQ(simbody.at("contact_queries"), 5000);
  EXPECT_EQ(simbody.at("network_evaluations"), 4900);
  EXPECT_EQ(simbody.at("contact_fallbacks"), 20);
  EXPECT_EQ(simbody.at("phantom_contacts"), 0);
  EXPECT_TRUE(simbody.at("failure").is_null());
  // 100 steps of 1 to 100 ms: by nearest rank the 50th, the 99th and the last.
  EXPECT_EQ(simbody.at("step_time_s").at("median"), 1e-3 * 50);
  EXPECT_EQ(simbody.at("step_time_s").at("p99"), 1e-3 * 99);
  EXPECT_EQ(simbody.at("step_time_s").at("max"), 1e-3 * 100);
  // kinetic 100, potential 900, work 500, dissipated 1500, start 2000: nothing missing.
  EXPECT_EQ(simbody.at("energy").at("start"), 2000);
  EXPECT_EQ(simbody.at("energy").at("end"), 1000);
  EXPECT_EQ(simbody.at("energy").at("work_in"), 500);
  EXPECT_EQ(simbody.at("energy").at("dissipated"), 1500);
  EXPECT_EQ(simbody.at("energy").at("residual"), 0);
  EXPECT_EQ(simbody.at("energy").at("largest_exchange"), 1600);

  const auto& comparison = json.at("comparison").at("mujoco");
  EXPECT_EQ(comparison.at("reference"), "simbody");
  EXPECT_NEAR(comparison.at("signals").at("load.position").at("rms"), 0.25, 1e-12);
  EXPECT_NEAR(comparison.at("signals").at("load.position").at("max"), 0.25, 1e-12);
  EXPECT_NEAR(comparison.at("signals").at("load.position").at("end"), 0.25, 1e-12);
  EXPECT_NEAR(comparison.at("events").at("matched").at(0).at("time_shift"), 0.1, 1e-9);

  ASSERT_EQ(json.at("expectations").size(), 3u);
  EXPECT_EQ(json.at("expectations").at(0).at("verdict"), "passed");
  EXPECT_EQ(json.at("expectations").at(1).at("verdict"), "failed");
  EXPECT_NEAR(json.at("expectations").at(1).at("measured"), 0, 1e-9);
  EXPECT_EQ(json.at("expectations").at(2).at("verdict"), "not checked");
  EXPECT_EQ(json.at("interrupted"), false);
}

TEST(Summary, ARunThatDidNotBeginIsToldAsWell) {
  EngineRun broken;
  broken.engine = "simbody";
  broken.failure = "no initial state";
  const EvaluatedRun evaluated = evaluate(hand_made_run({broken, sinking_load("mujoco")}));
  EXPECT_FALSE(evaluated.completed());
  const auto json = summary(evaluated, "");
  EXPECT_EQ(json.at("engines").at("simbody").at("failure"), "no initial state");
  EXPECT_TRUE(json.at("engines").at("simbody").at("real_time_factor").is_null());
  EXPECT_TRUE(json.at("engines").at("simbody").at("step_time_s").at("median").is_null());
  EXPECT_EQ(json.at("comparison").at("mujoco").at("samples"), 0);
  EXPECT_NE(run_text(evaluated, Style{}).find("no initial state"), std::string::npos);
}

TEST(EvaluatedRun, OnlyAFailedExpectationCounts) {
  EvaluatedRun evaluated = evaluated_run();
  EXPECT_FALSE(evaluated.expectations_hold());
  evaluated.expectations.erase(evaluated.expectations.begin() + 1);
  EXPECT_TRUE(evaluated.expectations_hold());  // one passed, one not checked
}

TEST(RunText, TellsWhatMatters) {
  const std::string text = run_text(evaluated_run(), Style{});
  for (const char* part : {"A load sinks", "2 bodies (of 3), 6 degrees of freedom (of 12), 1 contact pair (of 4)",
                           "spreader merged into load", "twistlocks stay closed", "0.4 %", "simbody and mujoco apart",
                           "load.position", "0.25", "6.5000 s", "6.6000 s", "peak force load/upper", "600 kN", "✓", "✗",
                           "not checked: mujoco_same_law was not run"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  EXPECT_EQ(text.find('\033'), std::string::npos) << "colours where none were asked for";
}

class OutputDirectory : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(directory_); }
  void TearDown() override { fs::remove_all(directory_); }
  const fs::path directory_ = fs::temp_directory_path() / ("quayside_output_test_" + std::to_string(getpid()));
};

TEST_F(OutputDirectory, IsWrittenAndReadBack) {
  const EvaluatedRun evaluated = evaluated_run();
  prepare_output_directory(directory_ / "deep" / "down");
  const auto written = write_output(directory_ / "deep" / "down", evaluated, "command");
  EXPECT_EQ(written, (std::vector<std::string>{"trajectory_simbody.csv", "trajectory_mujoco.csv", "events.csv", "summary.json"}));

  const StoredRun stored = read_run(directory_ / "deep" / "down");
  ASSERT_EQ(stored.trajectories.size(), 2u);
  EXPECT_EQ(stored.trajectories.at("mujoco").columns, evaluated.run.engines[1].trajectory.columns);
  EXPECT_EQ(stored.events.at("mujoco").events.size(), 4u);
  EXPECT_EQ(stored.events.at("mujoco").open_contacts.size(), 1u);

  std::ifstream file(directory_ / "deep" / "down" / "summary.json");
  EXPECT_EQ(nlohmann::ordered_json::parse(file), summary(evaluated, "command"));
}

TEST_F(OutputDirectory, KeepsNothingOfAnEarlierRunAndNothingElseIsTouched) {
  prepare_output_directory(directory_);
  write_output(directory_, evaluated_run(), "");
  std::ofstream(directory_ / "notes.txt") << "mine";
  prepare_output_directory(directory_);
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(directory_)) left.push_back(entry.path().filename().string());
  EXPECT_EQ(left, std::vector<std::string>{"notes.txt"});
}

TEST_F(OutputDirectory, IsRefusedWhereItCannotBe) {
  std::ofstream(directory_) << "a file";
  EXPECT_THROW(prepare_output_directory(directory_), std::runtime_error);
  EXPECT_THROW(prepare_output_directory(directory_ / "below"), std::runtime_error);
  EXPECT_THROW(read_run(directory_ / "nowhere"), std::runtime_error);
}

}  // namespace
}  // namespace quayside::harness
