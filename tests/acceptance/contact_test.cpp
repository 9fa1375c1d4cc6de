// Boxes that meet the ground.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/acceptance/scenes.h"

namespace quayside::harness {
namespace {

using crane_models::Scene;

// A container `height` above the ground, moving down at `speed`.
Scene falling_container(double height, double speed) {
  Scene scene;
  add_body(scene, ground());
  add_body(scene, free_box("box", kContainerMass, kContainerSize, at(0, 0, kContainerSize.z() / 2 + height)));
  scene.bodies[1].v_WB.z() = -speed;
  return scene;
}

Event first(const std::vector<Event>& events, EventKind kind) {
  for (const Event& event : events) {
    if (event.kind == kind) return event;
  }
  ADD_FAILURE() << "no event " << to_string(kind);
  return {};
}

// Flat on a linear contact the box oscillates about its static depth m g / k, so the peak force is m g + √((m g)² + k
// m v²): 1222 kN for 30.48 t at 0.5 m/s on 1e8 N/m. The potential law is linear but for the borders of the faces,
// whose strip as wide as the depth (12 mm) presses less: (depth × circumference / area)(1 − 1/9) / 2 / 4 = 0.13 % of
// stiffness, half of that in force; the footprint equals the reference area to 0.1 %. Without damping it leaves as
// fast as it came: impulse 2 m v + m g T.
TEST(Contact, FlatLandingPeaksAsASpring) {
  const double stiffness = 1e8, speed = 0.5;
  contact_nn::ContactSettings contact = elastic_contact();
  contact.stiffness = stiffness;
  Simulation simulation(falling_container(0, speed), contact, 1e-9);
  simulation.run_to(0.3, 0.001);
  const auto events = simulation.engine().take_events();
  const Event left = first(events, EventKind::contact_broken);
  const double weight = kContainerMass * kGravity;
  const double peak = weight + std::sqrt(weight * weight + stiffness * kContainerMass * speed * speed);
  EXPECT_NEAR(peak, 1222e3, 500);
  EXPECT_NEAR(left.peak_force / peak, 1, 2e-3);
  EXPECT_EQ(left.subject, "ground/box");
  EXPECT_NEAR(left.impulse / (2 * kContainerMass * speed + weight * left.duration), 1, 1e-5);
}

// Dropped from h: touches after √(2h/g), to the nanosecond of the interface and the tolerance of the solver. Elastic:
// back at the same speed, so contacts are made every 2 √(2h/g) plus the contact's own duration.
TEST(Contact, BouncesInTime) {
  const double height = 0.1;
  Simulation simulation(falling_container(height, 0), elastic_contact(), 1e-9);
  const double fall = std::sqrt(2 * height / kGravity);
  simulation.run_to(6 * fall, 0.05);
  std::vector<Event> made, broken;
  for (const Event& event : simulation.engine().take_events()) {
    if (event.kind == EventKind::contact_made) made.push_back(event);
    if (event.kind == EventKind::contact_broken) broken.push_back(event);
  }
  ASSERT_EQ(made.size(), 3u);
  EXPECT_NEAR(seconds(made[0].time), fall, 1e-7);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(seconds(made[i + 1].time) - seconds(made[i].time), 2 * fall + broken[i].duration, 1e-5);
  }
}

// Energy is balanced through a hard landing on a corner with damping and friction: 1e-5 of the largest exchange is
// asked for.
TEST(Contact, EnergyLedgerClosesInALanding) {
  Scene scene = falling_container(0.4, 0.5);
  scene.bodies[1].X_WB.linear() = (Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitX()) *
                                   Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY())).toRotationMatrix();
  scene.bodies[1].v_WB.x() = 0.2;
  Simulation simulation(scene, exact_contact(), 1e-8);
  simulation.run_to(3, 0.01);
  EXPECT_LT(std::abs(simulation.relative_residual()), 1e-5);
  EXPECT_GT(simulation.engine().energy().dissipated, 0.99 * simulation.engine().energy().largest_exchange);
  EXPECT_LT(simulation.get("box.tilt"), 1e-6);
}

// On a slope of angle α a block slides from v₀ with the deceleration g(μ cos α − sin α) to rest if tan α < μ. Gravity
// is tilted instead of the ground. Friction starts at v_t0 = 1 mm/s: v₀ / 500, so that the distance is right to some
// 1e-3 of it; landing on the ground's face without depth shakes it a little more.
TEST(Contact, BlockStopsOnASlope) {
  const double slope = 0.2, friction = 0.4, speed = 0.5;
  contact_nn::ContactSettings contact = exact_contact();
  contact.friction = friction;
  const double sink = kContainerMass * kGravity * std::cos(slope) / contact.stiffness;
  Scene scene = falling_container(-sink, 0);
  scene.gravity = kGravity * Eigen::Vector3d(std::sin(slope), 0, -std::cos(slope));
  scene.bodies[1].v_WB.x() = speed;
  Simulation simulation(scene, contact, 1e-8);
  simulation.run_to(3, 0.01);
  const double deceleration = kGravity * (friction * std::cos(slope) - std::sin(slope));
  // It then creeps at v_t0 r / √(1 − r²), r = tan α / μ.
  const double stop = speed / deceleration, r = std::tan(slope) / friction;
  const double creep = contact.transition_speed * r / std::sqrt(1 - r * r);
  EXPECT_NEAR(simulation.get("box.velocity.x"), creep, 1e-6);
  EXPECT_NEAR(simulation.get("box.position.x"), speed * speed / (2 * deceleration) + creep * (3 - stop), 2e-3);
}

}  // namespace
}  // namespace quayside::harness
