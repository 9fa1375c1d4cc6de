// Machines: trim and list by the ropes, the trailer's springs, the boom's statics, the pendulum under it, and stacks that topple.
#include <cmath>

#include <gtest/gtest.h>

#include "crane_models/mafi.h"
#include "crane_models/reach_stacker.h"
#include "crane_models/rope_crane.h"
#include "tests/acceptance/scenes.h"
#include "tests/acceptance/zero_crossings.h"

namespace quayside::harness {
namespace {

using crane_models::Scene;
using Eigen::Vector3d;

constexpr double kTight = 1e-9;  // relative tolerance of the solver: its error is far below the physics'

int index_of(const Scene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].name == name) return static_cast<int>(i);
  }
  throw std::out_of_range(name);
}

// Parallel ropes at half distance a from the middle, longer by d at one end, hang vertical all the same, so the load leans by
// θ = d/2a; and as its centre of mass, c below the sheaves, goes to the short side by c θ, the tensions differ by W c θ/a, and
// the stretch takes back W c θ/(2 k a) of the difference: θ = d/(2 a + W c/(2 k a)), k of one rope. What the hanging load adds
// by swinging is twice the angle of its start, and dies out in the ropes' damping to parts in a thousand.
class LeaningRopes : public ::testing::TestWithParam<const char*> {};

TEST_P(LeaningRopes, TiltTheLoadByTheirDifferenceOverTheirSpacing) {
  const std::string drive = GetParam();
  const bool trim = drive == "trim";
  crane_models::RopeCrane crane = crane_models::quayside_crane();
  crane.trolley_height = 40;
  crane.rope_length = 20;
  crane.trolley_sheaves = crane.spreader_sheaves = {5.6, 2.4};
  crane.trim_position = crane.list_position = 0;
  crane.load_side.loads = {{"load", 20000}};
  Scene scene;
  crane_models::add_rope_crane(crane, scene);
  double weight = 0, moment = 0;
  for (const char* name : {"spreader", "load"}) {
    const auto& body = scene.bodies[index_of(scene, name)];
    weight += kGravity * body.mass;
    moment += kGravity * body.mass * (body.X_WB * body.p_BBcm).z();
  }
  const double c = crane.trolley_height - crane_models::hanging_height(crane, scene) - moment / weight;
  const double a = (trim ? 5.6 : 2.4) / 2, k = crane.rope_stiffness / crane.rope_length;
  const double difference = 0.06;
  const double expected = difference / (2 * a + weight * c / (2 * k * a));

  Simulation simulation(scene, exact_contact(), 1e-8);
  simulation.set(drive + ".rate", difference / 20);
  simulation.run_to(20, 0.5);
  simulation.set(drive + ".rate", 0);
  double sum = 0;
  int count = 0;
  simulation.run_to(60, 0.05, [&] {
    sum += (trim ? 2 : -2) * simulation.get(trim ? "spreader.orientation.y" : "spreader.orientation.x");
    ++count;
  });
  EXPECT_NEAR(sum / count / expected, 1, 2e-3);
  EXPECT_LT(std::abs(simulation.relative_residual()), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(OfACrane, LeaningRopes, ::testing::Values("trim", "list"));

// Four linear springs under a mass: √(4 k/m) / 2π, 2.336 Hz for 26 t on 1.4 MN/m each.
TEST(Mafi, BouncesOnItsSuspension) {
  crane_models::Mafi mafi;
  mafi.deck_mass = 26e3;
  mafi.suspension_damping_ratio = 0;
  Scene scene;
  crane_models::add_mafi(mafi, scene);
  const int deck = index_of(scene, "deck");
  scene.bodies[deck].X_WB.translation().z() -= 0.02;
  Simulation simulation(scene, exact_contact(), kTight);
  ZeroCrossings crossings;
  simulation.run_to(3, 0.002, [&] {
    crossings.add(simulation.time(), simulation.get("deck.position.z") - 1.2, simulation.get("deck.velocity.z"));
  });
  const double frequency = std::sqrt(4 * 1.4e6 / 26e3) / (2 * kPi);
  EXPECT_NEAR(frequency, 2.336, 5e-4);
  ASSERT_GE(crossings.times().size(), 3u);
  EXPECT_NEAR(1 / crossings.period() / frequency, 1, 1e-6);
}

// A boom that turns slowly by dθ does the work M dθ, M = Σ m g r over all that it carries, r the horizontal way from its
// hinge. At 1e-4 rad/s the kinetic energy of the start is 5e-5 of that work; M itself changes by sin θ / cos θ dθ = 1e-4.
TEST(ReachStacker, BoomCarriesTheMomentOfItsLoad) {
  crane_models::ReachStacker machine;
  machine.boom_angle = 0.6;
  machine.telescope_length = 1;
  machine.load_side.loads = {{"load", 20000}};
  Scene scene;
  crane_models::add_reach_stacker(machine, scene);
  double moment = 0;
  const Vector3d hinge = scene.bodies[index_of(scene, "boom")].X_WB.translation();
  for (const auto& body : scene.bodies) {
    if (body.name == "truck") continue;
    moment += body.mass * kGravity * ((body.X_WB * body.p_BBcm).y() - hinge.y());
  }
  // 9 t at half of 8.4 m, 4 t 3 m behind the tip at 9.4 m, 2.5 + 12 + 20 t under the tip, all times cos 0.6.
  EXPECT_NEAR(moment, kGravity * std::cos(0.6) * (9e3 * 4.2 + 4e3 * 6.4 + 34.5e3 * 9.4), 1e-6 * moment);
  Simulation simulation(scene, exact_contact(), kTight);
  const double rate = 1e-4;
  simulation.set("boom.rate", rate);
  simulation.run_to(1, 0.1);
  EXPECT_NEAR(simulation.get("energy.work_in") / (moment * rate), 1, 5e-4);
}

// About the lower pivot everything below is one rigid body: T = 2π √(I/(m g d)), I about the pivot, d from the pivot to
// the centre of mass. At 0.5° the amplitude adds 5e-6; twistlocks of 4e8 N/m under 20 t give by 5e-4 m, and turn the
// load against the spreader by parts in 1e4 of the angle.
TEST(ReachStacker, LoadSwingsAboutItsPivot) {
  crane_models::ReachStacker machine;
  machine.pivot_damping = 0;
  machine.load_side.loads = {{"load", 20000}};
  Scene scene;
  crane_models::add_reach_stacker(machine, scene);
  const Vector3d pivot = machine.tip() - Vector3d(0, 0, machine.pivot_drop);
  // Turned about the pivot's axis, the world's y.
  const double angle = 0.5 * kPi / 180;
  const crane_models::Pose turn = Eigen::Translation3d(pivot) *
                                  crane_models::Pose(Eigen::AngleAxisd(angle, Vector3d::UnitY())) *
                                  Eigen::Translation3d(-pivot);
  double inertia = 0, moment = 0;
  for (const char* name : {"head", "rotator", "spreader", "load"}) {
    auto& body = scene.bodies[index_of(scene, name)];
    const Vector3d arm = body.X_WB * body.p_BBcm - pivot;
    inertia += body.I_BBcm_B(1, 1) + body.mass * (arm.x() * arm.x() + arm.z() * arm.z());
    moment -= body.mass * kGravity * arm.z();
    body.X_WB = turn * body.X_WB;
  }
  Simulation simulation(scene, exact_contact(), kTight);
  ZeroCrossings crossings;
  simulation.run_to(16, 0.01, [&] {
    crossings.add(simulation.time(), 2 * simulation.get("spreader.orientation.y"),
                  simulation.get("spreader.angular_velocity.y"));
  });
  const double expected = 2 * kPi * std::sqrt(inertia / moment);
  ASSERT_GE(crossings.times().size(), 3u);
  EXPECT_NEAR(crossings.period() / expected, 1, 2e-3);
}

// A stack, taken as one block of height h and width b, that turns about its lower edge with ω tips over when
// ½ I ω² > m g (√(h²/4 + b²/4) − h/2), I = m (h² + b²)/3 about the edge. The contact gives by millimetres, which moves
// the edge inward by as much: parts in a hundred of the small b/2 that it has to climb over.
class Topple : public ::testing::TestWithParam<double> {};

TEST_P(Topple, SpeedOfAStackOfThree) {
  const double factor = GetParam(), h = 3 * 2.591, b = 2.438, mass = 3 * 24000;
  const double omega = std::sqrt(6 * kGravity * (std::hypot(h / 2, b / 2) - h / 2) / (h * h + b * b));
  Scene scene;
  add_body(scene, ground());
  crane_models::Body stack = free_box("stack", mass, {12.192, b, h}, at(0, 0, h / 2));
  // About the edge at y = b/2, towards +y: the velocity of the centre is ω × (centre − edge).
  stack.w_WB = Vector3d(-factor * omega, 0, 0);
  stack.v_WB = stack.w_WB.cross(Vector3d(0, -b / 2, h / 2));
  add_body(scene, stack);
  contact_nn::ContactSettings contact = exact_contact();
  contact.friction = 1.5;  // it turns and does not slide
  Simulation simulation(scene, contact, 1e-7);
  double largest_tilt = 0;
  simulation.run_to(factor > 1 ? 3.2 : 2, 0.02,
                    [&] { largest_tilt = std::max(largest_tilt, simulation.get("stack.tilt")); });
  const double balance = std::atan2(b, h);
  if (factor > 1) {
    EXPECT_GT(largest_tilt, 2 * balance);
  } else {
    EXPECT_LT(largest_tilt, balance);
  }
}

INSTANTIATE_TEST_SUITE_P(OfTheCriticalSpeed, Topple, ::testing::Values(0.95, 1.05));

}  // namespace
}  // namespace quayside::harness
