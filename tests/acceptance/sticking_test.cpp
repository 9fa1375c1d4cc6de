// Friction that sticks (contact_nn/bristle.h), against what Coulomb's law says.
#include <cmath>

#include <gtest/gtest.h>

#include "contact_nn/bristle.h"
#include "tests/acceptance/scenes.h"

namespace quayside::harness {
namespace {

using crane_models::Scene;
using Eigen::Vector3d;

contact_nn::ContactSettings sticking(double friction = 0.4) {
  contact_nn::ContactSettings contact = exact_contact();
  contact.friction = friction;
  contact.friction_law = contact_nn::Friction::bristle;
  return contact;
}

double bristle_stiffness() { return contact_nn::BristleFriction::kStiffnessShare * sticking().stiffness; }

// A container at its resting depth on the flat, gravity tilted by `slope` about y instead of the ground.
Scene resting_container(double slope) {
  Scene scene;
  add_body(scene, ground());
  const double sink = kContainerMass * kGravity * std::cos(slope) / sticking().stiffness;
  add_body(scene, free_box("box", kContainerMass, kContainerSize, at(0, 0, kContainerSize.z() / 2 - sink)));
  scene.gravity = kGravity * Vector3d(std::sin(slope), 0, -std::cos(slope));
  return scene;
}

// On a slope of angle α a block slides from v₀ to rest with g(μ cos α − sin α) if tan α < μ: all the way, since friction is
// μ N from the first moment (σ v₀ is far above it) to the last. Then the bristle, stretched by μ N/k, springs back to
// m g sin α/k. The friction below its centre pitches the block a little: 1e-4 m.
TEST(Sticking, BlockStopsOnASlopeAndStays) {
  const double slope = 0.2, friction = 0.4, speed = 0.5;
  Scene scene = resting_container(slope);
  scene.bodies[1].v_WB.x() = speed;
  Simulation simulation(scene, sticking(friction), 1e-8);
  simulation.run_to(3, 0.01);
  const double deceleration = kGravity * (friction * std::cos(slope) - std::sin(slope));
  const double back = kContainerMass * deceleration / bristle_stiffness();
  const double stopped = simulation.get("box.position.x");
  EXPECT_NEAR(stopped, speed * speed / (2 * deceleration) - back, 1e-4);
  simulation.run_to(23, 0.1);
  EXPECT_NEAR(simulation.get("box.position.x"), stopped, 1e-8);  // the tolerance; the regularised law creeps 11 mm
  EXPECT_LT(simulation.vector("box.velocity").norm(), 1e-8);
}

// Torsion: a flat contact that spins about its normal carries μ N r, r² = (L² + W²)/12, which is also the square of the
// block's own radius of inertia. So the spin ω₀ r, a speed, falls with μ g as any: it stops after ω₀ r/(μ g), having
// turned by ω₀² r/(2 μ g). The bristle springs back by μ N/k over r. The border's strip presses less: 2e-3 of r.
TEST(Sticking, SpinStopsAtTheTorqueOfTheLimit) {
  const double spin = 0.2, friction = 0.4;
  Scene scene = resting_container(0);
  scene.bodies[1].w_WB.z() = spin;
  Simulation simulation(scene, sticking(friction), 1e-8);
  simulation.run_to(2, 0.01);
  const double r = std::hypot(kContainerSize.x(), kContainerSize.y()) / std::sqrt(12);
  const double back = friction * kContainerMass * kGravity / bristle_stiffness() / r;
  const Eigen::Quaterniond q = simulation.quaternion("box.orientation");
  EXPECT_NEAR((2 * std::atan2(q.z(), q.w()) + back) / (spin * spin * r / (2 * friction * kGravity)), 1, 3e-3);
  EXPECT_LT(simulation.vector("box.angular_velocity").norm(), 1e-7);
}

// A hard landing on a corner with a slide: stored, dissipated and kinetic energy add up to 1e-5 of the largest exchange.
TEST(Sticking, EnergyLedgerClosesInALanding) {
  Scene scene = resting_container(0);
  scene.bodies[1].X_WB.translation().z() += 0.4;
  scene.bodies[1].X_WB.linear() =
      (Eigen::AngleAxisd(0.03, Vector3d::UnitX()) * Eigen::AngleAxisd(0.02, Vector3d::UnitY())).toRotationMatrix();
  scene.bodies[1].v_WB = {0.2, 0, -0.5};
  Simulation simulation(scene, sticking(), 1e-8);
  simulation.run_to(3, 0.01);
  EXPECT_LT(std::abs(simulation.relative_residual()), 1e-5);
  EXPECT_GT(simulation.engine().energy().dissipated, 0.99 * simulation.engine().energy().largest_exchange);
  EXPECT_LT(simulation.get("box.tilt"), 1e-6);
}

}  // namespace
}  // namespace quayside::harness
