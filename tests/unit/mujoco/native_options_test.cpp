#include "harness/mujoco/native_options.h"

#include <gtest/gtest.h>

#include "harness/mujoco/guard.h"
#include "harness/mujoco/phantom.h"
#include "tests/unit/mujoco/scenes.h"

namespace quayside::harness::mujoco {
namespace {

using contact_nn::Box;
using contact_nn::Pose;

TEST(NativeOptions, DampingRatioOfAKnownRestitution) {
  // Linear spring and damper without pull, ζ = 0.3: e = exp[−ζ/s atan2(2ζs, 2ζ² − 1)] = 0.451 with s = √(1 − ζ²).
  EXPECT_NEAR(damping_ratio(0.451), 0.3, 2e-4);  // three digits of e, de/dζ ≈ −1.1
  EXPECT_EQ(damping_ratio(1), 0);
  EXPECT_NEAR(damping_ratio(std::exp(-2.0)), 1, 1e-6);  // critical damping: the limit of the formula
  EXPECT_GT(damping_ratio(0.05), 1);
}

// The containers' footprint is 29.7 m² to three digits; a plane is met in four corners.
TEST(NativeOptions, PressedFlat) {
  const ProcessHooks hooks;
  crane_models::Scene scene;
  scene.bodies.push_back(ground());
  scene.bodies.push_back(box_body("lower", 1000, {12.192, 2.438, 2.591}, {0, 0, 1.3}));
  scene.bodies.push_back(box_body("upper", 1000, {12.192, 2.438, 2.591}, {0, 0, 4}));
  scene.bodies[2].X_WB.rotate(Eigen::AngleAxisd(0.035, Eigen::Vector3d::UnitZ()));
  const FlatContact on_ground = press_flat(scene, {1, 0, 0, 0});
  EXPECT_NEAR(on_ground.area, 12.192 * 2.438, 1e-12);
  EXPECT_EQ(on_ground.points, 4);
  EXPECT_NEAR(on_ground.reported_depth, 1, 1e-9);
  const FlatContact stacked = press_flat(scene, {1, 0, 2, 0});
  EXPECT_GE(stacked.points, 8);  // the rectangles cross in an octagon
#if mjVERSION_HEADER == 222
  EXPECT_NEAR(stacked.reported_depth, 0.5, 1e-9);
#endif
}

TEST(Phantom, HandMadeContacts) {
  const Box a{{1, 1, 1}}, b{{1, 1, 1}};
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const Pose overlapping(Eigen::Translation3d(0.5, 0, 1.99));  // b stands 10 mm inside a's top
  EXPECT_FALSE(is_phantom(a, b, overlapping, {{1, 1, 0.995}, z, 0.01}));
  EXPECT_FALSE(is_phantom(a, b, overlapping, {{1, 1, 0.995}, z, 0.005}));  // half the depth is no phantom
  EXPECT_TRUE(is_phantom(a, b, overlapping, {{1, 1, 0.995}, z, 0.02}));    // deeper than the overlap
  EXPECT_TRUE(is_phantom(a, b, overlapping, {{-0.9, 0, 0.995}, z, 0.01}));  // beside b
  EXPECT_TRUE(is_phantom(a, b, overlapping, {{0.5, 0, 0.5}, z, 0.01}));     // far below b
  EXPECT_TRUE(is_phantom(a, b, Pose(Eigen::Translation3d(0.5, 0, 2.01)), {{1, 1, 1}, z, 0.0}));  // apart
}

}  // namespace
}  // namespace quayside::harness::mujoco
