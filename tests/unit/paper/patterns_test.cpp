#include "contact_nn/paper/patterns.h"

#include <cmath>

#include <gtest/gtest.h>

namespace quayside::contact_nn::paper {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

std::vector<TouchingPose> some_poses(std::size_t count, const Subset& subset = {}) {
  Random random(11);
  DrawCounts counts;
  return draw_poses(count, Reading::valid, subset, random, counts);
}

// B over the face z = 1 with two of its lowest edge's ends nearly level, deepest point `depth` below the face.
TouchingPose tilted(double alpha, double beta, double depth) {
  TouchingPose pose{};
  pose.touch = Touch::vertex_on_face;
  pose.of_a = 2;
  pose.n_A = Vector3d::UnitZ();
  pose.euler = {alpha, beta, 0};
  pose.X_AB.linear() = (AngleAxisd(beta, Vector3d::UnitY()) * AngleAxisd(alpha, Vector3d::UnitX())).toRotationMatrix();
  double lowest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d v = pose.X_AB.linear() * vertex_of_b(corner);
    if (v[2] < lowest) {
      lowest = v[2];
      pose.of_b = corner;
      pose.impact_A = v;
    }
  }
  pose.X_AB.translation() = Vector3d(0, 0, 1 - lowest - depth);
  pose.X_AB.makeAffine();
  pose.impact_A[2] = 1;
  return pose;
}

TEST(Patterns, SphericalAnglesAndBack) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Vector3d d = random.direction();
    const Eigen::Vector2d angles = spherical(3 * d);
    EXPECT_LT((direction(angles[0], angles[1]) - d).norm(), 1e-14);
  }
  EXPECT_EQ(spherical({-1, -0.0, 0})[0], M_PI);  // not −π
  EXPECT_EQ(spherical({0, 0, 1}), Eigen::Vector2d(0, M_PI / 2));
}

TEST(Patterns, InputsAreThePoseAndTargetsTheAngles) {
  const auto poses = some_poses(20);
  const Samples samples = patterns(poses, {});
  for (Eigen::Index i = 0; i < samples.size(); ++i) {
    const TouchingPose& pose = poses[static_cast<std::size_t>(i)];
    EXPECT_TRUE(samples.inputs.col(i).head<3>().isApprox(pose.X_AB.translation().cast<float>()));
    EXPECT_TRUE(samples.inputs.col(i).tail<3>().isApprox(pose.euler.cast<float>()));
    const Vector3d point = direction(samples.targets(0, i), samples.targets(1, i));
    EXPECT_LT(point.cross(pose.impact_A).norm(), 1e-5);  // single precision
  }
}

// All encodings tell the same points and directions: the distances between patterns are the same in each. Single
// precision of angles up to π: 4e-7 rad, on the surface at most √3 times 2 as much; degrees are 57 times as many.
TEST(Patterns, EncodingsAgree) {
  const auto poses = some_poses(300);
  const auto distances = [&](Encoding encoding) {
    const Eigen::MatrixXd t = patterns(poses, {Target::vertex, encoding, 0}).targets.cast<double>();
    return physical_errors(t.leftCols(299), t.rightCols(299), encoding);
  };
  const PhysicalErrors angles = distances(Encoding::angles);
  EXPECT_GT(angles.point.mean, 0.1);
  for (const Encoding encoding : {Encoding::turned, Encoding::vectors}) {
    const PhysicalErrors other = distances(encoding);
    EXPECT_NEAR(other.point.mean, angles.point.mean, 1e-5);
    EXPECT_NEAR(other.point.p99, angles.point.p99, 1e-5);
    EXPECT_NEAR(other.force.mean, angles.force.mean, 1e-4);
  }
}

// What `turned` is for. The impact point's azimuth never comes near its jump, since that line is outside the trihedron.
// The force's does where two edges touch with the normal near −y: a few of a thousand poses, against one in twenty
// before.
TEST(Patterns, TurnedAnglesStayAwayFromTheirJump) {
  const auto poses = some_poses(5000);
  const auto near_jump = [&](Encoding encoding, int row) {
    return (patterns(poses, {Target::vertex, encoding, 0}).targets.row(row).array().abs() > 3.1f).count();
  };
  EXPECT_GT(near_jump(Encoding::angles, 0), 0);
  EXPECT_EQ(near_jump(Encoding::turned, 0), 0);
  EXPECT_GT(near_jump(Encoding::angles, 2), 5000 / 25);
  EXPECT_LT(near_jump(Encoding::turned, 2), 5000 / 100);
}

// A corner above a plane: the potential does not change when it slides, so the force is normal to the plane; and its
// centre of pressure is inside the overlap, which reaches depth / (height of the next vertex / edge) along each edge.
TEST(Patterns, ThePressureOfACornerIsAtTheCornerAndNormal) {
  const double depth = 1e-3;
  const TouchingPose pose = tilted(0.5, 0.4, 0);
  const Samples vertex = patterns({pose}, {Target::vertex, Encoding::vectors, 0});
  const Samples pressure = patterns({pose}, {Target::pressure, Encoding::vectors, depth});
  // The edges rise by 2 sin β = 0.78, 2 cos β sin α = 0.88 and more over their length of 2: the overlap is 2.6 depths
  // long.
  EXPECT_LT((vertex.targets.topRows(3) - pressure.targets.topRows(3)).norm(), 3 * depth);
  EXPECT_LT((pressure.targets.bottomRows(3) - Vector3d::UnitZ().cast<float>()).norm(), 1e-6);
}

// Tilting B over the level of its lowest edge makes the vertex jump by that edge, 2 m. The centre of pressure moves
// along it while the tilt is within ± depth/edge = 0.02/2 rad: about 2 m in 200 steps of 1e-4 rad, 0.01 a step, and not
// evenly.
TEST(Patterns, ThePressureIsContinuousWhereTheVertexJumps) {
  double vertex_step = 0, pressure_step = 0;
  Eigen::MatrixXf before_v, before_p;
  for (int i = -300; i <= 300; ++i) {
    const TouchingPose pose = tilted(0.5, (i + 0.5) * 1e-4, 0.02);
    const Eigen::MatrixXf v = patterns({pose}, {Target::vertex, Encoding::vectors, 0}).targets;
    const Eigen::MatrixXf p = patterns({pose}, {Target::pressure, Encoding::vectors, 0}).targets;
    if (i > -300) {
      vertex_step = std::max<double>(vertex_step, (v - before_v).norm());
      pressure_step = std::max<double>(pressure_step, (p - before_p).norm());
    }
    before_v = v;
    before_p = p;
  }
  EXPECT_GT(vertex_step, 1.9);
  EXPECT_LT(pressure_step, 0.05);
}

TEST(Patterns, ErrorsOfKnownOutputs) {
  Eigen::MatrixXd outputs(4, 2), targets(4, 2);
  outputs << 0, 0, 0, 0, 0, 0, 0, 0;
  targets << M_PI / 2, 0, 0, 0, 0, 0, 0, M_PI / 6;
  const OutputErrors e = output_errors(outputs, targets);  // errors −π/2, −π/6 among eight
  EXPECT_NEAR(e.mean, -M_PI / 12, 1e-15);
  EXPECT_NEAR(e.absolute, M_PI / 12, 1e-15);
  EXPECT_NEAR(e.square, M_PI * std::sqrt((0.25 + 1.0 / 36) / 8), 1e-15);
  const PhysicalErrors p = physical_errors(outputs, targets, Encoding::angles);
  EXPECT_NEAR(p.point.mean, std::sqrt(0.5) / 2, 1e-12);  // from (1, 0, 0) to (0, 1, 0): √2 of an edge of 2; and 0
  EXPECT_NEAR(p.force.mean, 15, 1e-12);
}

TEST(Patterns, NoConstantBeatsTheMedians) {
  const Eigen::MatrixXf targets = patterns(some_poses(501), {}).targets;
  const Eigen::VectorXd best = best_constant(targets);
  const auto error = [&](const Eigen::VectorXd& constant) {
    return output_errors(constant.replicate(1, targets.cols()), targets.cast<double>()).absolute;
  };
  for (int k = 0; k < 4; ++k) {
    for (const double step : {-0.05, 0.05}) EXPECT_GE(error(best + step * Eigen::VectorXd::Unit(4, k)), error(best));
  }
}

}  // namespace
}  // namespace quayside::contact_nn::paper
