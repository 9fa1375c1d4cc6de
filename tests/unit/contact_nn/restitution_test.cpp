#include "contact_nn/restitution.h"

#include <cmath>

#include <gtest/gtest.h>

#include "contact_nn/law_parameters.h"
#include "contact_nn/potential_law.h"
#include "tests/unit/contact_nn/poses.h"

namespace quayside::contact_nn {
namespace {

// Known values of the Hunt-Crossley relation x (1 + e) = ln[(1 + x)/(1 − x e)], given to five digits.
TEST(Restitution, KnownValues) {
  EXPECT_NEAR(restitution_of(0.1, 1), 0.93748, 5e-6);
  EXPECT_NEAR(restitution_of(0.5, 1), 0.74843, 5e-6);
  EXPECT_NEAR(restitution_of(2, 0.5), 0.59362, 5e-6);  // c · v counts
}

TEST(Restitution, DampingAndRestitutionAreInverse) {
  for (const double e : {0.001, 0.01, 0.1, 0.3, 0.5, 0.9, 0.99, 0.9999, 1 - 1e-8})
    EXPECT_NEAR(restitution_of(damping_for(e, 0.7), 0.7), e, 1e-12) << e;
  EXPECT_EQ(damping_for(1, 0.5), 0);
  EXPECT_EQ(restitution_of(0, 0.5), 1);
}

// For small losses e ≈ 1 − (2/3) x: the formula to first order.
TEST(Restitution, SmallLosses) { EXPECT_NEAR((1 - restitution_of(1e-5, 1)) / 1e-5, 2.0 / 3, 1e-4); }

// A box dropped flat, in one dimension: it leaves at e times the speed at which it came, whatever its mass, since the
// damping multiplies the elastic force (v dv/(1 + c v) = −F dδ/m has the same right-hand side on both ways).
// RK4 with 2000 steps over the contact is good to 1e-8.
TEST(Restitution, AFlatImpactReboundsAsSet) {
  ContactSettings settings;
  settings.friction = 0;
  const LawParameters law = law_parameters(settings);
  for (const double mass : {3e3, 3e4}) {
    double z = 0, v = -settings.reference_speed;  // height of the bottom face above the ground
    const double h = std::acos(-1.0) * std::sqrt(mass / settings.stiffness) / 2000;
    const auto acceleration = [&](double at, double speed) {
      RelativeVelocity V;
      V.v_A = {0, 0, speed};
      const double height = test::kGround.half.z() + test::kContainer.half.z() + at;
      return potential_force(test::kGround, test::kContainer, test::pose({0, 0, height}), V, law).f_A.z() / mass;
    };
    do {
      const double a1 = acceleration(z, v), v2 = v + h / 2 * a1;
      const double a2 = acceleration(z + h / 2 * v, v2), v3 = v + h / 2 * a2;
      const double a3 = acceleration(z + h / 2 * v2, v3), v4 = v + h * a3;
      const double a4 = acceleration(z + h * v3, v4);
      z += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
      v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    } while (z < 0);
    EXPECT_NEAR(v / settings.reference_speed, settings.restitution, 1e-6) << mass;
  }
}

}  // namespace
}  // namespace quayside::contact_nn
