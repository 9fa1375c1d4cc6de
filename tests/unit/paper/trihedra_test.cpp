#include "contact_nn/paper/trihedra.h"

#include <cmath>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

namespace quayside::contact_nn::paper {
namespace {

using Eigen::Vector3d;

// Everything here is of order 1 and a handful of operations from exact numbers.
constexpr double rounding = 1e-12;

std::vector<TouchingPose> some_poses(Reading reading, std::size_t count, const Subset& subset = {}) {
  Random random(7);
  DrawCounts counts;
  return draw_poses(count, reading, subset, random, counts);
}

// Is the plane through the impact point with the force direction as normal between the cubes?
bool plane_separates(const TouchingPose& pose) {
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d v = vertex_of_b(corner);  // of a cube: A's and B's alike
    if (pose.n_A.dot(v - pose.impact_A) > 1e-9) return false;
    if (pose.n_A.dot(pose.X_AB * v - pose.impact_A) < -1e-9) return false;
  }
  return true;
}

TEST(Trihedra, TheImpactPointIsOnTheNamedFeaturesOfBothCubes) {
  for (const TouchingPose& pose : some_poses(Reading::unfiltered, 2000)) {
    const Vector3d p_B = pose.X_AB.inverse() * pose.impact_A;
    EXPECT_NEAR(pose.n_A.norm(), 1, rounding);
    if (pose.touch == Touch::vertex_on_face) {
      EXPECT_EQ(pose.impact_A[pose.of_a], 1);
      EXPECT_LE(pose.impact_A.cwiseAbs().maxCoeff(), 1);
      EXPECT_LT((p_B - vertex_of_b(pose.of_b)).norm(), rounding);
    } else {
      const EdgeLine a = edge_of_trihedron(pose.of_a, 1), b = edge_of_trihedron(pose.of_b, -1);
      Vector3d from_a = pose.impact_A - a.middle, from_b = p_B - b.middle;
      EXPECT_LE(std::abs(from_a[a.axis]), 1);
      EXPECT_LE(std::abs(from_b[b.axis]), 1 + rounding);
      from_a[a.axis] = from_b[b.axis] = 0;
      EXPECT_LT(from_a.norm() + from_b.norm(), rounding);
    }
  }
}

// The impact point is inside a face or an edge, so the only plane that can separate the cubes is the one that contains
// these features: it decides about overlap, without any separating-axis test.
TEST(Trihedra, PosesAreValidExactlyWhereThePlaneOfContactSeparatesTheCubes) {
  int valid = 0;
  for (const TouchingPose& pose : some_poses(Reading::unfiltered, 5000)) {
    EXPECT_EQ(overlaps(pose), !plane_separates(pose));
    valid += !overlaps(pose);
  }
  EXPECT_GT(valid, 500);
  for (const TouchingPose& pose : some_poses(Reading::valid, 1000)) EXPECT_TRUE(plane_separates(pose));
}

// A turned cube has one lowest vertex. Over the faces x = 1 and z = 1 it is never (1, 1, 1), since R_xx = cos β cos γ
// and R_zz = cos α cos β are positive: so exactly one of the seven vertices fits, and a seventh of these draws are
// valid.
TEST(Trihedra, OneVertexFitsOnAFace) {
  Random random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const TouchingPose drawn = draw_pose({}, random);
    for (const int face : {0, 2}) {
      int fitting = 0;
      for (int vertex = 0; vertex < kVertices; ++vertex) {
        TouchingPose pose = drawn;
        pose.X_AB.translation() = Vector3d::Unit(face) - pose.X_AB.linear() * vertex_of_b(vertex);
        fitting += !overlaps(pose);
      }
      EXPECT_EQ(fitting, 1);
    }
  }
}

TEST(Trihedra, EulerAnglesAreRollPitchYawInAHalfTurn) {
  for (const TouchingPose& pose : some_poses(Reading::unfiltered, 200)) {
    const auto R = pose.X_AB.linear();
    EXPECT_NEAR(std::atan2(R(2, 1), R(2, 2)), pose.euler[0], rounding);
    EXPECT_NEAR(-std::asin(R(2, 0)), pose.euler[1], 1e-7);  // the arcsine loses half of the digits near ±π/2
    EXPECT_NEAR(std::atan2(R(1, 0), R(0, 0)), pose.euler[2], rounding);
    EXPECT_LE(pose.euler.cwiseAbs().maxCoeff(), M_PI / 2);
  }
}

TEST(Trihedra, ATrihedronHasNineEdgesEachOnOneOfItsFaces) {
  for (const double sign : {1.0, -1.0}) {
    std::set<std::tuple<int, double, double, double>> edges;
    for (int edge = 0; edge < kEdges; ++edge) {
      const EdgeLine line = edge_of_trihedron(edge, sign);
      edges.insert({line.axis, line.middle[0], line.middle[1], line.middle[2]});
      EXPECT_EQ(line.middle[line.axis], 0);
      EXPECT_EQ((sign * line.middle).maxCoeff(), 1) << "not on a face of the trihedron";
    }
    EXPECT_EQ(edges.size(), 9u);
  }
}

TEST(Trihedra, SubsetsHoldWhatTheySay) {
  for (const TouchingPose& pose : some_poses(Reading::valid, 50, Subset::pair(Touch::vertex_on_face, 1, 4))) {
    EXPECT_EQ(pose.touch, Touch::vertex_on_face);
    EXPECT_EQ(pose.of_a, 1);
    EXPECT_EQ(pose.of_b, 4);
    EXPECT_EQ(pose.n_A, Vector3d::UnitY());
  }
  for (const TouchingPose& pose : some_poses(Reading::valid, 50, Subset::pair(Touch::edge_on_edge, 2, 3))) {
    EXPECT_EQ(pose.touch, Touch::edge_on_edge);
    EXPECT_EQ(pose.of_a, 2);
    EXPECT_EQ(pose.of_b, 3);
  }
  Subset octant;
  octant.kind = Subset::Kind::octant;
  for (const TouchingPose& pose : some_poses(Reading::valid, 50, octant)) EXPECT_GE(pose.euler.minCoeff(), 0);
}

TEST(Trihedra, CountsAddUpAndASeedRepeats) {
  DrawCounts counts, again;
  Random random(5), same(5);
  const auto poses = draw_poses(500, Reading::valid, {}, random, counts);
  const auto twice = draw_poses(500, Reading::valid, {}, same, again);
  EXPECT_EQ(counts.vertices() + counts.edges(), 500u);
  EXPECT_EQ(counts.draws, counts.overlapping + 500);
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_EQ(poses[i].X_AB.matrix(), twice[i].X_AB.matrix());
}

}  // namespace
}  // namespace quayside::contact_nn::paper
