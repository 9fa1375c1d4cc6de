// The law `pads`: a quarter of the flat stiffness at every point of the manifold.
#include <gtest/gtest.h>

#include "contact_nn/contact.h"

namespace quayside::contact_nn {
namespace {

constexpr double kStiffness = 6e8, kDepth = 1e-3;
const Box kWide{{20, 20, 1}}, kBox{{6, 1.2, 1.3}};

// The box turned by R above A's top face, its lowest point `kDepth` inside.
Pose pressed(const Eigen::Matrix3d& R) {
  Pose X_AB = Pose::Identity();
  X_AB.linear() = R;
  X_AB.translation().z() = kWide.half.z() + R.row(2).cwiseAbs().dot(kBox.half) - kDepth;
  return X_AB;
}

ContactForce force(const Pose& X_AB, Model model = Model::committee) {
  ContactSettings settings;
  settings.model = model;  // does not matter
  settings.law = Law::pads;
  settings.stiffness = kStiffness;
  ContactCounters counters;
  return make_contact_module(settings)->force(kWide, kBox, X_AB, {}, counters);
}

// Four corners carry a face, two an edge, one a vertex; the stored energy is ½ k depth² for each. Depths are rounded to 1e-15 m.
TEST(PadsLaw, StiffnessGoesWithTheNumberOfPoints) {
  const Eigen::Matrix3d about_x = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Eigen::Matrix3d about_y = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  struct Expected {
    Eigen::Matrix3d R;
    int points;
  };
  for (const auto& [R, points] : {Expected{Eigen::Matrix3d::Identity(), 4}, {about_x, 2}, {about_x * about_y, 1}}) {
    for (const Model model : {Model::exact, Model::committee}) {
      const ContactForce f = force(pressed(R), model);
      const double k = kStiffness * points / 4;
      EXPECT_NEAR(f.normal_force / (k * kDepth), 1, 1e-9) << points;
      EXPECT_NEAR(f.potential_energy / (0.5 * k * kDepth * kDepth), 1, 1e-9) << points;
      EXPECT_NEAR(f.f_A.z(), f.normal_force, 1e-6);
    }
  }
}

TEST(PadsLaw, NothingWhenApart) {
  Pose X_AB = pressed(Eigen::Matrix3d::Identity());
  X_AB.translation().z() += kDepth + 1e-6;
  const ContactForce f = force(X_AB);
  EXPECT_FALSE(f.touching);
  EXPECT_EQ(f.f_A.norm(), 0);
}

}  // namespace
}  // namespace quayside::contact_nn
