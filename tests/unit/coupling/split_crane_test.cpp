// A crane cut in three units, drives, trolley and load: each master has its order there as well.
#include "harness/coupling/split_crane.h"

#include <gtest/gtest.h>

namespace quayside::harness {
namespace {

// Pull and wishes are held over a step by Jacobi and Gauss-Seidel (first order), and are the mean of both ends with the
// iteration (second). Against the iteration at a quarter of the shorter step, which is wrong by a sixteenth of it at that;
// the ramps of the drives begin and end within steps, but events divide those there.
TEST(SplitCrane, MastersHaveTheirOrders) {
  const auto points = split_crane_errors({0.05, 0.025}, {}, 0.00625, 1.6);
  for (const SplitPoint& point : points) {
    if (point.step == 0.05) continue;
    EXPECT_NEAR(point.order, point.method == "iterated" ? 2 : 1, 0.3) << point.method;
  }
}

}  // namespace
}  // namespace quayside::harness
