// The little simulation by itself, under forces with known motions.
#include "contact_nn/free_box.h"

#include <cmath>

#include <gtest/gtest.h>

namespace quayside::contact_nn {
namespace {

using Eigen::Vector3d;

const Box kBox{{3, 2, 1}};
constexpr double kMass = 5, kTolerance = 1e-10;

ContactForce nothing(const Pose&, const RelativeVelocity&) { return {}; }

// Without contact: a parabola, angular momentum kept in A, energy kept. 1,000 steps of 1e-10 m add up to 1e-7 m.
TEST(FreeBox, FallsAndTumblesAsABodyInFreeFlight) {
  const FreeBox box(kBox, kMass, nothing, 9.81);
  const Vector3d inertia = kMass / 3 * Vector3d(4 + 1, 9 + 1, 9 + 4);
  Pose X = Pose::Identity();
  X.translation() = Vector3d(1, 2, 30);
  const Vector3d v(1, -2, 3), w(0.3, 2, 0.2);  // nearly about the middle axis, where it turns over
  const FreeBox::State start = FreeBox::state(X, v, w);
  FreeBox::State y = start;
  const auto momentum = [&](const FreeBox::State& s) -> Vector3d {
    return FreeBox::pose(s).linear() * inertia.cwiseProduct(Vector3d(s.tail<3>()));
  };
  constexpr double t = 3;
  EXPECT_DOUBLE_EQ(box.follow(y, t, kTolerance), t);
  const Vector3d expected = X.translation() + t * v - Vector3d(0, 0, 0.5 * 9.81 * t * t);
  EXPECT_LT((y.head<3>() - expected).norm(), 1e-7);
  EXPECT_LT((momentum(y) - momentum(start)).norm(), 1e-6 * momentum(start).norm());
  EXPECT_NEAR(box.energy(y), box.energy(start), 1e-6 * box.energy(start));
}

// On a spring k = m (2π)² along x, off centre by nothing: after one second it is back where it started.
TEST(FreeBox, SwingsOnASpringWithItsPeriod) {
  const double k = kMass * 4 * M_PI * M_PI;
  const FreeBox box(kBox, kMass, [&](const Pose& X, const RelativeVelocity&) {
    ContactForce f;
    f.f_A = -k * X.translation();
    f.t_A = X.translation().cross(f.f_A);
    f.potential_energy = 0.5 * k * X.translation().squaredNorm();
    return f;
  });
  Pose X = Pose::Identity();
  X.translation().x() = 0.1;
  FreeBox::State y = FreeBox::state(X, Vector3d::Zero(), Vector3d::Zero());
  box.follow(y, 0.25, kTolerance);
  EXPECT_NEAR(y[0], 0, 1e-7);
  EXPECT_NEAR(y[7], -0.1 * 2 * M_PI, 1e-6);
  box.follow(y, 0.75, kTolerance);
  EXPECT_NEAR(y[0], 0.1, 1e-7);
  EXPECT_LT(y.tail<3>().norm(), 1e-12);  // no torque about its own centre
}

// A force and torque written about A's centre: a force through a point off B's centre must turn B about its own. With one
// principal axis the angle is known: f · arm = I α.
TEST(FreeBox, TurnsAboutItsOwnCentre) {
  const Vector3d force(0, 3, 0), arm(0.7, 0, 0);
  const FreeBox box(kBox, kMass, [&](const Pose& X, const RelativeVelocity&) {
    ContactForce f;
    f.f_A = force;
    f.t_A = (X.translation() + arm).cross(force);
    return f;
  });
  Pose X = Pose::Identity();
  X.translation() = Vector3d(5, -4, 3);
  FreeBox::State y = FreeBox::state(X, Vector3d::Zero(), Vector3d::Zero());
  box.follow(y, 0.5, kTolerance);
  const double spin = arm.x() * force.y() / (kMass / 3 * (9 + 4)) * 0.5;
  EXPECT_NEAR(y[12], spin, 1e-9);
  EXPECT_NEAR(y[8], force.y() / kMass * 0.5, 1e-9);
}

// What the figures are for: a force that is stronger on the way out makes energy, and is found out.
TEST(FreeBox, AForceThatMakesEnergyIsFoundOut) {
  const auto spring = [](double more_on_the_way_out) {
    return [=](const Pose& X, const RelativeVelocity& V) {
      const double depth = 2 * kBox.half.z() - X.translation().z();
      ContactForce f;
      if (depth <= 0) return f;
      f.f_A = Vector3d(0, 0, 1e6 * depth * (V.v_A.z() > 0 ? 1 + more_on_the_way_out : 1));
      f.t_A = X.translation().cross(f.f_A);
      return f;
    };
  };
  Pose X = Pose::Identity();
  X.translation().z() = 2 * kBox.half.z() + 1e-3;
  const Throw start{kBox, kBox, 1e3, X, Vector3d(0, 0, -0.5), Vector3d::Zero()};
  const Rebound fair = rebound(start, spring(0)), unfair = rebound(start, spring(0.01));
  EXPECT_TRUE(fair.touched && fair.left);
  EXPECT_NEAR(fair.gain, 0, 2e-5);  // the spring begins with a kink, inside a step
  EXPECT_NEAR(unfair.gain, 0.01, 1e-4);  // the work on the way out is a hundredth more
  const ReboundFigures figures = figures_of({fair, fair, unfair, {}});
  EXPECT_EQ(figures.touched, 3);
  EXPECT_EQ(figures.gained, 1);
  EXPECT_EQ(figures.lost, 0);
  EXPECT_EQ(figures.still_near, 0);
  EXPECT_EQ(figures.most_gained, unfair.gain);
}

}  // namespace
}  // namespace quayside::contact_nn
