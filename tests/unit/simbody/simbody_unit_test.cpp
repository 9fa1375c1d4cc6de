// The contract of a Unit, kept by the Simbody engine.
#include <cmath>

#include <gtest/gtest.h>

#include "harness/simbody/simbody_unit.h"
#include "tests/acceptance/scenes.h"

namespace quayside::harness {
namespace {

using crane_models::Scene;

constexpr double kRopeStiffness = 13e6;  // of all four [N/m]

// A container in twistlocks under a spreader on ropes, driven by hoist and trolley, 0.3 m above the ground: every kind
// of joint, force and input that a landing has.
Scene landing_scene() {
  Scene scene;
  scene.drives.push_back({"hoist", "m", "rest length", 0, -1, 1, 0.5});
  scene.drives.push_back({"trolley", "m", "position", 0, 1, 4, 0.6});
  scene.commands.push_back({"twistlocks", "closed", true});
  add_body(scene, ground());

  crane_models::Body trolley;
  trolley.name = "trolley";
  trolley.mass = 12000;
  trolley.joint.type = crane_models::JointType::slider;
  trolley.joint.drive = 1;
  trolley.joint.X_PF.linear() = Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  trolley.joint.X_PF.translation().z() = 20;
  trolley.joint.X_BM.linear() = trolley.joint.X_PF.linear();
  add_body(scene, trolley);

  const Eigen::Vector3d spreader_size(12, 2.3, 0.5);
  crane_models::Body spreader = free_box("spreader", 12000, spreader_size, at(0, 0, 0.3 + kContainerSize.z() + 0.25));
  spreader.boxes.clear();
  add_body(scene, spreader);
  add_body(scene, free_box("load", kContainerMass, kContainerSize, at(0, 0, 0.3 + kContainerSize.z() / 2)));

  const double length = 20 - (0.3 + kContainerSize.z() + 0.5);
  scene.drives[0].start = length / (1 + (kContainerMass + 12000) * kGravity / (kRopeStiffness * length));
  for (const double x : {-2.5, 2.5}) {
    for (const double y : {-0.8, 0.8}) {
      spreader::Rope rope;
      rope.name = "rope" + std::to_string(scene.ropes.size());
      rope.upper = {1, {x, y, 0}};
      rope.lower = {2, {x, y, 0.25}};
      rope.axial_stiffness = kRopeStiffness / 4 * length;
      rope.damping_time = 0.01;
      rope.drives = {{0}};
      scene.ropes.push_back(rope);
    }
  }
  spreader::Lock lock;
  lock.name = "twistlocks";
  lock.body_a = 2;
  lock.body_b = 3;
  for (const double x : {-5.85, 5.85}) {
    for (const double y : {-1.1, 1.1}) lock.pins.push_back({{x, y, -0.25}, {x, y, kContainerSize.z() / 2}});
  }
  lock.stiffness = 1e8;
  lock.damping = 1e5;
  lock.command = 0;
  scene.locks.push_back(lock);
  scene.landed_switches.push_back({"landed", {3}, 5e4});
  return scene;
}

// Lowers at 0.25 m/s with a moving trolley, brakes 0.25 s after landing, opens the twistlocks another second later, as
// a script would. Ramps are given by acceleration alone.
void land(Simulation& simulation, double step, double end) {
  const auto drive = [&](double hoist, double trolley) {
    simulation.set("hoist.acceleration", hoist);
    simulation.set("trolley.acceleration", trolley);
  };
  drive(0.5, 0.2);
  simulation.run_to(0.5, step);
  drive(0, 0);
  simulation.run_to(1.5, step);
  drive(-0.5, -0.2);
  simulation.run_to(2, step);
  drive(0, 0);
  simulation.set("hoist.rate", 0);
  simulation.set("trolley.rate", 0);
  simulation.run_to(3, step);
  simulation.set("twistlocks", 0);
  simulation.run_to(end, step);
}

std::vector<double> outputs(Simulation& simulation) {
  std::vector<double> values;
  const auto& variables = simulation.engine().variables();
  for (std::size_t i = 0; i < variables.size(); ++i) {
    values.push_back(simulation.engine().get(static_cast<ValueReference>(i)));
  }
  return values;
}

Scene corner_landing() {
  Scene scene;
  add_body(scene, ground());
  auto X = at(0, 0, kContainerSize.z() / 2 + 0.4);
  X.linear() = (Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY()))
                   .toRotationMatrix();
  add_body(scene, free_box("box", kContainerMass, kContainerSize, X));
  scene.bodies[1].v_WB = {0.2, 0, -0.5};
  scene.landed_switches.push_back({"landed", {1}, 5e4});
  return scene;
}

// The ledger with drives, driven joint, rope damping, locks that open, contact with friction: 1e-5 of the largest
// exchange at 1e-8.
TEST(SimbodyUnit, LedgerClosesInALandingWithEverything) {
  Simulation simulation(landing_scene(), exact_contact(), 1e-8);
  land(simulation, 0.01, 5);
  EXPECT_LT(std::abs(simulation.relative_residual()), 1e-5);
  EXPECT_EQ(simulation.get("landed"), 1);
  EXPECT_NEAR(simulation.get("load.position.z"), kContainerSize.z() / 2, 1e-3);
  EXPECT_LT(simulation.get("load.tilt"), 1e-4);
  std::vector<EventKind> kinds;
  Time last = 0;
  for (const Event& event : simulation.engine().take_events()) {
    kinds.push_back(event.kind);
    EXPECT_GE(event.time, last);
    last = event.time;
  }
  for (const EventKind kind :
       {EventKind::contact_made, EventKind::landed, EventKind::rope_slack, EventKind::lock_opened}) {
    EXPECT_NE(std::find(kinds.begin(), kinds.end(), kind), kinds.end()) << to_string(kind);
  }
}

// The integrator's steps do not know the communication steps: what differs is where events of drives cut, which is at
// the same times here, so only rounding is left.
TEST(SimbodyUnit, ResultDoesNotDependOnTheCommunicationStep) {
  std::vector<double> reference;
  for (const double step : {1e-1, 1e-2, 1e-3, 1e-4}) {
    Simulation simulation(corner_landing(), exact_contact(), 1e-6);
    simulation.run_to(0.8, step);
    const Eigen::Vector3d p = simulation.vector("box.position");
    if (reference.empty()) reference = {p.x(), p.y(), p.z()};
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(p[i], reference[i], 1e-12) << "step " << step;
  }
}

// Halting error falls with the tolerance, against 1e-10: BDF keeps the global error within some hundred times its
// local tolerance through the impacts of a corner landing.
TEST(SimbodyUnit, ConvergesWithTheTolerance) {
  const auto end = [](double tolerance) {
    Simulation simulation(corner_landing(), exact_contact(), tolerance);
    simulation.run_to(0.5, 0.05);
    return simulation.vector("box.position");
  };
  const Eigen::Vector3d reference = end(1e-10);
  double last = 1;
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    const double error = (end(tolerance) - reference).norm();
    std::cout << "relative tolerance " << tolerance << ": " << error << " m\n";
    EXPECT_LT(error, 300 * tolerance);
    EXPECT_LT(error, 0.2 * last);
    last = error;
  }
}

// However loose the tolerance and long the communication step, a contact is not stepped over: a fall from 40 m, whose
// smooth part the integrator crosses in two steps, is stopped by the ground.
TEST(SimbodyUnit, StepsOverNoContact) {
  for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
    Scene scene;
    add_body(scene, ground());
    scene.bodies[0].boxes[0].half.z() = 0.2;  // a slab 0.4 m thick
    scene.bodies[0].X_WB.translation().z() = -0.2;
    add_body(scene, free_box("box", 1000, {1, 1, 0.3}, at(0, 0, 40)));
    contact_nn::ContactSettings contact = exact_contact();
    contact.stiffness = 6e9;
    Simulation simulation(scene, contact, tolerance);
    double lowest = 1;
    simulation.run_to(6, 1, [&] { lowest = std::min(lowest, simulation.get("box.position.z")); });
    EXPECT_GT(lowest, 0);
    // Touched after √(2 h / g); the trajectory up to there is a parabola, exact for order two and more, but for the
    // start.
    const auto events = simulation.engine().take_events();
    ASSERT_FALSE(events.empty());
    EXPECT_NEAR(seconds(events[0].time), std::sqrt(2 * (40 - 0.15) / kGravity), 2 * tolerance + 1e-6);
  }
}

// A run that saves goes on as the run that is restored from it later: the same bits, in the same unit and in another
// one.
void expect_the_same_bits_when_restored(const contact_nn::ContactSettings& contact, const std::string& free_bodies = "tree") {
  SolverSettings solver;
  solver.free_bodies = free_bodies;
  Simulation simulation("simbody", landing_scene(), contact, solver);
  simulation.set("hoist.acceleration", 0.5);
  if (free_bodies == "tree") simulation.set("trolley.acceleration", 0.2);  // or the tree would be needed
  simulation.run_to(0.75, 0.01);
  simulation.engine().take_events();
  const UnitState saved = simulation.engine().save();
  const double time = simulation.time();

  simulation.run_to(2, 0.01);  // through the landing
  const std::vector<double> first = outputs(simulation);
  const UnitState first_end = simulation.engine().save();

  simulation.engine().restore(saved);
  simulation.at(time);
  simulation.run_to(2, 0.01);
  EXPECT_EQ(outputs(simulation), first);
  EXPECT_EQ(simulation.engine().save(), first_end);

  Simulation other("simbody", landing_scene(), contact, solver);
  other.run_to(0.3, 0.1);  // somewhere else
  other.engine().restore(saved);
  EXPECT_EQ(other.engine().save(), saved);
  other.at(time);
  other.run_to(2, 0.01);
  EXPECT_EQ(outputs(other), first);
  EXPECT_EQ(other.engine().save(), first_end);
}

TEST(SimbodyUnit, RestoredRunsAreTheSameBits) { expect_the_same_bits_when_restored(exact_contact()); }

TEST(SimbodyUnit, RestoredRunsAreTheSameBitsWithoutTheTree) {
  expect_the_same_bits_when_restored(exact_contact(), "direct");
}

// Newton's and Euler's equations for each body are what the recursion over a tree without branches comes to: the same motion but
// for rounding, which steps at a tolerance of 1e-9 carry to some ten times that. The trolley moves for a while, in the tree, and
// then stands.
TEST(SimbodyUnit, MovesFreeBodiesWithoutTheTreeAsInIt) {
  SolverSettings tree;
  tree.relative_tolerance = 1e-9;
  SolverSettings direct = tree;
  direct.free_bodies = "direct";
  Simulation in_tree("simbody", landing_scene(), exact_contact(), tree);
  Simulation without("simbody", landing_scene(), exact_contact(), direct);
  for (Simulation* simulation : {&in_tree, &without}) land(*simulation, 0.1, 4);
  for (const char* name : {"load.position", "spreader.position"}) {
    EXPECT_LT((without.vector(name) - in_tree.vector(name)).norm(), 1e-7) << name;
  }
  EXPECT_LT(std::abs(without.relative_residual()), 1e-6);
  EXPECT_NEAR(without.get("energy.work_in") / in_tree.get("energy.work_in"), 1, 1e-6);
}

TEST(SimbodyUnit, RestoredRunsAreTheSameBitsWhereFrictionSticks) {
  auto contact = exact_contact();
  contact.friction_law = contact_nn::Friction::bristle;
  expect_the_same_bits_when_restored(contact);

  // What has stuck is part of the state: saved on a slope, where it holds the box, and restored elsewhere.
  Scene scene = corner_landing();
  scene.gravity = {2, 0, -9.6};
  Simulation simulation(scene, contact, 1e-6), other(scene, contact, 1e-6);
  simulation.run_to(4, 0.1);
  ASSERT_LT(simulation.vector("box.velocity").norm(), 1e-4);
  other.engine().restore(simulation.engine().save());
  other.at(4);
  other.run_to(5, 0.1);
  EXPECT_NEAR(other.get("box.position.x"), simulation.get("box.position.x"), 1e-5);  // without it: falls into it by 0.1 mm
  simulation.run_to(5, 0.1);
  EXPECT_EQ(outputs(other), outputs(simulation));
}

TEST(SimbodyUnit, InstancesAreIndependent) {
  Simulation alone(corner_landing(), exact_contact(), 1e-6);
  alone.run_to(0.6, 0.01);
  Simulation a(corner_landing(), exact_contact(), 1e-6);
  Simulation b(landing_scene(), exact_contact(), 1e-6);
  for (int i = 1; i <= 60; ++i) {
    a.run_to(0.01 * i, 0.01);
    b.run_to(0.01 * i, 0.01);
  }
  EXPECT_EQ(outputs(a), outputs(alone));
}

TEST(SimbodyUnit, ResetStartsAgain) {
  Simulation simulation(landing_scene(), exact_contact(), 1e-6);
  const std::vector<double> start = outputs(simulation);
  land(simulation, 0.05, 3.5);
  EXPECT_NE(outputs(simulation), start);
  EngineUnit& engine = simulation.engine();
  engine.reset();
  engine.enter_initialization_mode(0);
  engine.exit_initialization_mode();
  EXPECT_EQ(outputs(simulation), start);
}

// A landed switch ends the step at its time; the unit stands exactly there.
TEST(SimbodyUnit, ReturnsEarlyWhenTheSwitchFlips) {
  Simulation simulation(corner_landing(), exact_contact(), 1e-6);
  EngineUnit& engine = simulation.engine();
  const StepResult result = engine.do_step(0, nanoseconds(1));
  EXPECT_TRUE(result.event);
  EXPECT_LT(result.time, nanoseconds(0.3));
  EXPECT_EQ(simulation.get("landed"), 1);
  const auto events = engine.take_events();
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.back().kind, EventKind::landed);
  EXPECT_EQ(events.back().time, result.time);
  // The force at that time is the threshold, raised by the switch's dead band of 1 %; how steeply it rises within a
  // nanosecond does not matter.
  EXPECT_NEAR(simulation.get("contact.ground.box.force"), 1.01 * 5e4, 0.1 * 5e4);
  EXPECT_THROW(engine.do_step(0, 1), std::invalid_argument);  // not from where the unit is
  EXPECT_EQ(engine.do_step(result.time, 1).time, result.time + 1);
}

// Setting drives to what they do anyway costs nothing: no restart, and not a bit of difference.
TEST(SimbodyUnit, DrivesMayBeSetAtEveryPoint) {
  Simulation once(landing_scene(), exact_contact(), 1e-6), always(landing_scene(), exact_contact(), 1e-6);
  once.set("hoist.acceleration", 0.5);
  once.run_to(0.5, 0.01);
  const double start = always.get("hoist.value");
  for (int i = 0; i < 50; ++i) {
    const double t = 0.01 * i;
    always.set("hoist.value", start + 0.25 * t * t);
    always.set("hoist.rate", 0.5 * t);
    always.set("hoist.acceleration", 0.5);
    always.run_to(0.01 * (i + 1), 0.01);
  }
  EXPECT_EQ(once.vector("load.position"), always.vector("load.position"));
  EXPECT_EQ(once.engine().statistics().steps, always.engine().statistics().steps);
}

// Where an input changes, the integrator has run ahead under the old one; it goes back. A step in the hoist's
// acceleration acts from its time on: the load, on stiff ropes, follows x = ½ a t² from there.
TEST(SimbodyUnit, GoesBackToWhereAnInputChanges) {
  Scene scene;
  scene.drives.push_back({"hoist", "m", "rest length", 0, -1, 1, 0.5});
  Hoist hoist{10, 2.5, 0.8, 1e9};
  hoist.drive = 0;
  hoist.damping_time = 0.01;
  hang_container(scene, hoist);
  Simulation simulation(scene, exact_contact(), 1e-8);
  simulation.run_to(5.123, 5.123);  // at rest: the integrator's steps have grown to seconds
  const double z = simulation.get("load.position.z");
  simulation.set("hoist.acceleration", 0.1);
  simulation.run_to(6.123, 1);
  // Ropes stretch by m a / k = 3 µm less.
  EXPECT_NEAR(simulation.get("load.position.z"), z - 0.05, 1e-5);
  EXPECT_NEAR(simulation.get("load.velocity.z"), -0.1, 1e-5);
}

// What a lock holds when it opens is lost, and in the books.
TEST(SimbodyUnit, BooksWhatAnOpeningLockHeld) {
  Scene scene = landing_scene();
  Simulation simulation(scene, exact_contact(), 1e-8);
  simulation.run_to(4, 1);  // hangs still
  const EnergyLedger before = simulation.engine().energy();
  simulation.set("twistlocks", 0);
  simulation.engine().enter_event_mode();
  simulation.engine().update_discrete_states();
  simulation.engine().enter_step_mode();
  const EnergyLedger after = simulation.engine().energy();
  // Four springs share the load's weight: ½ (m g)² / (4 k), about 112 J.
  const double weight = kContainerMass * kGravity;
  EXPECT_NEAR(after.dissipated - before.dissipated, weight * weight / (8 * 1e8), 0.01);
  EXPECT_NEAR(after.residual(), before.residual(), 1e-6);
}

TEST(SimbodyUnit, FailsInWordsWhenABoxPassesThrough) {
  Scene scene;
  add_body(scene, ground());
  add_body(scene, free_box("bullet", 50000, {1, 1, 1}, at(0, 0, 1)));
  scene.bodies[1].v_WB.z() = -80;
  contact_nn::ContactSettings contact = exact_contact();
  contact.stiffness = 1e6;
  Simulation simulation(scene, contact, 1e-6);
  try {
    simulation.run_to(1, 0.1);
    FAIL() << "went through without a word";
  } catch (const StepFailed& failure) {
    EXPECT_NE(std::string(failure.what()).find("bullet passed through ground"), std::string::npos) << failure.what();
    EXPECT_GT(failure.time, 0);
    EXPECT_LT(failure.time, nanoseconds(0.1));
    EXPECT_TRUE(std::isfinite(simulation.get("bullet.position.z")));
  }
}

TEST(SimbodyUnit, NeverReportsSuccessWithNumbersThatAreNotFinite) {
  Scene scene;
  add_body(scene, free_box("box", 1000, {1, 2, 3}, at(0, 0, 0)));
  scene.bodies[0].w_WB = {1e160, 1e160, 0};  // its square is beyond a double
  Simulation simulation(scene, exact_contact(), 1e-6);
  try {
    simulation.run_to(1, 0.1);
    FAIL() << "went on with infinite accelerations";
  } catch (const StepFailed& failure) {
    EXPECT_NE(std::string(failure.what()).find("not finite"), std::string::npos) << failure.what();
    EXPECT_EQ(failure.time, 0);
  }
  Simulation landing(landing_scene(), exact_contact(), 1e-6);
  EXPECT_THROW(landing.set("hoist.rate", std::nan("")), std::invalid_argument);
  EXPECT_THROW(landing.set("hoist.rate", 1e300), std::invalid_argument);
}

TEST(SimbodyUnit, FailsInWordsWhenARopeIsSpent) {
  Scene scene;
  scene.drives.push_back({"hoist", "m", "rest length", 0, -1, 1, 0.5});
  Hoist hoist{10, 2.5, 0.8, kRopeStiffness};
  hoist.drive = 0;
  hang_container(scene, hoist);
  Simulation simulation(scene, exact_contact(), 1e-6);
  simulation.set("hoist.rate", -1);
  try {
    simulation.run_to(20, 0.1);
    FAIL() << "a rope of negative length";
  } catch (const StepFailed& failure) {
    EXPECT_NE(std::string(failure.what()).find("rope0 is hoisted in to its end"), std::string::npos) << failure.what();
    // 5 cm are too short; the stretch of 23 mm is not rest length.
    EXPECT_NEAR(seconds(failure.time), 9.95 - 0.023, 0.003);
  }
}

TEST(SimbodyUnit, RefusesWhatItsLifeCycleDoesNotAllow) {
  auto engine = make_simbody_engine(landing_scene(), exact_contact(), {});
  EXPECT_THROW(engine->do_step(0, 1), std::logic_error);
  EXPECT_THROW(engine->exit_initialization_mode(), std::logic_error);
  engine->enter_initialization_mode(0);
  EXPECT_THROW(engine->enter_initialization_mode(0), std::logic_error);
  EXPECT_THROW(engine->set(100000, 0), std::invalid_argument);
  EXPECT_THROW(engine->get(100000), std::invalid_argument);
  SolverSettings solver;
  solver.relative_tolerance = 0;
  EXPECT_THROW(make_simbody_engine(landing_scene(), exact_contact(), solver), std::invalid_argument);
}

}  // namespace
}  // namespace quayside::harness
