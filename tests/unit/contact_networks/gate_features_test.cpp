#include "contact_nn/gate_features.h"

#include <gtest/gtest.h>

#include "contact_nn/dataset.h"

namespace quayside::contact_nn {
namespace {

const std::vector<PoseDomain>& all = all_pose_domains();

// A gate that says exactly what is wanted names every piece that is needed.
TEST(GateFeatures, WhatIsWantedNamesWhatIsNeeded) {
  Random random(1);
  for (const BoxPair& pair : sample_pairs(2000, all, {}, 1)) {
    const GateView view(pair.a, pair.b, pair.X_AB);
    PieceMask needed = possible_pieces(pair.a, pair.b, pair.X_AB);
    const auto logits = [&] { return PotentialOutputs(view.wanted(needed).array() - 0.5f); };
    EXPECT_TRUE((needed & ~view.named(logits())).none());
    needed.reset();
    EXPECT_TRUE(view.named(logits()).none());
    const int one = static_cast<int>(random.below(kPieceCount));  // a single piece is named alone
    needed.set(static_cast<std::size_t>(one));
    EXPECT_EQ(view.named(logits()), needed) << one;
  }
}

// Turning an axis of either box round changes the pose, not the boxes: a gate sees the same.
TEST(GateFeatures, MirrorImagesLookAlike) {
  Random random(2);
  for (const BoxPair& pair : sample_pairs(500, {PoseDomain::any, PoseDomain::landing}, {}, 2)) {
    const GateInputs inputs = GateView(pair.a, pair.b, pair.X_AB).inputs;
    Eigen::DiagonalMatrix<double, 3> turn_a(random.sign(), random.sign(), random.sign());
    Eigen::DiagonalMatrix<double, 3> turn_b(random.sign(), random.sign(), random.sign());
    Pose mirrored = pair.X_AB;
    mirrored.linear() = turn_a * pair.X_AB.linear() * turn_b;
    mirrored.translation() = turn_a * pair.X_AB.translation();
    // Sums of three terms in the same order: the same but for the signs of zeros.
    EXPECT_LT((GateView(pair.a, pair.b, mirrored).inputs - inputs).cwiseAbs().maxCoeff(), 1e-5);
  }
}

// Lengths count relative to each other: a model of 1 : 1024 looks like the original. By a power of two, so that every
// number keeps its digits and only its exponent changes.
TEST(GateFeatures, SizeDoesNotMatter) {
  for (const BoxPair& pair : sample_pairs(500, all, {}, 3)) {
    constexpr double scale = 0x1p-10;
    Pose small = pair.X_AB;
    small.translation() *= scale;
    const GateInputs inputs = GateView(pair.a, pair.b, pair.X_AB).inputs;
    EXPECT_EQ(GateView({pair.a.half * scale}, {pair.b.half * scale}, small).inputs, inputs);
  }
}

TEST(GateFeatures, InputsStayFiniteAndSmall) {
  const auto bounded = [](const Box& a, const Box& b, const Pose& X) {
    const GateInputs inputs = GateView(a, b, X).inputs;
    return inputs.allFinite() && inputs.cwiseAbs().maxCoeff() < 130;  // the logarithm of the largest float
  };
  Pose X = Pose::Identity();
  EXPECT_TRUE(bounded({{1, 1, 1}}, {{1, 1, 1}}, X));           // one inside the other
  X.translation().x() = 2;                                      // touching exactly: no depth at all
  EXPECT_TRUE(bounded({{1, 1, 1}}, {{1, 1, 1}}, X));
  X.translation() = Eigen::Vector3d(0, 0, 1.0005);
  EXPECT_TRUE(bounded({{200, 200, 1}}, {{5e-4, 5e-4, 5e-4}}, X));  // a millimetre on a yard
  X.translation() = Eigen::Vector3d(1e6, 0, 0);
  EXPECT_TRUE(bounded({{1, 1, 1}}, {{1, 1, 1}}, X));
}

TEST(GateFeatures, TopThreeAreTheLargest) {
  Random random(4);
  for (int trial = 0; trial < 1000; ++trial) {
    PointsOutputs outputs;
    for (float& y : outputs) y = static_cast<float>(random.normal());
    const auto top = top_three(outputs);
    EXPECT_GE(outputs[top[0]], outputs[top[1]]);
    EXPECT_GE(outputs[top[1]], outputs[top[2]]);
    for (int i = 0; i < kPointsOutputs; ++i) {
      const bool named = std::find(top.begin(), top.end(), i) != top.end();
      EXPECT_TRUE(named || outputs[i] <= outputs[top[2]]);
    }
    EXPECT_TRUE(top[0] != top[1] && top[1] != top[2] && top[0] != top[2]);
  }
}

}  // namespace
}  // namespace quayside::contact_nn
