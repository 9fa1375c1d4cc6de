// Friction that sticks: one limit, energy, sticking and sliding, apart.
#include <cmath>

#include <gtest/gtest.h>

#include "contact_nn/bristle.h"
#include "tests/unit/contact_nn/poses.h"

namespace quayside::contact_nn {
namespace {

using Eigen::Vector3d;
using test::Random;

ContactSettings settings(double friction = 0.4) {
  ContactSettings s;
  s.model = Model::exact;
  s.friction = friction;
  s.friction_law = Friction::bristle;
  return s;
}

double stiffness() { return BristleFriction::kStiffnessShare * settings().stiffness; }

Pose touching(const Box& a, const Box& b, const Eigen::Matrix3d& R_AB, const Vector3d& direction, double depth) {
  return test::at_depth(a, b, test::pose(Vector3d::Zero(), R_AB), direction, depth);
}

// A container on the ground.
Pose flat(double depth) {
  return touching(test::kGround, test::kContainer, Eigen::Matrix3d::Identity(), Vector3d::UnitZ(), depth);
}

Bristle some_bristle(Random& random, double scale) {
  Bristle z;
  z << scale * random.uniform(0, 1) * random.direction(), scale * random.uniform(-1, 1);
  return z;
}

// What friction adds to a contact.
struct Added {
  ContactForce contact;  // without friction
  Vector3d f_A, t_A;     // on B, about A's centre
  double stored, dissipated;
  Bristle rate;
};

Added added(const Bristle& z, const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB) {
  ContactCounters counters;
  Added result;
  result.contact = make_contact_module(settings())->force(a, b, X_AB, V_AB, counters);
  ContactForce with = result.contact;
  result.rate = BristleFriction(settings()).add(z, X_AB, V_AB, with);
  result.f_A = with.f_A - result.contact.f_A;
  result.t_A = with.t_A - result.contact.t_A;
  result.stored = with.potential_energy - result.contact.potential_energy;
  result.dissipated = with.dissipated_power - result.contact.dissipated_power;
  return result;
}

// Deflections and slides from far below the limit to far above it, in any pose.
TEST(Bristle, TakesOnlyWhatItDoesNotStoreAndKeepsOneLimit) {
  Random random(7);
  int stuck = 0, sliding = 0;
  for (int i = 0; i < 3000; ++i) {
    const Pose X_AB = touching(test::kContainer, test::kContainer, random.rotation(), random.direction(),
                               random.log_uniform(1e-6, 1e-2));
    const double speed = random.log_uniform(1e-6, 1);
    const RelativeVelocity V_AB{speed * random.direction(), speed * random.direction()};
    const Bristle z = some_bristle(random, random.log_uniform(1e-7, 1e-3));
    const Added friction = added(z, test::kContainer, test::kContainer, X_AB, V_AB);
    ASSERT_TRUE(friction.contact.touching);
    const double N = friction.contact.f_A.norm(), r = std::sqrt(friction.contact.pressure_radius2);
    if (N == 0) continue;  // it leaves so fast that nothing pushes

    // Power taken from the motion = d/dt of what is stored + dissipated; to rounding of the largest of them.
    const double taken = -friction.f_A.dot(V_AB.v_A - V_AB.w_A.cross(X_AB.translation())) - friction.t_A.dot(V_AB.w_A);
    const double storing = stiffness() * z.dot(friction.rate);
    EXPECT_GE(friction.dissipated, 0);
    EXPECT_NEAR(taken, storing + friction.dissipated, 1e-9 * (std::abs(storing) + friction.dissipated + 1e-3));
    EXPECT_NEAR(friction.stored, 0.5 * stiffness() * z.squaredNorm(),
                1e-9 * (friction.stored + friction.contact.potential_energy));

    // √(|f|² + (τ/r)²) ≤ μ N, f across the pressure.
    const Vector3d n = friction.contact.f_A / N, &c = friction.contact.impact_point_A;
    const double torsion = n.dot(friction.t_A - c.cross(friction.f_A));
    EXPECT_NEAR(n.dot(friction.f_A), 0, 1e-9 * N);
    const double limit = 0.4 * N, carried = std::hypot(friction.f_A.norm(), torsion / r);
    EXPECT_LE(carried, limit * (1 + 1e-7));  // r of a corner is 1e-6 of the arms that are taken off the torque
    (carried < 0.9 * limit ? stuck : sliding) += 1;
  }
  EXPECT_GT(stuck, 300);
  EXPECT_GT(sliding, 300);
}

TEST(Bristle, IsTheSameSeenFromTheOtherBox) {
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    const Pose X_AB = touching(test::kContainer, test::kCube, random.rotation(), random.direction(), 1e-3);
    const RelativeVelocity V_AB{0.1 * random.direction(), 0.1 * random.direction()};
    const Eigen::Matrix3d R_BA = X_AB.linear().transpose();
    const RelativeVelocity V_BA{-R_BA * V_AB.w_A, -R_BA * (V_AB.v_A - V_AB.w_A.cross(X_AB.translation()))};
    const Bristle z = some_bristle(random, 1e-4);
    Bristle mirrored = z;
    mirrored.head<3>() = -R_BA * z.head<3>();
    const Added ab = added(z, test::kContainer, test::kCube, X_AB, V_AB);
    const Added ba = added(mirrored, test::kCube, test::kContainer, X_AB.inverse(), V_BA);
    EXPECT_LT((ba.f_A + R_BA * ab.f_A).norm(), 1e-6 * ab.contact.f_A.norm());
    EXPECT_NEAR(ba.rate[3], ab.rate[3], 1e-6);
    EXPECT_LT((ba.rate.head<3>() + R_BA * ab.rate.head<3>()).norm(), 1e-6);
  }
}

// Flat, uniform pressure over L × W: r² = (L² + W²)/12, but for the strip along the border, as wide as the depth, that presses
// less: 3 mm of 2.4 m. On an edge along y the pressure is a line: W²/12, but for a wedge 1 mm/0.1 wide.
TEST(Bristle, KnowsTheRadiusOfThePressure) {
  ContactCounters counters;
  const auto module = make_contact_module(settings());
  const Vector3d size = 2 * test::kContainer.half;
  const auto radius2 = [&](double tilt) {
    const Pose X_AB = touching(test::kGround, test::kContainer, test::rotation(tilt, Vector3d::UnitY()), Vector3d::UnitZ(), 1e-3);
    return module->force(test::kGround, test::kContainer, X_AB, {}, counters).pressure_radius2;
  };
  EXPECT_NEAR(radius2(0) / ((size.x() * size.x() + size.y() * size.y()) / 12), 1, 2e-3);
  EXPECT_NEAR(radius2(0.1) / (size.y() * size.y() / 12), 1, 5e-3);
}

// With a load below the limit it is a spring: no motion, no rate; and it answers a slow motion with that motion.
TEST(Bristle, SticksWithoutCreepBelowItsLimit) {
  const Pose X_AB = flat(1e-3);
  const double N = added(Bristle::Zero(), test::kGround, test::kContainer, X_AB, {}).contact.f_A.norm();
  for (const double share : {0.1, 0.9, 0.995}) {
    Bristle z = Bristle::Zero();
    z[0] = share * 0.4 * N / stiffness();
    const Added friction = added(z, test::kGround, test::kContainer, X_AB, {});
    EXPECT_LT(friction.rate.norm(), 1e-15);  // the normal is vertical to rounding
    EXPECT_NEAR(friction.f_A.x(), -share * 0.4 * N, 1e-9 * N);
    EXPECT_LT(friction.dissipated, 1e-15);
  }
}

// Slid at 0.1 m/s for ten τ it carries μ N against the slide to e⁻¹⁰, whatever the deflection it began with.
TEST(Bristle, SlidesAtItsLimit) {
  const Pose X_AB = flat(1e-3);
  const RelativeVelocity V_AB{Vector3d::Zero(), {0.06, -0.08, 0}};
  Bristle z(2e-4, 3e-4, 0, -1e-4);
  const double h = 0.01 * BristleFriction::kRelaxation;
  for (int i = 0; i < 1000; ++i) z += h * added(z, test::kGround, test::kContainer, X_AB, V_AB).rate;
  const Added friction = added(z, test::kGround, test::kContainer, X_AB, V_AB);
  const double limit = 0.4 * friction.contact.f_A.norm();
  EXPECT_LT((friction.f_A - limit * Vector3d(-0.6, 0.8, 0)).norm(), 1e-3 * limit);
  EXPECT_NEAR(friction.f_A.norm() / limit, 1, 1e-6);
  EXPECT_NEAR(friction.dissipated / (0.1 * limit), 1, 1e-3);
}

TEST(Bristle, FadesWithoutForceWhenApart) {
  const Bristle z(1e-4, -2e-4, 3e-4, 1e-4);
  const Added friction = added(z, test::kCube, test::kCube, test::pose({0, 0, 1.1}), {Vector3d(1, 2, 3), Vector3d(4, 5, 6)});
  EXPECT_EQ(friction.f_A, Vector3d::Zero());
  EXPECT_EQ(friction.t_A, Vector3d::Zero());
  EXPECT_LT((friction.rate + z / BristleFriction::kRelaxation).norm(), 1e-15);
  EXPECT_NEAR(friction.dissipated, -stiffness() * z.dot(friction.rate), 1e-9);
}

// Continuous through the touch: force and rate a tenth of a nanometre deep are those apart, to what such a depth can carry.
TEST(Bristle, IsContinuousAtTheTouch) {
  const Bristle z(1e-4, -2e-4, 0, 1e-4);
  const Pose X_AB = flat(1e-10);
  const Added friction = added(z, test::kGround, test::kContainer, X_AB, {});
  ASSERT_TRUE(friction.contact.touching);
  EXPECT_LT(friction.f_A.norm(), 0.1);  // μ K 1e-10
  EXPECT_LT((friction.rate + z / BristleFriction::kRelaxation).norm(), 1e-6);
}

// The other laws' resultants carry the same friction: flat contacts of equal load.
TEST(Bristle, GoesWithEveryLaw) {
  ContactCounters counters;
  const Pose X_AB = touching(test::kContainer, test::kContainer, Eigen::Matrix3d::Identity(), Vector3d::UnitZ(), 1e-3);
  const Vector3d size = 2 * test::kContainer.half;
  const double even = (size.x() * size.x() + size.y() * size.y()) / 12;
  for (const auto& [law, radius2] :
       {std::pair(Law::potential, even), {Law::learned, even}, {Law::points, 3 * even}, {Law::pads, 3 * even}}) {
    ContactSettings s = settings();
    s.law = law;
    ContactForce force = make_contact_module(s)->force(test::kContainer, test::kContainer, X_AB, {}, counters);
    EXPECT_NEAR(force.pressure_radius2 / radius2, 1, 5e-3) << static_cast<int>(law);  // points: at the corners
    Bristle z = Bristle::Zero();
    z[1] = 1;
    const double N = force.f_A.norm();
    BristleFriction(s).add(z, X_AB, {}, force);
    EXPECT_NEAR(force.f_A.y() / N, -0.4, 1e-3);
  }
}

TEST(Bristle, IsNoneWhereFrictionHasNoState) {
  EXPECT_TRUE(bristle_friction(settings()));
  EXPECT_FALSE(bristle_friction(settings(0)));
  EXPECT_FALSE(bristle_friction({}));
}

}  // namespace
}  // namespace quayside::contact_nn
