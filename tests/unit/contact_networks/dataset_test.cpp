#include "contact_nn/dataset.h"

#include <set>

#include <gtest/gtest.h>

namespace quayside::contact_nn {
namespace {

const std::vector<PoseDomain>& all = all_pose_domains();

TEST(Dataset, TheSameSeedGivesTheSamePairs) {
  const auto a = sample_pairs(200, all, {}, 5), b = sample_pairs(200, all, {}, 5), c = sample_pairs(200, all, {}, 6);
  int different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].X_AB.matrix(), b[i].X_AB.matrix());
    EXPECT_EQ(a[i].a.half, b[i].a.half);
    different += a[i].X_AB.matrix() != c[i].X_AB.matrix();
  }
  EXPECT_GT(different, 190);
}

// Pairs lie in the shell that was asked for: overlaps to 50 mm, gaps to 20 mm. Few pairs cannot be brought there, since
// they stand beside each other whatever their height; they are farther apart, never deeper.
TEST(Dataset, PairsLieInTheShell) {
  for (const PoseDomain domain : {PoseDomain::landing, PoseDomain::aligned, PoseDomain::resting, PoseDomain::side}) {
    int inside = 0, touching = 0;
    const auto pairs = sample_pairs(3000, {domain}, {0.05, 0.02}, 1);
    for (const BoxPair& pair : pairs) {
      const double gap = separation(pair.a, pair.b, pair.X_AB);
      EXPECT_GT(gap, -0.05 - 1e-9);
      inside += gap < 0.02 + 1e-9;
      touching += gap < 0;
      EXPECT_LT((pair.X_AB.linear() * pair.X_AB.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    }
    EXPECT_GT(inside, 2700) << name_of(domain);
    EXPECT_GT(touching, 1500) << name_of(domain);
    EXPECT_LT(touching, 2700) << name_of(domain);
  }
}

TEST(Dataset, AlignedMeansAlignedToTheLastBit) {
  for (const BoxPair& pair : sample_pairs(500, {PoseDomain::aligned}, {}, 2)) {
    for (const double r : pair.X_AB.linear().reshaped()) EXPECT_TRUE(r == 0 || r == 1 || r == -1) << r;
  }
}

TEST(Dataset, CoversAllPairsThatCanMeet) {
  std::set<std::pair<double, double>> thicknesses;  // tells ground, deck, spreader and containers apart
  for (const BoxPair& pair : sample_pairs(2000, {PoseDomain::landing}, {}, 3)) {
    const auto kind = [](const Box& box) {
      const double z = box.half[2];
      return box.half[0] >= 10 ? 10.0 : z >= 0.2 && z <= 0.5 ? 0.25 : std::round(z * 1e4) / 1e4;
    };
    thicknesses.insert({kind(pair.a), kind(pair.b)});
  }
  for (const double lower : {10.0, 0.15, 0.25, 1.2955, 1.448}) {  // ground, deck, spreader, containers
    for (const double upper : {0.25, 1.2955, 1.448}) {
      EXPECT_TRUE(thicknesses.count({lower, upper})) << lower << " below " << upper;
      EXPECT_TRUE(thicknesses.count({upper, lower})) << "and the other way round";
    }
  }
  EXPECT_FALSE(thicknesses.count({10.0, 10.0}));
}

}  // namespace
}  // namespace quayside::contact_nn
