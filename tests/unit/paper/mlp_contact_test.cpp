#include "contact_nn/paper/mlp_contact.h"

#include <gtest/gtest.h>

#include "contact_nn/training.h"

namespace quayside::contact_nn::paper {
namespace {

using Eigen::Vector3d;

// A network without inputs: it always names this point and direction.
Network constant(const Eigen::VectorXd& outputs) {
  Network network;
  network.layers.push_back({Eigen::MatrixXd::Zero(outputs.size(), 6), outputs, Activation::identity});
  return network;
}

Pose above(double height) {
  Pose X = Pose::Identity();
  X.translation() = Vector3d(0.3, 0.2, height);
  return X;
}

// 1 cm deep along z. At 60° from z the cubes overlap by 1.8 times their width or so less the way between the centres.
TEST(MlpContact, PushesAlongTheDirectionAtThePointThatTheNetworkNames) {
  Eigen::VectorXd outputs(6);
  const Vector3d n = Vector3d(0, 3, 4) / 5;
  outputs << 0.1, -0.2, 1, 2 * n;
  const Pose X = above(1.99);
  const ContactForce f = MlpContact(constant(outputs), Encoding::vectors, Depth::exact, 1e6)(X);
  EXPECT_TRUE(f.touching);
  EXPECT_LT((f.f_A - 1e4 * n).norm(), 1e-8);
  EXPECT_LT((f.impact_point_A - Vector3d(0.1, -0.2, 1)).norm(), 1e-14);
  EXPECT_LT((f.t_A - f.impact_point_A.cross(f.f_A)).norm(), 1e-8);
  const ContactForce own = MlpContact(constant(outputs), Encoding::vectors, Depth::own, 1e6)(X);
  const double depth = 2 * (0.6 + 0.8) - (0.6 * 0.2 + 0.8 * 1.99);  // half widths of both cubes along n, less the way
  EXPECT_LT((own.f_A - 1e6 * depth * n).norm(), 1e-8);
}

TEST(MlpContact, NoForceApart) {
  const ContactForce f = MlpContact(constant(Eigen::VectorXd::Ones(4)), Encoding::angles, Depth::own, 1e6)(above(2.001));
  EXPECT_FALSE(f.touching);
  EXPECT_EQ(f.f_A, Vector3d::Zero());
}

// The network must be asked for the pose as it was trained on it: with targets for outputs every pattern comes back.
TEST(MlpContact, AnglesAndOutputsMeanWhatThePatternsSay) {
  Random random(3);
  DrawCounts counts;
  const auto poses = draw_poses(200, Reading::valid, {}, random, counts);
  for (const Encoding encoding : {Encoding::angles, Encoding::turned, Encoding::vectors}) {
    const Samples samples = patterns(poses, {Target::vertex, encoding, 0});
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_LT((euler_angles(poses[i].X_AB.linear()) - poses[i].euler).norm(), 1e-6);
      const Impact impact = impact_of(samples.targets.col(static_cast<Eigen::Index>(i)).cast<double>(), encoding);
      EXPECT_LT((impact.point - poses[i].impact_A).norm(), 1e-5);  // single precision
      EXPECT_LT((impact.direction - poses[i].n_A).norm(), 1e-5);
    }
  }
}

}  // namespace
}  // namespace quayside::contact_nn::paper
