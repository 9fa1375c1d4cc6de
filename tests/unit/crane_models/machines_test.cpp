// What all machines have in common, and what is particular to each.
#include <gtest/gtest.h>

#include "crane_models/mafi.h"
#include "crane_models/reach_stacker.h"
#include "crane_models/rope_crane.h"

namespace quayside::crane_models {
namespace {

constexpr double kG = 9.81;

Scene with_quayside() {
  Scene scene;
  RopeCrane crane = quayside_crane();
  crane.gantry_position = -7;
  crane.trolley_position = 20;
  crane.trolley_height = 32;
  crane.rope_length = 20;
  crane.load_side.loads = {{"load", 30480}};
  add_rope_crane(crane, scene);
  return scene;
}

Scene with_rtg() {
  Scene scene;
  RopeCrane crane = rubber_tyred_gantry();
  crane.gantry_position = 3;
  crane.trolley_position = 8;
  crane.trolley_height = 21;
  crane.rope_length = 12;
  add_rope_crane(crane, scene);
  return scene;
}

ReachStacker turned_stacker() {
  ReachStacker machine;
  machine.travel_position = 2;
  machine.boom_angle = 0.7;
  machine.telescope_length = 1.5;
  machine.rotation_angle = 0.3;
  machine.side_shift_position = 0.2;
  machine.load_side.loads = {{"load", 20000}};
  return machine;
}

Scene with_reach_stacker() {
  Scene scene;
  add_reach_stacker(turned_stacker(), scene);
  return scene;
}

Mafi loaded_mafi() {
  Mafi mafi;
  mafi.position = {3, 20};
  mafi.heading = 0.5;
  mafi.load = Load{"cargo", 24000};
  mafi.twistlocks = true;
  mafi.stuck[1] = true;
  return mafi;
}

Scene with_mafi() {
  Scene scene;
  add_mafi(loaded_mafi(), scene);
  return scene;
}

const Body& body(const Scene& scene, const std::string& name) {
  for (const Body& candidate : scene.bodies) {
    if (candidate.name == name) return candidate;
  }
  throw std::out_of_range(name);
}

class Machine : public ::testing::TestWithParam<std::pair<const char*, Scene (*)()>> {};

TEST_P(Machine, IsASceneThatEnginesCanBuild) { EXPECT_NO_THROW(check(GetParam().second())); }

// X_WB = X_WP · X_PF · (the joint at its start) · X_BM⁻¹: at the drive's start where a drive has it, else at zero, as
// everything hangs straight.
TEST_P(Machine, StandsWhereItsJointsSay) {
  const Scene scene = GetParam().second();
  for (const Body& b : scene.bodies) {
    if (b.joint.type == JointType::free) continue;
    const double q = b.joint.drive < 0 ? 0 : scene.drives[b.joint.drive].start;
    Pose X_FM = Pose::Identity();
    if (b.joint.type == JointType::slider) X_FM.translation().x() = q;
    if (b.joint.type == JointType::hinge) X_FM.rotate(Eigen::AngleAxisd(q, Eigen::Vector3d::UnitZ()));
    const Pose X_WP = b.joint.parent == kWorld ? Pose::Identity() : scene.bodies[b.joint.parent].X_WB;
    const Pose X_WB = X_WP * b.joint.X_PF * X_FM * b.joint.X_BM.inverse();
    // The link on the boom's tip hangs whatever the boom's angle: its coordinate is not zero.
    if (b.name == "link") {
      EXPECT_TRUE(X_WB.translation().isApprox(b.X_WB.translation(), 1e-12)) << b.name;
    } else {
      EXPECT_TRUE(X_WB.isApprox(b.X_WB, 1e-12)) << b.name << "\n" << X_WB.matrix() << "\n" << b.X_WB.matrix();
    }
  }
}

TEST_P(Machine, HasLimitsForEveryDrive) {
  for (const Drive& drive : GetParam().second().drives) {
    EXPECT_GT(drive.max_speed, 0) << drive.name;
    EXPECT_GT(drive.max_acceleration, 0) << drive.name;
    EXPECT_GE(drive.emergency_stop, drive.max_acceleration) << drive.name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Machine,
                         ::testing::Values(std::pair("quayside", with_quayside), std::pair("rtg", with_rtg),
                                           std::pair("reach_stacker", with_reach_stacker),
                                           std::pair("mafi", with_mafi)),
                         [](const auto& info) { return info.param.first; });

TEST(RopeCrane, TravelsWithTrolleyAndLoad) {
  const Scene scene = with_quayside();
  EXPECT_TRUE(body(scene, "trolley").X_WB.translation().isApprox(Eigen::Vector3d(-7, 20, 32), 1e-14));
  EXPECT_NEAR(body(scene, "load").X_WB.translation().x(), -7, 1e-14);
}

TEST(RopeCrane, TrimListAndSkewDifferInRopeLength) {
  RopeCrane crane = quayside_crane();
  crane.trolley_height = 32;
  crane.rope_length = 20;
  crane.trim_position = 0.04;
  crane.list_position = 0.02;
  crane.skew_position = 0.01;
  Scene scene;
  add_rope_crane(crane, scene);
  const auto extra = [&](const char* name) {
    for (const auto& rope : scene.ropes) {
      if (rope.name == name) return rest_length_at_start(scene, rope) - crane.rope_length;
    }
    throw std::out_of_range(name);
  };
  // Half of each difference to either side: front is +y, right +x.
  EXPECT_NEAR(extra("rope.front_right"), 0.02 + 0.01 + 0.005, 1e-14);
  EXPECT_NEAR(extra("rope.front_left"), -0.02 + 0.01 - 0.005, 1e-14);
  EXPECT_NEAR(extra("rope.rear_right"), 0.02 - 0.01 - 0.005, 1e-14);
  EXPECT_NEAR(extra("rope.rear_left"), -0.02 - 0.01 + 0.005, 1e-14);
}

TEST(ReachStacker, HoldsTheSpreaderUnderItsTip) {
  const ReachStacker machine = turned_stacker();
  const Scene scene = with_reach_stacker();
  // y = 2 − 4.6 + (8.4 + 1.5) cos 0.7, z = 4.3 + 9.9 sin 0.7
  EXPECT_NEAR(machine.tip().y(), 4.971938, 1e-6);
  EXPECT_NEAR(machine.tip().z(), 10.677755, 1e-6);
  const Body& spreader = body(scene, "spreader");
  EXPECT_NEAR(spreader.X_WB.translation().z(), machine.tip().z() - 0.5 - 1.4, 1e-12);
  EXPECT_NEAR(spreader.X_WB.translation().x(), 0.2 * std::cos(0.3), 1e-12);
  EXPECT_NEAR(spreader.X_WB.translation().y(), machine.tip().y() + 0.2 * std::sin(0.3), 1e-12);
  EXPECT_NEAR(std::atan2(spreader.X_WB(1, 0), spreader.X_WB(0, 0)), 0.3, 1e-12);
  EXPECT_EQ(degrees_of_freedom(scene), 2 + 6);  // two pivots, the load
}

TEST(Mafi, StandsInEquilibrium) {
  const Scene scene = with_mafi();
  const Body& deck = body(scene, "deck");
  EXPECT_NEAR(deck.X_WB.translation().z(), 1.2, 1e-14);
  EXPECT_NEAR(body(scene, "cargo").X_WB.translation().z(), 1.2 + 2.591 / 2, 1e-12);
  double lift = 0;
  for (const auto& pin : scene.locks[0].pins) {
    const Eigen::Vector3d offset = deck.X_WB * pin.p_B - body(scene, "mafi").X_WB * pin.p_A;
    lift -= scene.locks[0].stiffness * offset.z();
    EXPECT_LT(offset.head<2>().norm(), 1e-12);
  }
  EXPECT_NEAR(lift, (6000 + 24000) * kG, 1e-6);
}

TEST(Mafi, AStuckTwistlockHasNoCommand) {
  const Scene scene = with_mafi();
  ASSERT_EQ(scene.locks.size(), 3u);
  EXPECT_EQ(scene.locks[1].name, "mafi_twistlocks");
  EXPECT_EQ(scene.locks[1].pins.size(), 3u);
  EXPECT_GE(scene.locks[1].command, 0);
  EXPECT_EQ(scene.locks[2].name, "stuck_twistlock");
  ASSERT_EQ(scene.locks[2].pins.size(), 1u);
  EXPECT_EQ(scene.locks[2].command, -1);
  // Rear left of a tractor that drives towards +x: x negative, y positive.
  EXPECT_LT(scene.locks[2].pins[0].p_A.x(), 0);
  EXPECT_GT(scene.locks[2].pins[0].p_A.y(), 0);
  for (const auto& pin : scene.locks[2].pins) {
    EXPECT_LT((body(scene, "deck").X_WB * pin.p_A - body(scene, "cargo").X_WB * pin.p_B).norm(), 1e-12);
  }
}

TEST(LoadSide, TwinLoadsFillThePlaceOfAFortyFootBox) {
  Scene scene;
  RopeCrane crane = quayside_crane();
  crane.trolley_height = 32;
  crane.rope_length = 20;
  crane.load_side.spreader.twin = true;
  crane.load_side.loads = {{"west", 20000, spreader::ContainerSize::iso20},
                           {"east", 10000, spreader::ContainerSize::iso20}};
  add_rope_crane(crane, scene);
  EXPECT_NO_THROW(check(scene));
  EXPECT_NEAR(body(scene, "west").X_WB.translation().x() - 6.058 / 2, -12.192 / 2, 1e-12);
  EXPECT_NEAR(body(scene, "east").X_WB.translation().x() + 6.058 / 2, 12.192 / 2, 1e-12);
  ASSERT_EQ(scene.locks.size(), 2u);
  EXPECT_EQ(scene.locks[0].command, scene.locks[1].command);
  for (const auto& lock : scene.locks) {
    for (const auto& pin : lock.pins) {
      // Apart by nothing but the stretch under the load.
      const Eigen::Vector3d offset = scene.bodies[lock.body_b].X_WB * pin.p_B - scene.bodies[lock.body_a].X_WB * pin.p_A;
      EXPECT_LT(offset.head<2>().norm(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace quayside::crane_models
