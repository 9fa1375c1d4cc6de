#include "harness/simbody/block_lu.h"

#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace quayside::harness {
namespace {

// A matrix like that of a chain of bodies, each coupled to the next: blocks of 5 with members far apart in the matrix, as
// coordinates and speeds of one body are. Condition numbers are some hundreds: 1e-10 leaves room for them.
TEST(BlockLu, SolvesAsTheDenseSolverDoes) {
  constexpr int kBlocks = 6, kSize = 30;
  std::vector<std::vector<int>> blocks(kBlocks);
  for (int i = 0; i < kSize; ++i) blocks[i % kBlocks].push_back(i);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  BlockLu lu(kSize, blocks);
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(kSize, kSize);
    for (int i = 0; i < kSize; ++i) {
      for (int j = 0; j < kSize; ++j) {
        // A ring, so that elimination fills blocks that were zero.
        const int apart = std::abs(i % kBlocks - j % kBlocks);
        if (apart == 0 || apart == 1 || apart == kBlocks - 1) a(i, j) = (apart == 0 ? 3 : 0.5) * normal(random);
      }
    }
    const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(kSize, [&] { return normal(random); });
    Eigen::VectorXd b = a * x;
    ASSERT_TRUE(lu.factor(a.data()));
    lu.solve(b.data());
    EXPECT_LT((b - x).norm(), 1e-10 * x.norm() * a.norm() * a.inverse().norm());
  }
}

// Newton's matrix of an oscillator at a long step: a zero on the diagonal, so that rows have to change places.
TEST(BlockLu, ExchangesRowsWhereThePivotIsZero) {
  BlockLu lu(2, {});
  const double a[] = {0, 2, 1, 3};  // column after column
  double b[] = {5, 21};             // x = (3, 5): y = 5, 2 x + 3 y = 21
  ASSERT_TRUE(lu.factor(a));
  lu.solve(b);
  EXPECT_DOUBLE_EQ(b[0], 3);
  EXPECT_DOUBLE_EQ(b[1], 5);
}

TEST(BlockLu, SaysWhereThereIsNoSolution) {
  BlockLu lu(2, {});
  const double a[] = {1, 2, 2, 4};
  EXPECT_FALSE(lu.factor(a));
}

}  // namespace
}  // namespace quayside::harness
