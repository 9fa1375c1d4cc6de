#include "spreader/lock.h"

#include <gtest/gtest.h>

namespace quayside::spreader {
namespace {

Lock twistlock() {
  Lock lock;
  lock.stiffness = 1e8;
  lock.damping = 9e4;
  return lock;
}

TEST(Lock, PullsBackAlikeInAllDirections) {
  const Eigen::Vector3d offset(1e-3, -2e-3, 2e-3);  // 3 mm
  const PinLoad load = pin_load(twistlock(), offset, Eigen::Vector3d::Zero());
  EXPECT_EQ(load.force, -1e8 * offset);
  EXPECT_NEAR(load.energy, 0.5 * 1e8 * 9e-6, 1e-9);  // 450 J
  EXPECT_EQ(load.dissipated_power, 0);
}

TEST(Lock, DampingTakesItsOwnPower) {
  // Without a spring force all power −F·v is taken by the damper.
  const Eigen::Vector3d velocity(0.3, 0.1, -0.2);
  const PinLoad load = pin_load(twistlock(), Eigen::Vector3d::Zero(), velocity);
  EXPECT_NEAR(load.dissipated_power, -load.force.dot(velocity), 1e-12 * load.dissipated_power);
  EXPECT_GT(load.dissipated_power, 0);
}

}  // namespace
}  // namespace quayside::spreader
