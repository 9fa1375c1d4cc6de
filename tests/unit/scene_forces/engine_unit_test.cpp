#include "harness/engine_unit.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace quayside::harness {
namespace {

TEST(Nanoseconds, AreRoundedToNearest) {
  EXPECT_EQ(nanoseconds(0.1), 100'000'000);
  EXPECT_EQ(nanoseconds(-0.1), -100'000'000);
  EXPECT_EQ(nanoseconds(0.3 - 0.1), 200'000'000);  // 0.19999999999999998
  EXPECT_EQ(nanoseconds(2.5e-9), 3);
}

TEST(Nanoseconds, RefuseWhatTheyCannotHold) {
  EXPECT_THROW(nanoseconds(1e10), std::out_of_range);
  EXPECT_THROW(nanoseconds(-1e10), std::out_of_range);
  EXPECT_THROW(nanoseconds(std::nan("")), std::out_of_range);
}

TEST(EngineVariables, AreNamedAndOrdered) {
  crane_models::Scene scene;
  scene.drives = {{"hoist", "m", "rest length", 18, -1, 1, 1}};
  scene.commands = {{"twistlocks", "true: closed", true}};
  crane_models::Body body;
  body.boxes.resize(2);
  body.name = "a";
  scene.bodies = {body};
  body.name = "b";
  body.boxes[1].name = "load";
  scene.bodies.push_back(body);
  scene.pairs = {{0, 0, 1, 0}, {0, 0, 1, 1}, {0, 1, 1, 0}};
  scene.frames = {{"load", 1, crane_models::Pose::Identity()}};
  spreader::Rope rope;
  rope.name = "rope.front_left";
  scene.ropes = {rope};
  scene.landed_switches = {{"landed", {1}, 1}};

  std::vector<std::string> names;
  const auto variables = engine_variables(scene);
  for (const Variable& v : variables) names.push_back(v.name);
  const std::vector<std::string> expected{
      "hoist.value", "hoist.rate", "hoist.acceleration", "hoist.jerk", "twistlocks",
      "load.position.x", "load.position.y", "load.position.z",
      "load.orientation.w", "load.orientation.x", "load.orientation.y", "load.orientation.z",
      "load.velocity.x", "load.velocity.y", "load.velocity.z",
      "load.angular_velocity.x", "load.angular_velocity.y", "load.angular_velocity.z", "load.tilt",
      "rope.front_left.tension", "rope.front_left.stretch", "contact.a.b.force", "contact.a.load.force", "landed",
      "energy.kinetic", "energy.potential", "energy.work_in", "energy.dissipated", "energy.residual"};
  EXPECT_EQ(names, expected);
  EXPECT_EQ(variables[0].start, 18);
  EXPECT_EQ(variables[4].type, Type::boolean);
  EXPECT_EQ(variables[4].start, 1);
  EXPECT_EQ(variables[5].causality, Causality::output);
}

}  // namespace
}  // namespace quayside::harness
