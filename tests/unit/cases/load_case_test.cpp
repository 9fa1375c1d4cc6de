// What a case file says is what stands in the Case, and what it does not say has its default.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "cases/case.h"

namespace quayside::cases {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

const std::filesystem::path kEveryKey = "tests/unit/cases/every_key.yaml";

TEST(LoadCase, ReadsEveryKey) {
  const Case c = load_case(kEveryKey);
  EXPECT_EQ(c.file, kEveryKey);
  EXPECT_EQ(c.name, "every_key");
  EXPECT_EQ(c.title, "Every key of the format");
  EXPECT_EQ(c.duration, 30);

  EXPECT_EQ(c.crane.type, "quayside");
  EXPECT_EQ(c.crane.trolley_position, 20);
  EXPECT_EQ(c.crane.trolley_height, 32);
  EXPECT_EQ(c.crane.rope_length, 18);
  EXPECT_EQ(c.crane.trolley.max_speed, 4);
  EXPECT_EQ(c.crane.trolley.max_acceleration, 0.8);
  EXPECT_EQ(c.crane.hoist.max_speed, 1.5);
  EXPECT_EQ(c.crane.hoist.max_acceleration, 0.6);
  EXPECT_EQ(c.crane.trolley_sheaves, Vector2d(1.3, 5.78));
  EXPECT_EQ(c.crane.spreader_sheaves, Vector2d(0.8, 5.55));
  EXPECT_EQ(c.crane.rope_stiffness, 84e6);
  EXPECT_EQ(c.crane.rope_damping_time, 0.02);

  ASSERT_TRUE(c.spreader);
  EXPECT_EQ(c.spreader->size, ContainerType::iso40);
  EXPECT_EQ(c.spreader->skew, 2);
  EXPECT_EQ(c.spreader->mass, 12000);
  EXPECT_EQ(c.spreader->lock_stiffness, 1e8);

  ASSERT_EQ(c.containers.size(), 4u);
  const auto& [load, lower, upper] = std::tie(c.containers[0], c.containers[1], c.containers[2]);
  EXPECT_EQ(load.name, "load");
  EXPECT_EQ(load.type, ContainerType::iso40_high_cube);
  EXPECT_EQ(load.mass, 30480);
  EXPECT_TRUE(load.on_spreader);
  EXPECT_FALSE(load.on_top_of);
  EXPECT_EQ(load.centre_of_gravity, Vector3d(0.5, 0, -0.2));
  EXPECT_FALSE(lower.on_spreader);
  EXPECT_EQ(lower.position, Vector3d(0, 20, 0));
  EXPECT_EQ(lower.yaw, 1);
  EXPECT_TRUE(lower.fixed);
  EXPECT_EQ(upper.on_top_of, "lower");
  EXPECT_EQ(upper.offset, Vector2d(0.03, -0.02));
  EXPECT_EQ(upper.yaw, -1);
  EXPECT_FALSE(upper.fixed);

  ASSERT_EQ(c.bodies.size(), 2u);
  EXPECT_EQ(c.bodies[0].name, "box");
  EXPECT_EQ(c.bodies[0].size, Vector3d(1, 2, 3));
  EXPECT_EQ(c.bodies[0].mass, 500);
  EXPECT_EQ(c.bodies[0].position, Vector3d(0, 0, 4));
  EXPECT_EQ(c.bodies[0].velocity, Vector3d(1, 2, 3));
  EXPECT_EQ(c.bodies[0].angular_velocity, Vector3d(0.1, 0.2, 0.3));
  EXPECT_FALSE(c.bodies[0].fixed);
  EXPECT_TRUE(c.bodies[1].fixed);

  EXPECT_FALSE(c.ground);
  EXPECT_EQ(c.gravity, Vector3d(0.1, 0.2, -1.62));
  EXPECT_EQ(c.contact.model, "exact");
  EXPECT_EQ(c.contact.law, "points");
  EXPECT_EQ(c.contact.stiffness, 1e8);
  EXPECT_EQ(c.contact.restitution, 0.5);
  EXPECT_EQ(c.contact.reference_speed, 0.25);
  EXPECT_EQ(c.contact.friction, 0.3);
  EXPECT_EQ(c.contact.friction_law, "bristle");
  EXPECT_EQ(c.contact.transition_speed, 2e-3);
  EXPECT_EQ(c.contact.network, "gates/other.onnx");
  EXPECT_EQ(c.solver.relative_tolerance, 1e-8);
  EXPECT_EQ(c.solver.max_step, 0.1);
  EXPECT_EQ(c.solver.mujoco_step, 1e-4);
  EXPECT_EQ(c.solver.free_bodies, "direct");
  EXPECT_TRUE(c.allow_overlap);
  EXPECT_EQ(c.output_interval, 0.05);
}

TEST(LoadCase, ReadsTheMachines) {
  const Case c = load_case(kEveryKey);
  EXPECT_EQ(c.crane.gantry.position, -5);
  EXPECT_EQ(c.crane.trolley.max_jerk, 0.5);
  EXPECT_EQ(c.crane.hoist.emergency_stop, 1.5);
  EXPECT_EQ(c.crane.trim.position, 0.01);
  EXPECT_EQ(c.crane.list.position, -0.02);
  EXPECT_EQ(c.crane.skew.position, 0.03);
  EXPECT_EQ(c.crane.skew.max_speed, 0.02);
  EXPECT_EQ(c.crane.trolley.range, Eigen::Vector2d(-15, 50));
  EXPECT_EQ(c.crane.overload, 65000);
  EXPECT_EQ(c.crane.snag, 3e5);
  EXPECT_TRUE(c.spreader->flippers);
  ASSERT_TRUE(c.mafi);
  EXPECT_EQ(c.mafi->position, Eigen::Vector2d(0, 30));
  EXPECT_EQ(c.mafi->heading, 90);
  EXPECT_EQ(c.mafi->stiffness, 1e6);
  EXPECT_EQ(c.mafi->damping_ratio, 0.2);
  EXPECT_EQ(c.mafi->deck_height, 1.1);
  EXPECT_FALSE(c.mafi->guides);
  EXPECT_EQ(c.mafi->stuck, std::vector<std::string>{"rear_left"});
  EXPECT_EQ(c.mafi->drive.emergency_stop, 4);
  ASSERT_TRUE(c.wind);
  EXPECT_EQ(c.wind->direction, 45);
  EXPECT_EQ(c.wind->drag, 1.1);
  EXPECT_TRUE(c.containers[3].on_mafi);
  ASSERT_EQ(c.stacks.size(), 1u);
  EXPECT_EQ(c.stacks[0].rows, 3);
  EXPECT_EQ(c.stacks[0].spacing, Eigen::Vector2d(6.5, 3));

  const Case stacker = load_case("tests/unit/cases/every_key_of_a_reach_stacker.yaml");
  EXPECT_EQ(stacker.crane.type, "reach_stacker");
  EXPECT_EQ(stacker.crane.boom.position, 40);
  EXPECT_EQ(stacker.crane.rotation.max_jerk, 10);
  EXPECT_EQ(stacker.crane.telescope.max_speed, 0.3);
  EXPECT_EQ(stacker.crane.pivot_damping, 2e5);
  EXPECT_EQ(stacker.spreader->picks_up, std::vector<std::string>{"box"});
}

TEST(LoadCase, ReadsTheScript) {
  using Condition = ScriptEntry::Condition;
  using Speeds = std::vector<std::pair<std::string, double>>;
  using Commands = std::vector<std::pair<std::string, bool>>;
  const std::vector<ScriptEntry> script = load_case(kEveryKey).script;
  ASSERT_EQ(script.size(), 8u);
  EXPECT_EQ(script[0].condition, Condition::at);
  EXPECT_EQ(script[0].time, 0);
  EXPECT_EQ(script[0].speeds, (Speeds{{"hoist", -0.4}, {"trolley", 1}}));
  EXPECT_TRUE(script[0].commands.empty());
  EXPECT_EQ(script[1].condition, Condition::signal_below);
  EXPECT_EQ(script[1].signal, "load.position.z");
  EXPECT_EQ(script[1].threshold, 6);
  EXPECT_EQ(script[2].condition, Condition::signal_above);
  EXPECT_EQ(script[2].threshold, 30);
  EXPECT_EQ(script[3].condition, Condition::landed);
  EXPECT_EQ(script[3].after, 1.5);
  EXPECT_EQ(script[3].commands, (Commands{{"twistlocks", false}}));
  EXPECT_EQ(script[4].time, 25);
  EXPECT_EQ(script[4].commands, (Commands{{"twistlocks", true}}));
  EXPECT_EQ(script[5].speeds, (Speeds{{"gantry", 0.5}, {"trim", 0.02}, {"list", -0.01}, {"skew", 0.01}, {"mafi", 2}, {"wind", 20}}));
  EXPECT_EQ(script[5].ramps, (Speeds{{"mafi", 4}, {"wind", 1}}));
  EXPECT_EQ(script[5].commands, (Commands{{"mafi_twistlocks", false}}));
  EXPECT_EQ(script[6].condition, Condition::contact);
  EXPECT_TRUE(script[6].emergency_stop);
  EXPECT_EQ(script[7].condition, Condition::locked);
  EXPECT_EQ(script[7].ramps, (Speeds{{"hoist", 2}}));
}

TEST(LoadCase, ReadsTheExpectations) {
  using Kind = Expectation::Kind;
  using Moment = Expectation::Moment;
  const std::vector<Expectation> expect = load_case(kEveryKey).expectations;
  ASSERT_EQ(expect.size(), 6u);
  EXPECT_EQ(expect[0].kind, Kind::value);
  EXPECT_EQ(expect[0].signal, "load.position.z");
  EXPECT_EQ(expect[0].moment, Moment::end);
  EXPECT_EQ(expect[0].value, 5.182);
  EXPECT_EQ(expect[0].tolerance, 0.005);
  EXPECT_EQ(expect[0].engine, "mujoco");
  EXPECT_EQ(expect[0].why, "two boxes");
  EXPECT_EQ(expect[1].moment, Moment::time);
  EXPECT_EQ(expect[1].time, 12.5);
  EXPECT_EQ(expect[1].below, 1e-3);
  EXPECT_EQ(expect[1].above, -1);
  EXPECT_EQ(expect[1].engine, "simbody");
  EXPECT_EQ(expect[2].moment, Moment::minimum);
  EXPECT_EQ(expect[3].moment, Moment::maximum);
  EXPECT_EQ(expect[4].kind, Kind::comparison);
  EXPECT_EQ(expect[4].compare, "mujoco_same_law");
  EXPECT_EQ(expect[4].rms, 1e-4);
  EXPECT_EQ(expect[4].max, 1e-3);
  EXPECT_EQ(expect[5].kind, Kind::event);
  EXPECT_EQ(expect[5].event, "landed");
  EXPECT_EQ(expect[5].subject, "load");
  EXPECT_EQ(expect[5].earliest, 2);
  EXPECT_EQ(expect[5].latest, 8);
  EXPECT_EQ(expect[5].line, expect[4].line + 1);
}

// Roll, then pitch, then yaw about the axes of the world. Roll and yaw by 90 degrees: the box's x axis goes to y, its y
// axis goes up, its z axis goes to x.
TEST(LoadCase, TurnsBodiesByRollPitchYaw) {
  const Case c = load_case(kEveryKey, {"bodies.box.orientation={rpy: [90, 0, 90]}"});
  const Eigen::Matrix3d R_WB = c.bodies[0].orientation.toRotationMatrix();
  constexpr double kRounding = 1e-15;
  EXPECT_LT((R_WB.col(0) - Vector3d::UnitY()).norm(), kRounding);
  EXPECT_LT((R_WB.col(1) - Vector3d::UnitZ()).norm(), kRounding);
  EXPECT_LT((R_WB.col(2) - Vector3d::UnitX()).norm(), kRounding);
}

// [0.966, 0.259, 0, 0] stands for 30 degrees about x, written with three digits: its norm is 1.00012.
TEST(LoadCase, NormalisesQuaternions) {
  const Eigen::Quaterniond q = load_case(kEveryKey).bodies[1].orientation;
  EXPECT_NEAR(q.norm(), 1, 1e-15);                            // rounding
  EXPECT_NEAR(2 * std::atan2(q.x(), q.w()), M_PI / 6, 1e-3);  // three digits
}

TEST(LoadCase, FillsInDefaults) {
  const Case c = load_case("tests/unit/cases/smallest.yaml");
  EXPECT_EQ(c.crane.type, "none");
  EXPECT_FALSE(c.spreader);
  EXPECT_TRUE(c.containers.empty());
  EXPECT_TRUE(c.ground);
  EXPECT_EQ(c.gravity, Vector3d(0, 0, -9.81));
  EXPECT_EQ(c.contact.model, "committee");
  EXPECT_EQ(c.contact.law, "potential");
  EXPECT_EQ(c.contact.transition_speed, 1e-3);
  EXPECT_FALSE(c.allow_overlap);
  EXPECT_EQ(c.output_interval, 0.01);
  ASSERT_EQ(c.bodies.size(), 1u);
  EXPECT_EQ(c.bodies[0].velocity, Vector3d::Zero());
  EXPECT_EQ(c.bodies[0].orientation.coeffs(), Eigen::Quaterniond::Identity().coeffs());
}

TEST(LoadCase, KeepsTextOfAnyEncoding) {
  EXPECT_EQ(load_case("tests/unit/cases/smallest.yaml", {"title=Größe 40′"}).title, "Größe 40′");
  EXPECT_NO_THROW(load_case("tests/unit/cases/smallest.yaml", {"title=\xff\xfe\xc3("}));  // not UTF-8
}

TEST(LoadCase, OverridesValues) {
  const Case c = load_case(
      kEveryKey, {"duration=40", "crane.trolley.position=25", "containers.0.mass=10000", "containers.upper.mass=11000",
                  "gravity.2=-9.81", "containers.lower.position=[1, 2, 0]", "contact.friction=0.7", "title=a=b"});
  EXPECT_EQ(c.duration, 40);
  EXPECT_EQ(c.crane.trolley_position, 25);
  EXPECT_EQ(c.containers[0].mass, 10000);
  EXPECT_EQ(c.containers[2].mass, 11000);
  EXPECT_EQ(c.gravity, Vector3d(0.1, 0.2, -9.81));
  EXPECT_EQ(c.containers[1].position, Vector3d(1, 2, 0));
  EXPECT_EQ(c.contact.friction, 0.7);
  EXPECT_EQ(c.title, "a=b");
}

TEST(LoadCase, OverridesMakeMissingSections) {
  const Case c = load_case("tests/unit/cases/smallest.yaml",
                           {"contact.friction.coefficient=0.9", "solver.max_step=0.5", "ground=false"});
  EXPECT_EQ(c.contact.friction, 0.9);
  EXPECT_EQ(c.solver.max_step, 0.5);
  EXPECT_FALSE(c.ground);
}

TEST(LoadCase, LaterOverridesWin) { EXPECT_EQ(load_case(kEveryKey, {"duration=40", "duration=50"}).duration, 50); }

TEST(LoadCase, ShippedCasesLoad) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("cases")) {
    if (entry.path().extension() != ".yaml") continue;
    EXPECT_NO_THROW(load_case(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 4);
}

}  // namespace
}  // namespace quayside::cases
