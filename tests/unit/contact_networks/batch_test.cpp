#include "contact_nn/batch.h"

#include <gtest/gtest.h>

#include "tests/unit/contact_networks/heap_counter.h"

namespace quayside::contact_nn {
namespace {

// Both add up the same terms, perhaps in another order: some ten roundings of 1e-16 of the boxes' size each.
double tolerance(const BoxPair& pair) {
  return 1e-14 * (pair.a.half.sum() + pair.b.half.sum() + pair.X_AB.translation().lpNorm<1>());
}

std::vector<BoxPair> yard(std::size_t count, std::uint64_t seed) {
  return sample_pairs(count, all_pose_domains(), {0.05, 1.0}, seed);
}

TEST(Batch, SeparationsAreThoseOfSinglePairs) {
  const auto pairs = yard(40000, 1);
  std::vector<GapAndAxis> answers(pairs.size());
  separations(pairs.data(), pairs.size(), answers.data());
  std::size_t other_axis = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const AxisSeparation single = largest_separation(pairs[i].a, pairs[i].b, pairs[i].X_AB);
    // Edge axes are divided by their sine, and so is their rounding: at most by the share by which they won.
    ASSERT_NEAR(answers[i].gap, single.gap, 1e-9 * std::abs(single.gap) + tolerance(pairs[i])) << i;
    other_axis += answers[i].axis != single.axis;
  }
  EXPECT_LT(other_axis, pairs.size() / 100);  // ties of aligned boxes
}

TEST(Batch, AnyCountWillDoAndNothingBeyondItIsWritten) {
  const auto pairs = yard(40, 2);
  std::vector<GapAndAxis> all(pairs.size());
  separations(pairs.data(), pairs.size(), all.data());
  for (std::size_t count = 0; count <= 20; ++count) {
    std::vector<GapAndAxis> answers(count + 1, {12345, -1});
    separations(pairs.data(), count, answers.data());
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(answers[i].gap, all[i].gap);
    EXPECT_EQ(answers[count].gap, 12345);
  }
}

TEST(Batch, FindsWhoTouches) {
  for (const std::size_t count : {0, 1, 7, 8, 9, 5003}) {
    const auto pairs = yard(std::max<std::size_t>(count, 1), 5);
    for (const double margin : {0.0, 0.05}) {
      std::vector<std::size_t> found(count), expected;
      found.resize(find_touching(pairs.data(), count, margin, found.data()));
      for (std::size_t i = 0; i < count; ++i)
        if (separation(pairs[i].a, pairs[i].b, pairs[i].X_AB) <= margin) expected.push_back(i);
      EXPECT_EQ(found, expected);
    }
  }
}

TEST(Batch, DoesNotTouchTheHeap) {
  const auto pairs = yard(101, 4);
  std::vector<GapAndAxis> gaps(pairs.size());
  std::vector<std::size_t> touching(pairs.size());
  const std::size_t before = heap_requests();
  separations(pairs.data(), pairs.size(), gaps.data());
  find_touching(pairs.data(), pairs.size(), 0, touching.data());
  EXPECT_EQ(heap_requests(), before);
}

}  // namespace
}  // namespace quayside::contact_nn
