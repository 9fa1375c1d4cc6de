#include "crane_models/rope_crane.h"

#include <gtest/gtest.h>

#include "crane_models/load_bodies.h"

namespace quayside::crane_models {
namespace {

RopeCrane loaded_crane() {
  RopeCrane crane = quayside_crane();
  crane.trolley_position = 20;
  crane.trolley_height = 32;
  crane.rope_length = 20;
  crane.load_side.loads = {{"load", 30480}};
  return crane;
}

const Body& body(const Scene& scene, const std::string& name) {
  for (const Body& candidate : scene.bodies) {
    if (candidate.name == name) return candidate;
  }
  throw std::out_of_range(name);
}

TEST(RopeCrane, IsASceneThatEnginesCanBuild) {
  Scene scene;
  add_rope_crane(loaded_crane(), scene);
  EXPECT_NO_THROW(check(scene));
  EXPECT_EQ(degrees_of_freedom(scene), 12);
  EXPECT_EQ(scene.ropes.size(), 4u);
  Scene without_load;
  RopeCrane crane = loaded_crane();
  crane.load_side.loads.clear();
  add_rope_crane(crane, without_load);
  EXPECT_NO_THROW(check(without_load));
  EXPECT_TRUE(without_load.commands.empty());
}

TEST(RopeCrane, TrolleyRunsAlongTheBoom) {
  // At coordinate q of its slider the trolley stands at y = q, upright: X_WB = X_PF · T(q, 0, 0) · X_BM⁻¹.
  Scene scene;
  add_rope_crane(loaded_crane(), scene);
  const Body& trolley = body(scene, "trolley");
  const double q = scene.drives[trolley.joint.drive].start;
  const Pose X_WB = trolley.joint.X_PF * Eigen::Translation3d(q, 0, 0) * trolley.joint.X_BM.inverse();
  EXPECT_TRUE(X_WB.isApprox(trolley.X_WB, 1e-14));
  EXPECT_TRUE(X_WB.translation().isApprox(Eigen::Vector3d(0, 20, 32), 1e-14));
  EXPECT_TRUE(X_WB.linear().isIdentity(1e-14));
}

TEST(RopeCrane, LoadHangsUnderTheSpreaderByTheStretchOfTheTwistlocks) {
  RopeCrane crane = loaded_crane();
  crane.anchor_skew = 0.03;
  Scene scene;
  add_rope_crane(crane, scene);
  const Body& spreader = body(scene, "spreader");
  const Body& load = body(scene, "load");
  const Pose X_SL = spreader.X_WB.inverse() * load.X_WB;
  const double gap = -(X_SL.translation().z() + load.boxes[0].half.z());
  EXPECT_NEAR(gap, 30480 * 9.81 / 4e8, 1e-12);
  EXPECT_NEAR(std::atan2(spreader.X_WB(1, 0), spreader.X_WB(0, 0)), 0.03, 1e-14);
  EXPECT_TRUE(X_SL.linear().isIdentity(1e-14));
  EXPECT_EQ(scene.frames.back().name, "load");
  EXPECT_NEAR(scene.frames.back().X_BR.translation().z(), -2.591 / 2, 1e-15);
}

TEST(RopeCrane, LandsAtHalfTheWeightOfTheLoad) {
  Scene scene;
  add_rope_crane(loaded_crane(), scene);
  ASSERT_EQ(scene.landed_switches.size(), 1u);
  EXPECT_EQ(scene.landed_switches[0].bodies.size(), 2u);
  EXPECT_DOUBLE_EQ(scene.landed_switches[0].threshold, 30480 * 9.81 / 2);
}

}  // namespace
}  // namespace quayside::crane_models
