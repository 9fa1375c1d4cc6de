#include "contact_nn/evaluation.h"

#include <gtest/gtest.h>

namespace quayside::contact_nn {
namespace {

// The short form of `quayside contact check`.
TEST(Evaluation, TheCommitteeAsDeployedIsNeverWrong) {
  EvaluationOptions options;
  options.poses = 120000;
  options.threads = 2;
  const Evaluation evaluation = evaluate_committee(options);
  ASSERT_EQ(evaluation.sizes.size(), 6u);
  for (const SizeVerdict& verdict : evaluation.sizes) {
    EXPECT_EQ(verdict.poses, options.poses / 6) << verdict.name;
    // What is judged are contacts as well as gaps.
    EXPECT_GT(verdict.touching, verdict.poses / 3) << verdict.name;
    EXPECT_LT(verdict.touching, verdict.poses * 9 / 10) << verdict.name;
    EXPECT_EQ(verdict.failures(), 0u) << verdict.name;
  }
  EXPECT_EQ(evaluation.failures(), 0u);
  // Crane poses are what the gate was trained for: at most one in a thousand names no axis that is right to a millimetre.
  EXPECT_LE(evaluation.gate[1].share(), evaluation.gate[1].allowed);
}

TEST(Evaluation, TheFiguresDoNotDependOnTheNumberOfThreads) {
  EvaluationOptions options;
  options.poses = 12000;
  options.threads = 1;
  const Evaluation one = evaluate_committee(options);
  options.threads = 3;
  const Evaluation three = evaluate_committee(options);
  for (std::size_t i = 0; i < one.sizes.size(); ++i) {
    EXPECT_EQ(one.sizes[i].touching, three.sizes[i].touching);
    EXPECT_EQ(one.sizes[i].fallbacks, three.sizes[i].fallbacks);
    EXPECT_EQ(one.sizes[i].worst_gap, three.sizes[i].worst_gap);
  }
  EXPECT_EQ(one.gate[0].off, three.gate[0].off);
}

// A judge that never finds fault would be as quiet as one that has no reason to: every fault is made once.
TEST(Evaluation, EveryFaultIsFound) {
  BoxPair pair{{{6, 1.2, 1.3}}, {{6, 1.2, 1.3}}, Pose::Identity()};
  pair.X_AB.translation() = Eigen::Vector3d(0.3, 0.2, 2.6 - 1e-3);  // 1 mm deep
  ContactSettings settings;
  settings.model = Model::exact;
  const auto module = make_contact_module(settings);
  ContactCounters counters;
  const Manifold right = module->query(pair.a, pair.b, pair.X_AB, counters);
  ASSERT_EQ(right.count, 4);
  const auto verdict_on = [&](const Manifold& manifold) {
    SizeVerdict verdict;
    judge(pair, manifold, verdict);
    return verdict;
  };
  EXPECT_EQ(verdict_on(right).failures(), 0u);

  Manifold wrong = right;
  wrong.count = 0;
  EXPECT_EQ(verdict_on(wrong).missed, 1u);
  wrong = right;
  wrong.gap -= 1e-6;
  EXPECT_EQ(verdict_on(wrong).gap_off, 1u);
  wrong = right;
  wrong.points[2].depth += 1e-6;
  EXPECT_EQ(verdict_on(wrong).deeper, 1u);
  wrong = right;
  wrong.n_A = Eigen::Vector3d::UnitX();
  EXPECT_EQ(verdict_on(wrong).normal_off, 1u);
  wrong = right;
  wrong.n_A = -right.n_A;
  EXPECT_EQ(verdict_on(wrong).normal_off, 1u);
  wrong = right;
  wrong.points[1].p_A.z() += 2e-3;  // above A by more than half the depth
  EXPECT_EQ(verdict_on(wrong).off_surface, 1u);

  pair.X_AB.translation().z() = 2.6 + 1e-3;  // apart
  EXPECT_EQ(verdict_on(right).phantom, 1u);
  EXPECT_EQ(verdict_on(module->query(pair.a, pair.b, pair.X_AB, counters)).failures(), 0u);
}

}  // namespace
}  // namespace quayside::contact_nn
