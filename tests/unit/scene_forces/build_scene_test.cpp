#include "harness/build_scene.h"

#include <filesystem>

#include <gtest/gtest.h>

namespace quayside::harness {
namespace {

using cases::Case;
using cases::CaseError;
using crane_models::Scene;

cases::ContainerSpec container(const std::string& name, const Eigen::Vector3d& position) {
  cases::ContainerSpec spec;
  spec.name = name;
  spec.mass = 24000;
  spec.position = position;
  return spec;
}

// A crane with its load over a stack of two.
Case landing() {
  Case description;
  description.file = "landing.yaml";
  description.duration = 10;
  description.crane.type = "quayside";
  description.crane.trolley_position = 20;
  description.crane.trolley_height = 32;
  description.crane.rope_length = 20;
  description.spreader = cases::SpreaderSpec{};
  description.spreader->skew = 2;
  auto load = container("load", {0, 0, 0});
  load.on_spreader = true;
  auto upper = container("upper", {0, 0, 0});
  upper.on_top_of = "lower";
  upper.offset = {0.03, 0.02};
  upper.yaw = 90;
  auto lower = container("lower", {0, 20, 0});
  lower.yaw = 90;
  description.containers = {load, upper, lower};
  return description;
}

int index_of(const Scene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].name == name) return static_cast<int>(i);
  }
  ADD_FAILURE() << "no body " << name;
  return 0;
}

Eigen::Vector3d reported(const Scene& scene, const std::string& name) {
  for (const auto& frame : scene.frames) {
    if (frame.name == name) return scene.bodies[frame.body].X_WB * frame.X_BR.translation();
  }
  ADD_FAILURE() << "no frame " << name;
  return {};
}

// The message must contain all of the words, or a person would not know what to change.
void expect_refused(const Case& description, const std::vector<std::string>& words) {
  try {
    build_scene(description);
    ADD_FAILURE() << "accepted";
  } catch (const CaseError& error) {
    for (const auto& word : words) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << " is not in: " << error.what();
    }
  }
}

TEST(BuildScene, PlacesContainersByTheirBottoms) {
  const Scene scene = build_scene(landing());
  EXPECT_LT((reported(scene, "lower") - Eigen::Vector3d(0, 20, 0)).norm(), 1e-12);
  // The offset is along the edges of the lower one, which is turned by 90°: (0.03, 0.02) becomes (−0.02, 0.03).
  EXPECT_LT((reported(scene, "upper") - Eigen::Vector3d(-0.02, 20.03, 2.591)).norm(), 1e-12);
  // Both yaws add up to 180°.
  EXPECT_NEAR(scene.bodies[index_of(scene, "upper")].X_WB(0, 0), -1, 1e-12);
  EXPECT_NEAR(reported(scene, "load").y(), 20, 1e-12);
}

TEST(BuildScene, PairsEverythingThatCouldMeet) {
  // spreader, load, upper, lower, ground: 10 pairs, all of which may meet; the trolley has no boxes.
  Case description = landing();
  EXPECT_EQ(build_scene(description).pairs.size(), 10u);
  // A lower container that is part of the ground has no contact with it.
  description.containers[2].fixed = true;
  EXPECT_EQ(build_scene(description).pairs.size(), 9u);
  description.ground = false;
  EXPECT_EQ(build_scene(description).pairs.size(), 6u);
}

TEST(BuildScene, GroundIsFlatAtZeroAndUnderEverything) {
  const Scene scene = build_scene(landing());
  const auto& ground = scene.bodies[index_of(scene, "ground")];
  const auto& half = ground.boxes[0].half;
  const Eigen::Vector3d centre = ground.X_WB.translation();
  EXPECT_DOUBLE_EQ(centre.z() + half.z(), 0);
  EXPECT_TRUE(ground.is_static());
  for (const auto& body : scene.bodies) {
    const Eigen::Vector2d reach = (body.X_WB.translation() - centre).head<2>().cwiseAbs();
    EXPECT_TRUE((reach.array() < half.head<2>().array() - (&body == &ground ? 0 : 20)).all()) << body.name;
  }
}

TEST(BuildScene, ASceneNeedsNoCrane) {
  Case description;
  cases::BodySpec box;
  box.name = "box";
  box.mass = 10;
  box.position = {0, 0, 5};
  box.velocity = {1, 2, 3};
  box.angular_velocity = {4, 5, 6};
  description.bodies = {box};
  description.ground = false;
  description.gravity = {1, 0, 0};
  const Scene scene = build_scene(description);
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_EQ(scene.bodies[0].v_WB, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(scene.bodies[0].w_WB, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(reported(scene, "box"), Eigen::Vector3d(0, 0, 5));
  EXPECT_TRUE(scene.pairs.empty());
  EXPECT_EQ(scene.gravity, Eigen::Vector3d(1, 0, 0));
}

TEST(BuildScene, RefusesOverlaps) {
  Case description = landing();
  description.containers.push_back(container("other", {1, 20, 0.5}));
  expect_refused(description, {"landing.yaml", "upper", "other", "0.500 m", "allow_overlap"});
  description.allow_overlap = true;
  EXPECT_NO_THROW(build_scene(description));

  description = landing();
  description.containers[2].position.z() = -0.5;
  expect_refused(description, {"lower", "ground", "0.500 m"});
}

TEST(BuildScene, RefusesRopesOfTheWrongLength) {
  Case description = landing();
  description.crane.rope_length = 29;
  expect_refused(description, {"crane.hoist.rope_length", "load", "ground", "at most about 28."});
  description = landing();
  description.crane.rope_length = 0.6;
  expect_refused(description, {"crane.hoist.rope_length", "between trolley and headblock"});
}

TEST(BuildScene, RefusesADriveThatStartsBeyondItsLimitSwitches) {
  Case description = landing();
  description.crane.hoist.range = Eigen::Vector2d(2, description.crane.rope_length - 1);
  expect_refused(description, {"crane", "hoist", "its range"});
}

TEST(BuildScene, RefusesACraneWithoutWeight) {
  Case description = landing();
  description.gravity = {0, 0, 0};
  expect_refused(description, {"gravity"});
}

TEST(BuildScene, RefusesACentreOfGravityOutsideTheBox) {
  Case description = landing();
  description.containers[0].centre_of_gravity = {0, 1.3, 0};
  expect_refused(description, {"containers.load.centre_of_gravity", "1.219"});
}

TEST(BuildScene, EveryShippedCaseIsAScene) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("cases")) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path().string());
    LeftOut left_out;  // of a yard, which is too large to be simulated as a whole
    const Scene scene = build_scene(cases::load_case(entry.path()), left_out);
    EXPECT_GT(degrees_of_freedom(scene), 0);
    ++count;
  }
  EXPECT_GE(count, 3);
}

TEST(BuildScene, OverridesOfTheMachineReachTheScene) {
  Case description = landing();
  description.crane.rope_stiffness = 1e9;
  description.crane.rope_damping_time = 0;
  description.crane.trolley_sheaves = description.crane.spreader_sheaves = Eigen::Vector2d(5, 2);
  description.crane.hoist.max_speed = 0.9;
  description.spreader->mass = 9000;
  description.spreader->lock_stiffness = 3e8;
  const Scene scene = build_scene(description);
  for (const auto& rope : scene.ropes) {
    EXPECT_EQ(rope.axial_stiffness, 1e9);
    EXPECT_EQ(rope.damping_time, 0);
    EXPECT_EQ(rope.lower.p_B.head<2>().cwiseAbs(), Eigen::Vector2d(2.5, 1));
  }
  EXPECT_EQ(scene.locks[0].stiffness, 3e8);
  EXPECT_DOUBLE_EQ(scene.bodies[index_of(scene, "spreader")].mass, 9000);
  EXPECT_EQ(scene.drives[1].max_speed, 0.9);
}

}  // namespace
}  // namespace quayside::harness
