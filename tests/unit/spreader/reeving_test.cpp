#include "spreader/reeving.h"

#include <cmath>

#include <gtest/gtest.h>

namespace quayside::spreader {
namespace {

TEST(Reeving, ParallelRopesHangAtTheirStretch) {
  // Four ropes of EA = 84 MN and 20 m under 400 kN: each stretches by 100 kN · 20 m / 84 MN.
  const Eigen::Vector2d rectangle(5, 1);
  EXPECT_NEAR(hanging_height(rectangle, rectangle, 84e6, 20, 400e3), 20 * (1 + 100e3 / 84e6), 1e-13);
}

TEST(Reeving, SlantedRopesCarryTheWeight) {
  const Eigen::Vector2d upper(5.78, 1.30), lower(5.55, 0.80);
  for (const double rest_length : {0.5, 2.0, 20.0, 40.0}) {
    const double weight = 400e3, ea = 84e6;
    const double h = hanging_height(upper, lower, ea, rest_length, weight);
    const double l = std::hypot(h, (upper - lower).norm() / 2);
    // The height is known to its last bit, 4e-15 m, which is 4·EA/L0·4e-15 N of force.
    EXPECT_NEAR(4 * ea / rest_length * (l - rest_length) * h / l, weight, 4 * ea / rest_length * 1e-14 + 1e-9);
  }
}

TEST(Reeving, RopesTooShortToReachAreStretchedFlat) {
  // Half diagonals 3 m apart, ropes of 1 m: they carry a small weight nearly level, stretched to three times their
  // length.
  const double h = hanging_height({6, 0}, {0, 0}, 1e6, 1, 4000);
  EXPECT_NEAR(h, 4000 * 3 / (4 * 1e6 * 2), 1e-6);  // W l / (4 k (l − L0))
}

TEST(Reeving, CornersAreWhereTheirNamesSay) {
  SheaveRectangle upper, lower;
  upper.body = 0;
  upper.size = {6, 2};
  upper.turn = EIGEN_PI / 2;
  lower.body = 1;
  lower.size = {4, 1};
  lower.p_BR = {0, 0, 1};
  Rope like;
  like.axial_stiffness = 1;
  const auto ropes = reeve(upper, lower, like);
  EXPECT_EQ(ropes[0].name, "rope.front_left");
  EXPECT_EQ(ropes[0].lower.p_B, Eigen::Vector3d(-2, 0.5, 1));
  EXPECT_TRUE(ropes[0].upper.p_B.isApprox(Eigen::Vector3d(-1, -3, 0), 1e-15));  // (−3, 1) turned by 90°
  EXPECT_EQ(ropes[3].name, "rope.rear_right");
  EXPECT_EQ(ropes[3].lower.p_B, Eigen::Vector3d(2, -0.5, 1));
  EXPECT_EQ(ropes[3].lower.body, 1);
}

}  // namespace
}  // namespace quayside::spreader
