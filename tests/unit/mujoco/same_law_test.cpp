// mujoco_same_law against results with a known answer.
#include <gtest/gtest.h>

#include "harness/simbody/simbody_unit.h"
#include "tests/unit/mujoco/scenes.h"

namespace quayside::harness {
namespace {

using crane_models::JointType;
using crane_models::Pose;
using crane_models::Scene;

SolverSettings fixed_step(double h) {
  SolverSettings solver;
  solver.mujoco_step = h;
  return solver;
}

TEST(SameLaw, FreeFallIsExact) {
  Scene scene;
  scene.bodies.push_back(box_body("box", 1000, {1, 1, 1}, {0, 0, 10}));
  scene.bodies[0].v_WB = {1, 0, 2};
  report(scene, "box");
  const auto unit = same_law(scene);
  start(*unit);
  run(*unit, 0, kSecond, 10 * kMillisecond);
  // A parabola is in the reach of RK4: what is left is rounding of some hundred additions to 10 m.
  EXPECT_NEAR(get(*unit, "box.position.z"), 10 + 2 - 0.5 * kGravity, 1e-12);
  EXPECT_NEAR(get(*unit, "box.position.x"), 1, 1e-12);
  EXPECT_NEAR(get(*unit, "box.velocity.z"), 2 - kGravity, 1e-12);
}

// A body that tumbles freely keeps its energy and, in the world, its angular momentum. MuJoCo's RK4 composes rotations
// without the commutator terms that a method of order four needs on them: its error goes with h².
TEST(SameLaw, TumblingKeepsEnergyAndMomentum) {
  const auto drift = [](double h) {
    Scene scene;
    scene.gravity.setZero();
    scene.bodies.push_back(box_body("box", 1000, {1, 2, 3}, {0, 0, 0}));
    scene.bodies[0].w_WB = {0.1, 1, 0.1};
    report(scene, "box");
    const Eigen::Vector3d L_start = scene.bodies[0].I_BBcm_B * scene.bodies[0].w_WB;
    const auto unit = same_law(scene, fixed_step(h));
    start(*unit);
    run(*unit, 0, 20 * kSecond, kSecond);
    const Eigen::Quaterniond q(get(*unit, "box.orientation.w"), get(*unit, "box.orientation.x"),
                               get(*unit, "box.orientation.y"), get(*unit, "box.orientation.z"));
    const Eigen::Vector3d w_W = get3(*unit, "box.angular_velocity");
    const Eigen::Vector3d L = q * (scene.bodies[0].I_BBcm_B * (q.conjugate() * w_W));
    const EnergyLedger energy = unit->energy();
    return std::pair(std::abs(energy.residual()) / energy.start, (L - L_start).norm() / L_start.norm());
  };
  const auto [energy_coarse, momentum_coarse] = drift(4e-3);
  const auto [energy_fine, momentum_fine] = drift(2e-3);
  // The rates are those of RK4 in the body's frame, so that the energy keeps order four (and is at rounding here).
  EXPECT_LT(energy_fine, 1e-10);
  EXPECT_LT(momentum_fine, 1e-6);
  EXPECT_NEAR(momentum_coarse / momentum_fine, 4, 0.5);
  EXPECT_LT(energy_coarse, 1e-9);
}

// A hinged bar from 20 degrees: T = 2π√(I/(m g s)) · 1.007669, the factor of the elliptic integral to its six digits.
TEST(SameLaw, PendulumPeriod) {
  Scene scene;
  auto bar = box_body("bar", 1000, {0.1, 0.1, 2}, {0, 0, 0});
  const double amplitude = 20 * M_PI / 180, arm = 5;
  bar.joint.type = JointType::hinge;
  // The hinge's z axis along the world's y; the bar's frame turned likewise, 5 m above its centre.
  const Eigen::Matrix3d R = Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  bar.joint.X_PF.linear() = R;
  bar.joint.X_BM = Eigen::Translation3d(0, 0, arm) * Eigen::Quaterniond(R);
  bar.X_WB = Eigen::AngleAxisd(amplitude, Eigen::Vector3d::UnitY()) * Eigen::Translation3d(0, 0, -arm);
  scene.bodies.push_back(bar);
  report(scene, "bar");
  const double inertia = bar.I_BBcm_B(1, 1) + bar.mass * arm * arm;
  const double period = 2 * M_PI * std::sqrt(inertia / (bar.mass * kGravity * arm)) * 1.007669;

  const auto unit = same_law(scene);
  start(*unit);
  EXPECT_NEAR(get(*unit, "bar.tilt"), amplitude, 1e-12);
  // A quarter of a period after the start it hangs straight, with the angular velocity √(2 m g s (1 − cos θ₀)/I).
  run(*unit, 0, nanoseconds(period / 4), 10 * kMillisecond);
  const double speed = std::sqrt(2 * bar.mass * kGravity * arm * (1 - std::cos(amplitude)) / inertia);
  EXPECT_NEAR(get(*unit, "bar.angular_velocity.y"), -speed, 1e-6 * speed);
  EXPECT_NEAR(get(*unit, "bar.position.x"), 0, 2e-6 * period * speed * arm);  // half a digit of the factor, as a time
}

// Heave, sway and twist of a load on four elastic ropes while trolley and hoist drive: smooth, since no rope goes
// slack. Against a step of 0.5 ms halving the step cuts the error by 16 (by 15 to 17 with the reference's own error).
TEST(SameLaw, ConvergesWithOrderFour) {
  const auto end = [](double h) {
    Scene scene = crane(15);
    scene.bodies[1].X_WB.translation() += Eigen::Vector3d(0.3, 0.2, -0.01);
    const auto unit = same_law(scene, fixed_step(h));
    start(*unit);
    set(*unit, "trolley.acceleration", 0.6);
    set(*unit, "hoist.acceleration", 0.1);
    run(*unit, 0, 2 * kSecond, 8 * kMillisecond);
    return get3(*unit, "load.position");
  };
  const Eigen::Vector3d exact = end(0.5e-3);
  const double coarse = (end(8e-3) - exact).norm(), middle = (end(4e-3) - exact).norm();
  const double fine = (end(2e-3) - exact).norm();
  EXPECT_GT(std::log2(coarse / middle), 3.7);
  EXPECT_GT(std::log2(middle / fine), 3.7);
  EXPECT_LT(fine, 1e-7);
}

TEST(SameLaw, DrivenJointsStandWhereTheirDrivesAre) {
  const auto unit = same_law(crane(20));
  start(*unit);
  set(*unit, "trolley.rate", 0.1);
  set(*unit, "trolley.acceleration", 0.6);
  run(*unit, 0, 2 * kSecond, 7 * kMillisecond);
  EXPECT_NEAR(get(*unit, "trolley.position.y"), 0.1 * 2 + 0.5 * 0.6 * 4, 1e-12);
  EXPECT_NEAR(get(*unit, "trolley.velocity.y"), 0.1 + 0.6 * 2, 1e-12);
  EXPECT_NEAR(get(*unit, "trolley.value"), 0.1 * 2 + 0.5 * 0.6 * 4, 1e-12);  // an input goes on as it was set
}

TEST(SameLaw, SteadyAccelerationHoldsTheLagAngle) {
  // A pendulum on a driven trolley that starts at tan θ = −a/g against the vertical and moves with the trolley stays
  // there.
  Scene scene;
  scene.drives.push_back({"trolley", "m", "", 0, 1, 3, 1});
  auto trolley = box_body("trolley", 1000, {1, 1, 1}, {0, 0, 0});
  trolley.joint.type = JointType::slider;
  trolley.joint.drive = 0;
  auto load = box_body("load", 20e3, {2, 2, 2}, {0, 0, 0});
  load.joint.type = JointType::pivot;
  load.joint.parent = 0;
  load.joint.X_BM = Eigen::Translation3d(0, 0, 10);
  const double a = 0.6;
  load.X_WB = Eigen::AngleAxisd(std::atan(a / kGravity), Eigen::Vector3d::UnitY()) * Eigen::Translation3d(0, 0, -10);
  scene.bodies = {trolley, load};
  report(scene, "load");
  const auto unit = same_law(scene);
  start(*unit);
  set(*unit, "trolley.acceleration", a);
  unit->enter_event_mode();
  unit->update_discrete_states();
  unit->enter_step_mode();
  run(*unit, 0, 5 * kSecond, 10 * kMillisecond);
  EXPECT_NEAR(get(*unit, "load.tilt"), std::atan(a / kGravity), 1e-7);
  // The drive has done what the load has gained: ½ m v² of both, v = 3 m/s.
  const EnergyLedger energy = unit->energy();
  EXPECT_NEAR(energy.work_in, 0.5 * 21e3 * 9, 1e-5 * energy.work_in);
  EXPECT_LT(std::abs(energy.residual()), 1e-5 * energy.largest_exchange);
}

TEST(SameLaw, EnergyLedgerCloses) {
  Scene scene = crane(20);
  scene.bodies.push_back(ground());
  scene.pairs.push_back({2, 0, 1, 0});
  scene.bodies[1].X_WB.translation().y() = 0.5;
  SolverSettings solver;
  solver.relative_tolerance = 1e-8;
  auto unit = same_law(scene, solver);
  start(*unit);
  set(*unit, "trolley.acceleration", 0.3);
  set(*unit, "hoist.rate", 0.8);
  run(*unit, 0, 2 * kSecond, 10 * kMillisecond);
  const EnergyLedger energy = unit->energy();
  EXPECT_GT(energy.largest_exchange, 1e5);
  EXPECT_LT(std::abs(energy.residual()), 1e-5 * energy.largest_exchange);
  EXPECT_GT(energy.dissipated, 0);
}

Scene drop(double height) {
  Scene scene;
  scene.bodies.push_back(ground());
  scene.bodies.push_back(box_body("box", 30480, {12.192, 2.438, 2.591}, {0, 0, 0.5 * 2.591 + height}));
  scene.pairs.push_back({0, 0, 1, 0});
  scene.landed_switches.push_back({"landed", {1}, 0.1 * 30480 * kGravity});
  report(scene, "box");
  return scene;
}

// From 50 mm a box falls √(2h/g) = 0.1009638 s; then K δ grows over the threshold of the switch within
// 0.1 m g/(K v) = 50 µs. The event ends the step at that nanosecond, and the landing is seen at the touch.
TEST(SameLaw, LandingEndsTheStepAtItsTime) {
  const auto unit = same_law(drop(0.05));
  start(*unit);
  const double touch = std::sqrt(2 * 0.05 / kGravity);
  const StepResult result = unit->do_step(0, 150 * kMillisecond);
  EXPECT_TRUE(result.event);
  EXPECT_GT(seconds(result.time), touch);
  EXPECT_LT(seconds(result.time), touch + 1e-4);
  EXPECT_EQ(get(*unit, "landed"), 1);
  const auto events = unit->take_events();
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].kind, EventKind::contact_made);
  EXPECT_NEAR(seconds(events[0].time), touch, 5e-9);  // the monitor's dead band of 1e-9 m at 1 m/s, and rounding
  EXPECT_EQ(events[1].kind, EventKind::landed);
  EXPECT_EQ(events[1].time, result.time);
  EXPECT_NEAR(get(*unit, "contact.ground.box.force"), 0.1 * 30480 * kGravity, 30);  // K v · 1 ns, and damping on it
}

// What the ground's impulse has to do over a long time: stop the fall and carry the weight.
TEST(SameLaw, ImpulseOfALanding) {
  const auto unit = same_law(drop(0.05));
  start(*unit);
  run(*unit, 0, kSecond, 10 * kMillisecond);
  double impulse = 0;
  for (const Event& event : unit->take_events()) impulse += event.impulse;
  for (const Event& event : unit->open_contacts()) impulse += event.impulse;
  EXPECT_NEAR(impulse, 30480 * kGravity, 1e-6 * 30480 * kGravity);
}

// A container set down on a corner at 0.3 m/s with a slide and a spin, under friction that sticks: Runge-Kutta of order four,
// where its rates have no kink. Both engines converge to the same end, and at rest nothing creeps.
TEST(SameLaw, FrictionThatSticksIsThatOfTheOtherEngine) {
  Scene scene = drop(0.02);
  scene.landed_switches.clear();
  scene.bodies[1].X_WB.linear() = Eigen::AngleAxisd(0.004, Eigen::Vector3d(1, 2, 0).normalized()).toRotationMatrix();
  scene.bodies[1].v_WB = {0.4, 0.1, -0.3};
  scene.bodies[1].w_WB = {0, 0, 0.05};
  scene.gravity = {1, 0, -9.7};
  auto contact = exact_contact();
  contact.friction_law = contact_nn::Friction::bristle;
  SolverSettings solver;
  solver.relative_tolerance = 1e-9;
  const auto mujoco = same_law(scene, solver, contact), simbody = make_simbody_engine(scene, contact, solver);
  for (const auto& unit : {mujoco.get(), simbody.get()}) start(*unit);
  for (Time now = 0; now < 4 * kSecond; now += kSecond) {
    for (const auto& unit : {mujoco.get(), simbody.get()}) run(*unit, now, now + kSecond, 10 * kMillisecond);
    EXPECT_LT((get3(*mujoco, "box.position") - get3(*simbody, "box.position")).norm(), 1e-6) << seconds(now);
  }
  EXPECT_GT(get(*simbody, "box.position.x"), 0.02);  // it has slid: about v²/(2 · 2.9 m/s²)
  EXPECT_LT(get3(*mujoco, "box.velocity").norm(), 1e-6);
  EXPECT_LT(std::abs(mujoco->energy().residual()), 1e-5 * mujoco->energy().largest_exchange);

  const UnitState state = mujoco->save();
  const auto fresh = same_law(scene, solver, contact);
  fresh->restore(state);
  EXPECT_EQ(fresh->save(), state);
  for (const auto& unit : {mujoco.get(), fresh.get()}) run(*unit, 4 * kSecond, 5 * kSecond, 10 * kMillisecond);
  EXPECT_EQ(get3(*fresh, "box.position"), get3(*mujoco, "box.position"));
}

}  // namespace
}  // namespace quayside::harness
