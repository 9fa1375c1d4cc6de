#include "spreader/mass_properties.h"

#include <gtest/gtest.h>

namespace quayside::spreader {
namespace {

TEST(MassProperties, ABoxIsTheSumOfItsHalves) {
  // Two halves of a box, one of them described in a frame of its own that is turned and shifted.
  const MassProperties whole = uniform_box(1000, {4, 2, 3});
  Eigen::Isometry3d X_WA = Eigen::Isometry3d::Identity(), X_WB = Eigen::Isometry3d::Identity();
  X_WA.translation().x() = -1;
  X_WB.translation().x() = 1;
  const Eigen::Isometry3d X_BC(Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 2) / 3));
  const MassProperties half = uniform_box(500, {2, 2, 3});
  const MassProperties in_C = moved(half, X_BC.inverse());
  const MassProperties both = combined(moved(half, X_WA), moved(in_C, X_WB * X_BC));
  EXPECT_NEAR(both.mass, whole.mass, 1e-9);
  EXPECT_LT(both.p_BBcm.norm(), 1e-12);
  EXPECT_TRUE(both.I_BBcm_B.isApprox(whole.I_BBcm_B, 1e-12));
  EXPECT_NEAR(whole.I_BBcm_B(0, 0), 1000.0 / 12 * (4 + 9), 1e-9);
}

}  // namespace
}  // namespace quayside::spreader
