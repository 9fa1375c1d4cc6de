// The engine `mujoco` against results with a known answer.
#include <gtest/gtest.h>

#include "tests/unit/mujoco/scenes.h"

namespace quayside::harness {
namespace {

using crane_models::Pose;
using crane_models::Scene;

constexpr double kMass = 30480;
const Eigen::Vector3d kContainer{12.192, 2.438, 2.591};

// A container just above the ground with 0.5 m/s downwards.
Scene landing(double speed) {
  Scene scene;
  scene.bodies.push_back(ground());
  scene.bodies.push_back(box_body("box", kMass, kContainer, {0, 0, 0.5 * kContainer.z()}));
  scene.bodies[1].v_WB.z() = -speed;
  scene.pairs.push_back({0, 0, 1, 0});
  report(scene, "box");
  return scene;
}

contact_nn::ContactSettings linear_contact(double stiffness, double restitution, double friction) {
  contact_nn::ContactSettings contact = exact_contact();
  contact.law = contact_nn::Law::points;
  contact.stiffness = stiffness;
  contact.restitution = restitution;
  contact.friction = friction;
  return contact;
}

double peak_force(EngineUnit& unit) {
  double peak = 0;
  for (const Event& event : unit.take_events()) peak = std::max(peak, event.peak_force);
  for (const Event& event : unit.open_contacts()) peak = std::max(peak, event.peak_force);
  return peak;
}

// Flat landing on a linear contact without damping: peak mg + √((mg)² + k m v²); 30.48 t, 1e8 N/m, 0.5 m/s: 1222 kN.
// Steps of ω h = 0.06 miss the top by up to (ω h)²/8 = 4.5e-4 of the dynamic part.
TEST(Native, PeakForceOfAFlatLanding) {
  const auto unit = native(landing(0.5), {}, linear_contact(1e8, 1, 0));
  start(*unit);
  run(*unit, 0, 100 * kMillisecond, 10 * kMillisecond);
  const double weight = kMass * kGravity;
  const double expected = weight + std::sqrt(weight * weight + 1e8 * kMass * 0.25);
  EXPECT_NEAR(expected, 1222e3, 1e3);
  EXPECT_NEAR(peak_force(*unit), expected, 4e-4 * expected);
}

// The same between two containers, where the 2.2.2 collider reports half the depth: the parameters make up for it. The
// exactly aligned faces meet in four points.
TEST(Native, PeakForceOnAContainer) {
  Scene scene = landing(0.5);
  scene.bodies[0].boxes[0] = {0.5 * kContainer, Pose(Eigen::Translation3d(0, 0, -0.5 * kContainer.z())), ""};
  const auto unit = native(scene, {}, linear_contact(1e8, 1, 0));
  start(*unit);
  run(*unit, 0, 100 * kMillisecond, 10 * kMillisecond);
  const double weight = kMass * kGravity;
  const double expected = weight + std::sqrt(weight * weight + 1e8 * kMass * 0.25);
  EXPECT_NEAR(peak_force(*unit), expected, 4e-4 * expected);
}

// Without gravity the rebound is the restitution times the approach. The damping force C v = 2 ζ ω m v starts at the
// touch, somewhere in a step: an error of up to ζ ω h of the speed, 0.7 % at ζ = 0.36 and ω h = 0.019.
TEST(Native, Restitution) {
  for (const double restitution : {0.3, 0.7}) {
    Scene scene = landing(0.5);
    scene.gravity.setZero();
    SolverSettings solver;
    solver.relative_tolerance = 1e-8;
    const auto unit = native(scene, solver, linear_contact(6e8, restitution, 0));
    start(*unit);
    run(*unit, 0, 200 * kMillisecond, 10 * kMillisecond);
    EXPECT_NEAR(get(*unit, "box.velocity.z"), 0.5 * restitution, 7e-3 * 0.5);
  }
}

// At rest the stack sinks by m g/K in the contact that carries m: 0.498 mm at 6e8 N/m over the reference area.
TEST(Native, RestsAtTheStaticDepth) {
  auto contact = exact_contact();
  const auto unit = native(landing(0), {}, contact);
  start(*unit);
  run(*unit, 0, 2 * kSecond, 50 * kMillisecond);
  const double stiffness = 6e8 * std::pow(kContainer.x() * kContainer.y() / 29.7, 0.25);  // p = 8: (A/A_f)^(2/p)
  EXPECT_NEAR(get(*unit, "box.position.z"), 0.5 * kContainer.z() - kMass * kGravity / stiffness, 1e-8);
  EXPECT_NEAR(get(*unit, "contact.ground.box.force"), kMass * kGravity, 1);
  EXPECT_EQ(unit->statistics().phantom_contacts, 0u);
}

// A block on ground tilted gravity stays below the friction angle but for the creep v = (g sin α)/(μ g cos α) v_t, and
// slides with g (sin α − μ cos α) above it.
TEST(Native, FrictionHoldsAndSlides) {
  for (const double tangent : {0.2, 0.6}) {
    const double alpha = std::atan(tangent);
    Scene scene = landing(0);
    scene.gravity = kGravity * Eigen::Vector3d(std::sin(alpha), 0, -std::cos(alpha));
    const auto unit = native(scene);
    start(*unit);
    run(*unit, 0, kSecond, 50 * kMillisecond);
    const double x = get(*unit, "box.position.x");
    if (tangent < 0.4) {
      EXPECT_LT(x, 2e-3);  // a second of creep at 0.5 to 1 mm/s, and the start
      EXPECT_GT(x, 0);
    } else {
      const double slide = 0.5 * kGravity * (std::sin(alpha) - 0.4 * std::cos(alpha));
      EXPECT_NEAR(x, slide, 0.01 * slide);  // the normal force rings in at the start
    }
  }
}

// 40 t on four ropes of EA/L0 = 42e6/20 N/m: stretch m g/Σk, tension m g/4.
TEST(Native, RopeStretch) {
  const auto unit = native(crane(20));
  start(*unit);
  run(*unit, 0, kSecond, 50 * kMillisecond);
  const double stretch = 40e3 * kGravity / (4 * 42e6 / 20);
  EXPECT_NEAR(get(*unit, "rope.0.stretch"), stretch, 1e-6 * stretch);
  EXPECT_NEAR(get(*unit, "rope.0.tension"), 40e3 * kGravity / 4, 1e-6 * 40e3 * kGravity / 4);
}

// Trolley and hoist driving: the same ropes in MuJoCo's terms. The constraint's inertia, 1e-4 of the load's, shifts
// heave by 5e-5 of its amplitude of centimetres; sway does not feel it.
TEST(Native, RopesAgreeWithOurLaw) {
  Eigen::Vector3d position[2];
  for (const bool same : {false, true}) {
    const auto unit = same ? same_law(crane(20)) : native(crane(20));
    start(*unit);
    set(*unit, "trolley.acceleration", 0.6);
    set(*unit, "hoist.rate", -0.5);
    run(*unit, 0, 5 * kSecond, 10 * kMillisecond);
    position[same] = get3(*unit, "load.position");
    const EnergyLedger energy = unit->energy();
    EXPECT_LT(std::abs(energy.residual()), 1e-4 * energy.largest_exchange);
  }
  EXPECT_LT((position[0] - position[1]).norm(), 5e-5);
}

// A linear contact with damping begins with the force C v: the switch flips in the nanosecond of the touch, and the
// events have that time, whatever the length of the step they fell into.
TEST(Native, TouchAndLandingAreOneEvent) {
  Scene scene = landing(0);
  scene.bodies[1].X_WB.translation().z() += 0.05;
  scene.landed_switches.push_back({"landed", {1}, 0.1 * kMass * kGravity});
  const auto unit = native(scene);
  start(*unit);
  const StepResult result = unit->do_step(0, 150 * kMillisecond);
  const double touch = std::sqrt(2 * 0.05 / kGravity);
  EXPECT_TRUE(result.event);
  EXPECT_NEAR(seconds(result.time), touch, 5e-9);
  unit->do_step(result.time, kMillisecond);
  const auto events = unit->take_events();
  ASSERT_EQ(events.size(), 2u);
  for (const Event& event : events) EXPECT_NEAR(seconds(event.time), touch, 5e-9);
}

// Lowered onto the ground the ropes go slack and stay without force.
TEST(Native, SlackRopesDoNotPush) {
  Scene scene = crane(20);
  scene.bodies.push_back(ground());
  scene.bodies[1].X_WB.translation().z() = 20 - 40e3 * kGravity / (4 * 42e6 / 20);
  scene.bodies[2].boxes[0].X_BG.translation().z() = 18.5 - 1;
  scene.pairs.push_back({2, 0, 1, 0});
  const auto unit = native(scene);
  start(*unit);
  set(*unit, "hoist.rate", 0.4);
  run(*unit, 0, 3 * kSecond, 20 * kMillisecond);
  EXPECT_LT(get(*unit, "rope.0.stretch"), -0.5);
  EXPECT_EQ(get(*unit, "rope.0.tension"), 0);
  EXPECT_NEAR(get(*unit, "contact.ground.load.force"), 40e3 * kGravity, 10);
}

// A load hangs by four pins below a fixed beam: sag m g/(4 k). When they open it falls, and the ledger books ½ m g ·
// sag.
TEST(Native, LockHoldsAndOpens) {
  Scene scene;
  scene.commands.push_back({"twistlocks", "", true});
  auto beam = box_body("beam", 1, {12, 2, 1}, {0, 0, 10});
  beam.joint.type = crane_models::JointType::fixed;
  beam.joint.X_PF.translation() = beam.X_WB.translation();
  scene.bodies = {beam, box_body("load", 20e3, {12, 2, 2}, {0, 0, 8.5})};
  spreader::Lock lock;
  lock.name = "twistlocks";
  lock.body_a = 0;
  lock.body_b = 1;
  for (const double x : {-5.0, 5.0}) {
    for (const double y : {-1.0, 1.0}) lock.pins.push_back({{x, y, -0.5}, {x, y, 1}});
  }
  lock.stiffness = 5e7;
  lock.damping = 5e5;
  lock.command = 0;
  scene.locks.push_back(lock);
  report(scene, "load");
  const auto unit = native(scene);
  start(*unit);
  run(*unit, 0, kSecond, 50 * kMillisecond);
  const double sag = 20e3 * kGravity / (4 * 5e7);
  EXPECT_NEAR(get(*unit, "load.position.z"), 8.5 - sag, 1e-4 * sag);
  const double dissipated = unit->energy().dissipated;
  set(*unit, "twistlocks", 0);
  unit->enter_event_mode();
  unit->update_discrete_states();
  unit->enter_step_mode();
  EXPECT_NEAR(unit->energy().dissipated - dissipated, 0.5 * 20e3 * kGravity * sag, 1e-3);
  run(*unit, kSecond, 2 * kSecond, 50 * kMillisecond);
  EXPECT_NEAR(get(*unit, "load.position.z"), 8.5 - sag - 0.5 * kGravity, 1e-6);
}

}  // namespace
}  // namespace quayside::harness
