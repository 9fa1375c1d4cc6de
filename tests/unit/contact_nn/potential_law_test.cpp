#include "contact_nn/potential_law.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/contact_nn/poses.h"

namespace quayside::contact_nn {
namespace {

using namespace test;
using Eigen::Vector3d;

constexpr double kStiffness = 6e8;
const LawParameters kElastic{kStiffness, 0, 0, 1e-3};

ContactForce elastic(const Box& a, const Box& b, const Pose& X_AB) {
  return potential_force(a, b, X_AB, {}, kElastic);
}

struct Gradient {
  Vector3d force, torque;
};

// Central differences of the energy: B moved by ±h, and turned about A's centre by ±h over its distance.
Gradient minus_gradient(const Box& a, const Box& b, const Pose& X_AB, double h) {
  Gradient g;
  const double turn = h / (a.half.norm() + b.half.norm());
  const auto energy = [&](const Pose& X) { return elastic(a, b, X).potential_energy; };
  for (int i = 0; i < 3; ++i) {
    const Pose move = pose(h * Vector3d::Unit(i)), back = pose(-h * Vector3d::Unit(i));
    g.force[i] = (energy(back * X_AB) - energy(move * X_AB)) / (2 * h);
    const Pose left = pose(Vector3d::Zero(), rotation(turn, Vector3d::Unit(i)));
    g.torque[i] = (energy(left.inverse() * X_AB) - energy(left * X_AB)) / (2 * turn);
  }
  return g;
}

// The error of central differences is h²/6 U‴. U grows at least as δ², at most as δ^2.5, and its derivatives scale with
// the depth d of the deepest point: relative error of order (h/d)². Rounding of U, itself good to some 1e-12 (the
// depth of a vertex is good to 1e-14 m of d ≥ 1 mm, times p), gives U 1e-12 / h = F d 1e-12 / h. With h = 1e-4 d both are 1e-8;
// the bound leaves a factor of 50 for the constants and for torques that nearly cancel.
TEST(PotentialLaw, ForceAndTorqueAreTheGradientOfTheEnergy) {
  Random random(1);
  const Box boxes[] = {kContainer, kCube, kSlab, kGround, kNeedle};
  for (const Box& a : boxes)
    for (const Box& b : boxes)
      for (int trial = 0; trial < 40; ++trial) {
        const Pose turned = pose(Vector3d::Zero(), random.rotation());
        const double thinnest = std::min(a.half.minCoeff(), b.half.minCoeff());
        const double depth = random.log_uniform(1e-3, std::min(0.05, 0.5 * thinnest));
        const Pose X_AB = at_depth(a, b, turned, random.direction(), depth);
        const ContactForce f = elastic(a, b, X_AB);
        if (!f.touching) continue;
        const Gradient g = minus_gradient(a, b, X_AB, 1e-4 * depth);
        const double scale = f.f_A.norm(), arm = a.half.norm() + b.half.norm();
        EXPECT_LT((g.force - f.f_A).norm(), 5e-7 * scale) << trial;
        EXPECT_LT((g.torque - f.t_A).norm(), 5e-7 * scale * arm) << trial;
      }
}

}  // namespace
}  // namespace quayside::contact_nn
