#include "contact_nn/manifold.h"

#include <cmath>

#include <gtest/gtest.h>

#include "contact_nn/law_parameters.h"
#include "contact_nn/points_law.h"
#include "tests/unit/contact_nn/poses.h"

namespace quayside::contact_nn {
namespace {

using namespace test;
using Eigen::Matrix3d;
using Eigen::Vector3d;

const Box kBoxes[] = {kContainer, kCube, kSlab, kGround, kNeedle};

double distance_to_surface(const Vector3d& p, const Box& box) {
  const Vector3d beyond = p.cwiseAbs() - box.half;
  if (beyond.maxCoeff() <= 0) return -beyond.maxCoeff();
  return beyond.cwiseMax(0).norm();
}

// What must hold for every manifold of touching boxes.
void check_invariants(const Box& a, const Box& b, const Pose& X_AB) {
  const Manifold m = contact_manifold(a, b, X_AB, 0);
  const double size = a.half.norm() + b.half.norm(), rounding = 1e-13 * size;
  EXPECT_NEAR(m.n_A.norm(), 1, 1e-14);
  EXPECT_NEAR(m.gap, separation(a, b, X_AB), rounding);
  if (m.gap > 0) {  // no phantom
    EXPECT_EQ(m.count, 0);
    EXPECT_EQ(m.contact_class, ContactClass::apart);
    return;
  }
  ASSERT_GE(m.count, 1);  // no miss
  ASSERT_LE(m.count, 8);
  ASSERT_NE(m.contact_class, ContactClass::apart);
  double deepest = 0;
  for (int i = 0; i < m.count; ++i) {
    const ManifoldPoint& point = m.points[i];
    EXPECT_GE(point.depth, 0);
    EXPECT_LE(point.depth, -m.gap);  // none deeper than the truth
    deepest = std::max(deepest, point.depth);
    // On the way from one surface to the other. Where edges are nearly parallel their crossing is less well known: ε/sine of
    // at least 1e-7, along the edges.
    const double slack = m.contact_class == ContactClass::edge_edge ? 1e-8 * size : rounding;
    EXPECT_LE(distance_to_surface(point.p_A, a), point.depth / 2 + slack);
    EXPECT_LE(distance_to_surface(X_AB.inverse() * point.p_A, b), point.depth / 2 + slack);
  }
  EXPECT_NEAR(deepest, -m.gap, rounding);
}

TEST(Manifold, InvariantsHoldForRandomPoses) {
  Random random(1);
  for (const Box& a : kBoxes)
    for (const Box& b : kBoxes)
      for (int trial = 0; trial < 300; ++trial) {
        const double thinnest = std::min(a.half.minCoeff(), b.half.minCoeff());
        const double depth = random.log_uniform(1e-8, 1) * thinnest * (trial % 4 ? 1 : -1);
        check_invariants(a, b, at_depth(a, b, pose({0, 0, 0}, random.rotation()), random.direction(), depth));
      }
}

TEST(Manifold, InvariantsHoldForNearlyParallelAndAlignedBoxes) {
  Random random(2);
  const double quarter = std::acos(-1.0) / 2;
  for (const Box& a : kBoxes)
    for (const Box& b : kBoxes)
      for (int exponent = -17; exponent <= -2; ++exponent)
        for (int trial = 0; trial < 20; ++trial) {
          // From any of the ways to lay one box axis-parallel on the other, turned a little.
          const Matrix3d laid = rotation(quarter * (trial % 4), Vector3d::Unit(trial % 3));
          const double angle = trial % 5 ? std::pow(10, exponent) : 0;
          const Matrix3d R = rotation(angle, random.direction()) * laid;
          Vector3d offset = Vector3d::Zero();
          if (trial % 2) offset = 0.3 * random.uniform(0, 1) * Vector3d(a.half.x(), a.half.y(), 0);
          const double depth = random.log_uniform(1e-6, 0.3) * std::min(a.half.minCoeff(), b.half.minCoeff());
          check_invariants(a, b, at_depth(a, b, pose(offset, R), Vector3d::UnitZ(), depth));
        }
}

TEST(Manifold, DeepAndExtremePoses) {
  Random random(3);
  for (const double scale : {1e-3, 1.0, 1e2})
    for (int trial = 0; trial < 300; ++trial) {
      const Box a{scale * Vector3d(0.5, 0.4, 0.3)}, b{scale * 0.3 * Vector3d(1, 0.5, 2)};
      check_invariants(a, b, pose(scale * random.uniform(0, 0.8) * random.direction(), random.rotation()));
    }
  const Box speck{{1e-3, 1e-3, 1e-3}}, hall{{100, 100, 100}};
  for (int trial = 0; trial < 300; ++trial) {
    const double depth = random.log_uniform(1e-6, 1e-3);
    check_invariants(hall, speck, at_depth(hall, speck, pose({0, 0, 0}, random.rotation()), random.direction(), depth));
  }
  check_invariants(hall, speck, pose({0, 0, 0}));
  check_invariants(kCube, kCube, pose({0, 0, 0}));
}

// An aligned stack has the four corners of the common face, once each, halfway, whichever way the boxes are turned by
// rounding; an offset one the corners of the overlap.
TEST(Manifold, FlatContactHasTheCornersOfTheOverlap) {
  for (const double angle : {0.0, 1e-17, 1e-16}) {
    const Pose X_AB = pose({0, 0, 2.591 - 1e-3}, rotation(angle, Vector3d(1, 2, 3)));
    const Manifold m = contact_manifold(kContainer, kContainer, X_AB, 0);
    EXPECT_EQ(m.contact_class, ContactClass::face_a);  // rounding does not make it an edge contact
    ASSERT_EQ(m.count, 4);
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(m.points[i].depth, 1e-3, 1e-14);
      EXPECT_LT((m.points[i].p_A.cwiseAbs() - Vector3d(6.096, 1.219, 1.2955 - 5e-4)).norm(), 1e-13);
    }
  }
  const Manifold m = contact_manifold(kContainer, kContainer, pose({1, 0.5, 2.59}), 0);
  ASSERT_EQ(m.count, 4);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(std::abs(m.points[i].p_A.x() - 0.5), 6.096 - 0.5, 1e-12);
    EXPECT_NEAR(std::abs(m.points[i].p_A.y() - 0.25), 1.219 - 0.25, 1e-12);
  }
  // Turned by an eighth on a larger face all eight corners of a clipped square can appear.
  const Box tile{{1, 1, 0.1}};
  const Pose X_eighth = pose({0, 0, 0.19}, rotation(std::acos(-1.0) / 4, Vector3d::UnitZ()));
  EXPECT_EQ(contact_manifold(tile, tile, X_eighth, 0).count, 8);
}

// However small the tilt, and whichever axis wins, a flat contact keeps the corners of the overlap, at depths within the
// tilt times the length.
TEST(Manifold, NearlyFlatContactKeepsItsCorners) {
  Random random(6);
  int edges = 0;
  for (int exponent = -17; exponent <= -5; ++exponent)
    for (int trial = 0; trial < 50; ++trial) {
      const double angle = std::pow(10, exponent);
      const Vector3d p(random.uniform(-1, 1), random.uniform(-0.5, 0.5), 2.591 - 1e-3);
      const Manifold m = contact_manifold(kContainer, kContainer, pose(p, rotation(angle, random.direction())), 0);
      edges += m.contact_class == ContactClass::edge_edge;
      ASSERT_GE(m.count, 4) << angle;
      for (int i = 0; i < m.count; ++i) EXPECT_NEAR(m.points[i].depth, 1e-3, 13 * angle + 1e-14);
    }
  EXPECT_GT(edges, 100);  // the case does occur
}

// Two edges crossing at right angles, turned to look at each other: A's along x at y = 0, B's along y at x = 0.1. The point
// lies on the common perpendicular, halfway.
TEST(Manifold, CrossedEdgesMeetInOnePoint) {
  const double eighth = std::acos(-1.0) / 4, reach = std::sqrt(0.5);
  // A turned about its x axis so that an edge points up; everything seen in A.
  const Matrix3d R_WA = rotation(eighth, Vector3d::UnitX()), R_WB = rotation(eighth, Vector3d::UnitY());
  const Pose X_AB = pose(R_WA.transpose() * Vector3d(0.1, 0.2, 2 * reach - 1e-3), R_WA.transpose() * R_WB);
  const Manifold m = contact_manifold(kCube, kCube, X_AB, 0);
  EXPECT_EQ(m.contact_class, ContactClass::edge_edge);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.gap, -1e-3, 1e-14);
  EXPECT_LT((R_WA * m.n_A - Vector3d::UnitZ()).norm(), 1e-14);
  EXPECT_LT((R_WA * m.points[0].p_A - Vector3d(0.1, 0, reach - 5e-4)).norm(), 1e-13);
}

TEST(Manifold, MarginGivesPointsBeforeContact) {
  const Pose X_AB = pose({0, 0, 2.591 + 5e-3});
  EXPECT_EQ(contact_manifold(kContainer, kContainer, X_AB, 0).count, 0);
  EXPECT_EQ(contact_manifold(kContainer, kContainer, X_AB, 4e-3).count, 0);
  const Manifold m = contact_manifold(kContainer, kContainer, X_AB, 6e-3);
  ASSERT_EQ(m.count, 4);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(m.points[i].depth, -5e-3, 1e-13);
}

// Asked from the other side: the opposite normal, the classes of the faces exchanged, the same points.
TEST(Manifold, SwappingTheBoxesMirrors) {
  Random random(4);
  int compared = 0;
  for (const Box& a : kBoxes)
    for (const Box& b : kBoxes)
      for (int trial = 0; trial < 50; ++trial) {
        const double depth = random.log_uniform(1e-4, 0.3) * std::min(a.half.minCoeff(), b.half.minCoeff());
        const Pose X_AB = at_depth(a, b, pose({0, 0, 0}, random.rotation()), random.direction(), depth);
        const Manifold m = contact_manifold(a, b, X_AB, 0), back = contact_manifold(b, a, X_AB.inverse(), 0);
        const double size = a.half.norm() + b.half.norm();
        EXPECT_NEAR(m.gap, back.gap, 1e-13 * size);
        if ((m.n_A + X_AB.linear() * back.n_A).norm() > 1e-9) continue;  // a tie between two axes
        ASSERT_EQ(m.count, back.count);
        Vector3d sum = Vector3d::Zero();
        for (int i = 0; i < m.count; ++i) sum += m.points[i].p_A - X_AB * back.points[i].p_A;
        EXPECT_LT(sum.norm(), 1e-8 * size);
        ++compared;
      }
  EXPECT_GT(compared, 1000);
}

// ---- the points law ----------------------------------------------------------------------------------------------------

TEST(PointsLaw, FlatContactIsTheSpringOfTheSettings) {
  const Pose X_AB = pose({0, 0, 2.591 - 1e-3});
  const Manifold m = contact_manifold(kContainer, kContainer, X_AB, 0);
  const LawParameters elastic{6e8, 0, 0, 1e-3}, damped{6e8, 4, 0.4, 1e-3};
  const ContactForce f = points_force(m, X_AB, {}, elastic);
  EXPECT_NEAR(f.f_A.z(), 6e5, 1e-6);
  EXPECT_NEAR(f.potential_energy, 300, 1e-9);
  EXPECT_LT(f.t_A.norm(), 1e-6);
  EXPECT_LT((f.impact_point_A - Vector3d(0, 0, 1.2955 - 5e-4)).norm(), 1e-12);
  RelativeVelocity motion;
  motion.v_A = {0.3, 0, -0.1};  // approach at 0.1 m/s: 1 + 4 · 0.1
  const ContactForce g = points_force(m, X_AB, motion, damped);
  EXPECT_NEAR(g.f_A.z(), 1.4 * 6e5, 1e-6);
  EXPECT_NEAR(g.f_A.x(), -0.4 * 1.4 * 6e5 * 0.3 / std::hypot(0.3, 1e-3), 1e-6);
  motion.v_A = {0, 0, 0.3};  // leaving faster than 1/c: never pulling
  EXPECT_EQ(points_force(m, X_AB, motion, damped).f_A.norm(), 0);
}

TEST(PointsLaw, DissipationIsThePowerTakenAndNeverNegative) {
  Random random(5);
  const LawParameters elastic{6e8, 0, 0, 1e-3}, damped{6e8, 4, 0.4, 1e-3};
  for (const Box& a : kBoxes)
    for (const Box& b : kBoxes)
      for (int trial = 0; trial < 40; ++trial) {
        const double depth = random.log_uniform(1e-4, 0.3) * std::min(a.half.minCoeff(), b.half.minCoeff());
        const Pose X_AB = at_depth(a, b, pose({0, 0, 0}, random.rotation()), random.direction(), depth);
        RelativeVelocity V;
        V.v_A = random.log_uniform(1e-4, 10) * random.direction();
        V.w_A = random.log_uniform(1e-4, 10) * random.direction();
        const Manifold m = contact_manifold(a, b, X_AB, 0);
        const ContactForce f = points_force(m, X_AB, V, damped), bare = points_force(m, X_AB, V, elastic);
        const Vector3d p = X_AB.translation(), df = f.f_A - bare.f_A, dt = f.t_A - bare.t_A;
        const double taken = -(df.dot(V.v_A) + (dt - p.cross(df)).dot(V.w_A));
        const double speed = V.v_A.norm() + V.w_A.norm() * (a.half.norm() + b.half.norm());
        EXPECT_GE(f.dissipated_power, 0);
        EXPECT_NEAR(f.dissipated_power, taken, 1e-11 * speed * (f.f_A.norm() + bare.f_A.norm()));
      }
}

}  // namespace
}  // namespace quayside::contact_nn
