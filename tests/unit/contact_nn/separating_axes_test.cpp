#include "contact_nn/separating_axes.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/contact_nn/poses.h"

namespace quayside::contact_nn {
namespace {

using namespace test;
using Eigen::Matrix3d;
using Eigen::Vector3d;

const Box kBoxes[] = {kContainer, kCube, kSlab, kGround, kNeedle};

// Separation along a unit direction from A to B, from the corners: an independent way to the same number.
double separation_along(const Vector3d& n, const Box& a, const Box& b, const Pose& X_AB) {
  double top = -1e300, bottom = 1e300;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    top = std::max(top, n.dot(sign.cwiseProduct(a.half)));
    bottom = std::min(bottom, n.dot(X_AB * sign.cwiseProduct(b.half)));
  }
  return bottom - top;
}

Pose random_pose(Random& random, const Box& a, const Box& b) {
  const Pose turned = pose(Vector3d::Zero(), random.rotation());
  return at_depth(a, b, turned, random.direction(), random.uniform(-0.5, 1) * std::min(a.half.minCoeff(), b.half.minCoeff()));
}

TEST(SeparatingAxes, TheGapIsTheSeparationAlongTheNormal) {
  Random random(1);
  for (const Box& a : kBoxes)
    for (const Box& b : kBoxes)
      for (int trial = 0; trial < 50; ++trial) {
        const Pose X_AB = random_pose(random, a, b);
        const AxisSeparation s = largest_separation(a, b, X_AB);
        const double size = a.half.norm() + b.half.norm();
        EXPECT_NEAR(s.n_A.norm(), 1, 1e-14);
        EXPECT_NEAR(s.gap, separation_along(s.n_A, a, b, X_AB), 1e-14 * size);
        EXPECT_EQ(s.gap, separation(a, b, X_AB));
        EXPECT_GE(s.n_A.dot(X_AB.translation()), 0);
      }
}

// Oracle by brute force: the penetration depth of overlapping boxes is the distance of the origin from the border of their
// Minkowski difference, the hull of the 64 differences of corners. Every plane through three of them that has all others on
// one side is a face of the hull; no edge directions are used. A sweep over directions shows that none separates more.
double penetration_by_hull(const Box& a, const Box& b, const Pose& X_AB) {
  std::vector<Vector3d> points;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) {
      const Vector3d s(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1), t(j & 1 ? 1 : -1, j & 2 ? 1 : -1, j & 4 ? 1 : -1);
      points.push_back(s.cwiseProduct(a.half) - X_AB * t.cwiseProduct(b.half));
    }
  const double size = a.half.norm() + b.half.norm();
  double depth = 1e300;
  for (std::size_t i = 0; i < 64; ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (std::size_t k = 0; k < j; ++k) {
        const Vector3d e = points[j] - points[i], f = points[k] - points[i];
        Vector3d n = e.cross(f);
        if (n.norm() <= 1e-6 * e.norm() * f.norm()) continue;  // three in a line, or two in one place
        n.normalize();
        const double plane = n.dot(points[i]), slack = 1e-9 * size;
        bool above = false, below = false;
        for (std::size_t m = 0; m < 64 && !(above && below); ++m) {
          const double height = n.dot(points[m]) - plane;
          above |= height > slack;
          below |= height < -slack;
        }
        if (!(above && below)) depth = std::min(depth, std::abs(plane));
      }
  return depth;
}

TEST(SeparatingAxes, AgreesWithTheHullOfTheMinkowskiDifferenceAndNoDirectionSeparatesMore) {
  Random random(2);
  constexpr int kDirections = 5000;
  const double golden = std::acos(-1.0) * (3 - std::sqrt(5.0));
  for (const Box& a : kBoxes)
    for (const Box& b : kBoxes)
      for (int trial = 0; trial < 4; ++trial) {
        const double depth = random.log_uniform(0.01, 0.5) * std::min(a.half.minCoeff(), b.half.minCoeff());
        const Pose X_AB = at_depth(a, b, pose(Vector3d::Zero(), random.rotation()), random.direction(), depth);
        const double gap = separation(a, b, X_AB), size = a.half.norm() + b.half.norm();
        EXPECT_NEAR(-gap, penetration_by_hull(a, b, X_AB), 1e-8 * size);
        for (int i = 0; i < kDirections; ++i) {  // Fibonacci sphere
          const double z = 1 - (2 * i + 1.0) / kDirections, r = std::sqrt(1 - z * z);
          const Vector3d n(r * std::cos(golden * i), r * std::sin(golden * i), z);
          EXPECT_LE(separation_along(n, a, b, X_AB), gap + 1e-13 * size);
        }
      }
}

// The same two oracles where it is hard: boxes of 1 mm to 100 m, cubes to needles and plates of 1 to 1000; exactly aligned,
// turned by 1e-9 to 1e-2 rad, turned at random; shallow, deep, at the same place, one inside the other. The hull takes points
// within 1e-9 of the size for coplanar, so it is good to that many times the number of points that share a face.
TEST(SeparatingAxes, AgreesWithBothOraclesWhereItIsHard) {
  Random random(7);
  constexpr int kDirections = 1000;
  const double golden = std::acos(-1.0) * (3 - std::sqrt(5.0)), quarter = std::acos(-1.0) / 2;
  const Vector3d shapes[] = {{1, 1, 1}, {1, 0.2, 0.21}, {1, 0.01, 0.01}, {1, 0.9, 1e-3}};
  const double scales[] = {5e-4, 50};  // half lengths [m]
  int pose_number = 0;
  for (const double scale : scales)
    for (const double other : {1.0, 0.1})
      for (const Vector3d& shape_a : shapes)
        for (const Vector3d& shape_b : shapes)
          for (const double angle : {0.0, 1e-9, 1e-7, 1e-5, 1e-3, 1e-2, 1.0}) {
            const Box a{scale * shape_a}, b{scale * other * shape_b};
            const Matrix3d laid = rotation(quarter * (pose_number % 4), Vector3d::Unit(pose_number % 3));
            const Matrix3d R = rotation(angle * random.uniform(0.5, 3), random.direction()) * laid;
            const double thin = std::min(a.half.minCoeff(), b.half.minCoeff());
            Pose X_AB = pose(Vector3d::Zero(), R);  // at the same place, or the smaller inside the larger
            if (pose_number % 3 > 0)
              X_AB = at_depth(a, b, X_AB, random.direction(), pose_number % 3 == 1 ? 1e-3 * thin : 0.5 * thin);
            ++pose_number;

            const double gap = separation(a, b, X_AB), size = a.half.norm() + b.half.norm();
            EXPECT_NEAR(-gap, penetration_by_hull(a, b, X_AB), 1e-8 * size) << pose_number;
            for (int i = 0; i < kDirections; ++i) {  // Fibonacci sphere
              const double z = 1 - (2 * i + 1.0) / kDirections, r = std::sqrt(1 - z * z);
              const Vector3d n(r * std::cos(golden * i), r * std::sin(golden * i), z);
              ASSERT_LE(separation_along(n, a, b, X_AB), gap + 1e-13 * size) << pose_number;
            }
          }
}

TEST(SeparatingAxes, SwappingTheBoxesMirrors) {
  Random random(3);
  for (const Box& a : kBoxes)
    for (const Box& b : kBoxes)
      for (int trial = 0; trial < 50; ++trial) {
        const Pose X_AB = random_pose(random, a, b);
        const AxisSeparation s = largest_separation(a, b, X_AB), t = largest_separation(b, a, X_AB.inverse());
        const double size = a.half.norm() + b.half.norm();
        EXPECT_NEAR(s.gap, t.gap, 1e-13 * size);
      }
}

// Boxes turned against each other by anything from rounding to a hundredth: the gap is continuous there.
TEST(SeparatingAxes, NearlyParallelEdges) {
  Random random(4);
  for (int exponent = -17; exponent <= -2; ++exponent)
    for (int trial = 0; trial < 100; ++trial) {
      const double angle = std::pow(10, exponent);
      const Matrix3d R = rotation(angle, random.direction());
      const Pose X_AB = pose({random.uniform(-1, 1), random.uniform(-0.5, 0.5), 2.591 - 1e-3}, R);
      const AxisSeparation s = largest_separation(kContainer, kContainer, X_AB);
      // Corners move by at most angle times half the diagonal; the aligned gap is −1 mm.
      EXPECT_NEAR(s.gap, -1e-3, angle * 6.4 + 1e-12);
      EXPECT_NEAR(s.gap, separation_along(s.n_A, kContainer, kContainer, X_AB), 1e-13);
    }
  // Two long edges crossing at small angles, their boxes standing corner to corner: here the edge pair may be the answer. The
  // gap may not stray from the unturned one by more than the corners move.
  const Matrix3d quarter = rotation(std::acos(-1.0) / 4, Vector3d::UnitX());
  const double aligned = separation(kContainer, kContainer, pose({0, 1.3, 2.2}, quarter));
  for (int exponent = -17; exponent <= -2; ++exponent)
    for (int trial = 0; trial < 100; ++trial) {
      const double angle = std::pow(10, exponent);
      const Pose X_AB = pose({0, 1.3, 2.2}, rotation(angle, random.direction()) * quarter);
      EXPECT_NEAR(separation(kContainer, kContainer, X_AB), aligned, 13 * angle + 1e-7) << angle;
    }
}

TEST(SeparatingAxes, SurelyApartIsRight) {
  Random random(5);
  for (const Box& a : kBoxes)
    for (const Box& b : kBoxes)
      for (int trial = 0; trial < 200; ++trial) {
        const double depth = random.log_uniform(1e-10, 0.01) * (trial % 2 ? 1 : -1);
        const Pose X_AB = at_depth(a, b, pose(Vector3d::Zero(), random.rotation()), random.direction(), depth);
        EXPECT_EQ(surely_apart(a, b, X_AB), separation(a, b, X_AB) > 0);
      }
}

// Named axes: a certificate is given exactly when the best of all is among them, and then the answer is the same. Shallow
// contacts decide clearly; ties within rounding are left out.
TEST(SeparatingAxes, NamedAxesAreCertifiedExactlyWhenTheBestIsAmongThem) {
  Random random(6);
  int certified = 0;
  for (const Box& a : kBoxes)
    for (const Box& b : kBoxes)
      for (int trial = 0; trial < 400; ++trial) {
        const Pose X_AB = random_pose(random, a, b);
        const AxisSeparation best = largest_separation(a, b, X_AB);
        std::array<int, 3> named;
        for (int& axis : named) axis = static_cast<int>(random.uniform(0, 15));
        if (trial % 2) named[trial % 3] = best.axis;
        const NamedSeparation s = largest_separation(a, b, X_AB, named);
        const bool among = std::find(named.begin(), named.end(), best.axis) != named.end();
        EXPECT_EQ(s.certified, among);
        if (s.certified) {
          EXPECT_EQ(s.best.gap, best.gap);
          EXPECT_EQ(s.best.axis, best.axis);
          EXPECT_EQ(s.best.n_A, best.n_A);
          ++certified;
        } else {
          EXPECT_LE(s.best.gap, best.gap + 1e-12);
        }
      }
  EXPECT_GT(certified, 1000);
}

}  // namespace
}  // namespace quayside::contact_nn
