#include "harness/scene_forces.h"

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/scene_forces/allocation_counter.h"

namespace quayside::harness {
namespace {

using crane_models::DriveMotion;
using crane_models::Pose;
using crane_models::Scene;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// A contact module made of a function, to see what is asked and to answer at will.
struct MockContact : contact_nn::ContactModule {
  using Answer = std::function<contact_nn::ContactForce(const Pose& X_AB, const contact_nn::RelativeVelocity& V_AB)>;
  explicit MockContact(Answer answer) : answer(std::move(answer)) {}
  contact_nn::Manifold query(const contact_nn::Box&, const contact_nn::Box&, const Pose&, contact_nn::ContactCounters&,
                             double) const override {
    return {};
  }
  contact_nn::ContactForce force(const contact_nn::Box&, const contact_nn::Box&, const Pose& X_AB,
                                 const contact_nn::RelativeVelocity& V_AB,
                                 contact_nn::ContactCounters& counters) const override {
    ++counters.queries;
    return answer(X_AB, V_AB);
  }
  Answer answer;
};

std::shared_ptr<MockContact> no_contact() {
  return std::make_shared<MockContact>([](const auto&, const auto&) { return contact_nn::ContactForce{}; });
}

std::shared_ptr<const contact_nn::ContactModule> exact_contact() {
  contact_nn::ContactSettings settings;
  settings.model = contact_nn::Model::exact;
  return contact_nn::make_contact_module(settings);
}

Pose pose(const Vector3d& p, const Quaterniond& q = Quaterniond::Identity()) {
  Pose X = Pose::Identity();
  X.translate(p).rotate(q);
  return X;
}

crane_models::Body box(const std::string& name, const Vector3d& half) {
  crane_models::Body body;
  body.name = name;
  body.mass = 1000;
  crane_models::CollisionBox shape;
  shape.half = half;
  shape.X_BG = pose({0.1, -0.2, 0.3}, Quaterniond(Eigen::AngleAxisd(0.02, Vector3d(1, 2, 3).normalized())));
  body.boxes = {shape};
  return body;
}

// A beam on two ropes from a driven trolley and from the world, a box locked under it and a box in contact with that.
Scene hanging_scene() {
  Scene scene;
  scene.drives = {{"hoist", "m", "", 9.95, -1, 1, 1}};
  scene.bodies = {box("trolley", {1, 1, 0.2}), box("beam", {6, 1, 0.3}), box("load", {6, 1, 1}),
                  box("stack", {6, 1, 1})};
  const auto rope = [&](const char* name, spreader::Attachment upper, spreader::Attachment lower, int drive) {
    spreader::Rope r;
    r.name = name;
    r.upper = upper;
    r.lower = lower;
    r.axial_stiffness = 84e6;
    r.damping_time = 0.01;
    if (drive >= 0) r.drives = {{drive}};
    r.rest_length = drive < 0 ? 9.9 : 0.01;
    return r;
  };
  scene.ropes = {rope("left", {0, {-3, 0.4, 0}}, {1, {-3, 0.3, 0.3}}, 0),
                 rope("right", {crane_models::kWorld, {3, 0, 10}}, {1, {3, 0.3, 0.3}}, -1)};
  spreader::Lock lock;
  lock.name = "locks";
  lock.body_a = 1;
  lock.body_b = 2;
  lock.pins = {{{-5, 1, -0.3}, {-5, 1, 1}}, {{5, 1, -0.3}, {5, 1, 1}}, {{5, -1, -0.3}, {5, -1, 1}}};
  lock.stiffness = 1e8;
  lock.damping = 1e5;
  scene.locks = {lock};
  scene.pairs = {{2, 0, 3, 0}, {1, 0, 2, 0}};
  scene.landed_switches = {{"landed", {1, 2}, 1000}};
  return scene;
}

// A motion of each body with known derivatives: p = p0 + v t, turning at a constant rate about a fixed axis.
struct Motion {
  Vector3d p0, v, w;
  Quaterniond q0;
  BodyMotion at(double t) const {
    const double angle = w.norm() * t;
    const Vector3d axis = w.norm() > 0 ? Vector3d(w.normalized()) : Vector3d::UnitX();
    return {pose(p0 + v * t, Quaterniond(Eigen::AngleAxisd(angle, axis)) * q0), v, w};
  }
};

struct Trial {
  std::vector<Motion> motions;
  DriveMotion hoist;
  std::vector<BodyMotion> at(double t) const {
    std::vector<BodyMotion> bodies;
    for (const Motion& m : motions) bodies.push_back(m.at(t));
    return bodies;
  }
};

// Near the rest of `hanging_scene`: ropes stretched by about 5 cm, locks by millimetres, the boxes overlap by
// millimetres.
Trial random_trial(std::mt19937& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  const auto vector = [&](double scale) { return Vector3d(scale * u(random), scale * u(random), scale * u(random)); };
  Trial trial;
  for (const double z : {10.0, -0.3, -1.6, -3.595}) {
    const Vector3d tilt = vector(5e-4);
    trial.motions.push_back({Vector3d(0, 0, z) + vector(2e-3), vector(0.5), vector(0.1),
                             Quaterniond(Eigen::AngleAxisd(tilt.norm(), tilt.normalized()))});
  }
  trial.hoist = {9.94 + 1e-3 * u(random), u(random), 0};
  return trial;
}

TEST(SceneForces, KeepMomentum) {
  // Without the rope that hangs on the world all forces are internal: their sum and their moment about the world's
  // origin vanish. Forces reach 1e6 N at arms of 10 m: rounding is some 1e-16·1e7 per term.
  Scene scene = hanging_scene();
  scene.ropes.pop_back();
  const SceneForces forces(scene, exact_contact());
  SceneLoads loads = forces.make_loads();
  contact_nn::ContactCounters counters;
  std::mt19937 random(3);
  int touching = 0;
  for (int i = 0; i < 1000; ++i) {
    const Trial trial = random_trial(random);
    const auto bodies = trial.at(0);
    forces.evaluate(bodies, {trial.hoist}, {1}, loads, counters);
    Vector3d f = Vector3d::Zero(), t = Vector3d::Zero();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      f += loads.bodies[b].f_W;
      t += loads.bodies[b].t_W + bodies[b].X_WB.translation().cross(loads.bodies[b].f_W);
    }
    EXPECT_LT(f.norm(), 1e-8);
    EXPECT_LT(t.norm(), 1e-7);
    touching += loads.pairs[0].contact.touching;
  }
  EXPECT_GT(touching, 300);  // the trial would be empty without contacts
}

// Without and with friction that sticks, whose bristles have gone on at their rates in the meantime.
void expect_balanced_power(const contact_nn::ContactSettings& contact) {
  // Power of the forces on the bodies = −dU/dt − dissipated + work_in, for arbitrary motion. dU/dt by central differences
  // over ±h = 2 µs: contacts and locks of millimetres change within T = 1 ms at 1 m/s, so that the error is of order
  // (h/T)² = 4e-6 of the power. A missing or wrong term is of the order of the power itself.
  const Scene scene = hanging_scene();
  const SceneForces forces(scene, contact_nn::make_contact_module(contact), contact_nn::bristle_friction(contact));
  SceneLoads loads = forces.make_loads();
  contact_nn::ContactCounters counters;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> deflection(-3e-4, 3e-4);
  const double h = 2e-6;
  double worst = 0;
  for (int i = 0; i < 1000; ++i) {
    const Trial trial = random_trial(random);
    for (contact_nn::Bristle& z : loads.bristles) {
      for (double& component : z) component = deflection(random);
    }
    forces.evaluate(trial.at(0), {trial.hoist}, {1}, loads, counters);
    const auto bristles = loads.bristles, rates = loads.bristle_rates;
    const auto energy = [&](double t) {
      for (std::size_t k = 0; k < bristles.size(); ++k) loads.bristles[k] = bristles[k] + t * rates[k];
      forces.evaluate(trial.at(t), {trial.hoist.after(t)}, {1}, loads, counters);
      return loads.potential_energy;
    };
    const double energy_rate = (energy(h) - energy(-h)) / (2 * h);
    const auto bodies = trial.at(0);
    loads.bristles = bristles;
    forces.evaluate(bodies, {trial.hoist}, {1}, loads, counters);
    double power = 0, scale = 1e4;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      power += loads.bodies[b].f_W.dot(bodies[b].v_WB) + loads.bodies[b].t_W.dot(bodies[b].w_WB);
      scale += loads.bodies[b].f_W.norm() * bodies[b].v_WB.norm();
    }
    const double error = power + energy_rate + loads.dissipated_power - loads.rope_work_in;
    EXPECT_LT(std::abs(error), 1e-5 * scale) << "trial " << i;
    EXPECT_GE(loads.dissipated_power, 0);
    worst = std::max(worst, std::abs(error) / scale);
  }
  testing::Test::RecordProperty("worst_relative_error", std::to_string(worst));
}

TEST(SceneForces, BalanceTheirPower) {
  contact_nn::ContactSettings contact;
  contact.model = contact_nn::Model::exact;
  expect_balanced_power(contact);
  contact.friction_law = contact_nn::Friction::bristle;
  expect_balanced_power(contact);
}

TEST(SceneForces, AskForTheMotionSeenFromBoxA) {
  // The module is told X_AB and how the material points of B move against those of A. The rate of X_AB itself, by
  // central differences, must be that velocity: d/dt p_AB = v_A, since A's frame turns with A.
  Scene scene = hanging_scene();
  scene.pairs.resize(1);
  Pose X_AB;
  contact_nn::RelativeVelocity V_AB;
  const auto record = std::make_shared<MockContact>([&](const Pose& X, const contact_nn::RelativeVelocity& V) {
    X_AB = X;
    V_AB = V;
    return contact_nn::ContactForce{};
  });
  const SceneForces forces(scene, record);
  SceneLoads loads = forces.make_loads();
  contact_nn::ContactCounters counters;
  std::mt19937 random(5);
  const double h = 1e-4;
  for (int i = 0; i < 100; ++i) {
    const Trial trial = random_trial(random);
    const auto pose_at = [&](double t) {
      forces.evaluate(trial.at(t), {trial.hoist}, {0}, loads, counters);
      return X_AB;
    };
    const Pose before = pose_at(-h), after = pose_at(h), now = pose_at(0);
    const Vector3d rate = (after.translation() - before.translation()) / (2 * h);
    EXPECT_LT((rate - V_AB.v_A).norm(), 1e-8);  // h² v w² ~ 1e-10, rounding 1e-15/h ~ 1e-11
    const Eigen::Matrix3d spin = (after.linear() - before.linear()) / (2 * h) * now.linear().transpose();
    EXPECT_LT((Vector3d(spin(2, 1), spin(0, 2), spin(1, 0)) - V_AB.w_A).norm(), 1e-8);
  }
  EXPECT_GT(counters.queries, 0u);
}

TEST(SceneForces, ContactPushesBothAtTheSamePoint) {
  Scene scene = hanging_scene();
  scene.pairs.resize(1);
  scene.ropes.clear();
  scene.locks.clear();
  contact_nn::ContactForce answer;
  answer.touching = true;
  answer.f_A = {0, 0, -2000};
  answer.impact_point_A = {1, 0.5, -1};
  answer.t_A = answer.impact_point_A.cross(answer.f_A);
  const SceneForces forces(scene, std::make_shared<MockContact>([&](const auto&, const auto&) { return answer; }));
  SceneLoads loads = forces.make_loads();
  contact_nn::ContactCounters counters;
  // A turned by 90° about z: A's x axis points along the world's y.
  std::vector<BodyMotion> bodies(4);
  bodies[2].X_WB = pose({10, 0, 5}, Quaterniond(Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitZ())));
  bodies[3].X_WB = pose({10, 0, 3.1});
  forces.evaluate(bodies, {DriveMotion{}}, {}, loads, counters);
  const Pose X_WG = bodies[2].X_WB * scene.bodies[2].boxes[0].X_BG;
  const Vector3d f_W = X_WG.linear() * answer.f_A;
  const Vector3d p_W = X_WG * answer.impact_point_A;
  EXPECT_LT((loads.pairs[0].f_W - f_W).norm(), 1e-9);
  EXPECT_LT((loads.pairs[0].p_W - p_W).norm(), 1e-12);
  EXPECT_LT((loads.bodies[3].t_W - (p_W - Vector3d(10, 0, 3.1)).cross(f_W)).norm(), 1e-8);
  EXPECT_LT((loads.bodies[2].t_W + (p_W - Vector3d(10, 0, 5)).cross(f_W)).norm(), 1e-8);

  // The load is pushed up by 2000 N (but for the 0.02 rad that its box is turned): twice the threshold of the switch.
  SceneForces::Indicators indicators;
  forces.indicators(bodies, {DriveMotion{}}, loads, indicators);
  EXPECT_NEAR(indicators.switches[0], 1, 1e-3);
}

TEST(SceneForces, CullOnlyWhatIsApart) {
  // Random poses at distances about the sizes: whatever is not asked of the module is apart by the separating-axis
  // test.
  Scene scene = hanging_scene();
  scene.pairs.resize(1);
  bool asked = false;
  const auto mock = std::make_shared<MockContact>([&](const auto&, const auto&) {
    asked = true;
    return contact_nn::ContactForce{};
  });
  const SceneForces forces(scene, mock);
  SceneLoads loads = forces.make_loads();
  contact_nn::ContactCounters counters;
  SceneForces::Indicators indicators;
  std::mt19937 random(6);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<BodyMotion> bodies(4);
  int culled = 0, overlapping = 0;
  for (int i = 0; i < 20000; ++i) {
    for (int b : {2, 3}) {
      bodies[b].X_WB = pose(Vector3d(5 * u(random), 5 * u(random), 5 * u(random)),
                            Quaterniond(u(random), u(random), u(random), u(random)).normalized());
    }
    asked = false;
    forces.evaluate(bodies, {{10, 0, 0}}, {0}, loads, counters);
    forces.indicators(bodies, {{10, 0, 0}}, loads, indicators);
    const Pose X_WA = bodies[2].X_WB * scene.bodies[2].boxes[0].X_BG;
    const Pose X_WB = bodies[3].X_WB * scene.bodies[3].boxes[0].X_BG;
    const double gap = contact_nn::separation({{6, 1, 1}}, {{6, 1, 1}}, X_WA.inverse() * X_WB);
    EXPECT_TRUE(asked || gap > 0);
    EXPECT_EQ(indicators.pairs[0] > 0, gap < 0);
    culled += !asked;
    overlapping += gap < 0;
  }
  EXPECT_GT(culled, 1000);
  EXPECT_GT(overlapping, 1000);
}

TEST(SceneForces, KnowWhenAContactCanComeAtTheEarliest) {
  // Two boxes 1 m apart face to face, closing at 2 m/s: without acceleration they are 1 mm deep after 1.001 m / 2 m/s.
  // With up to 10 m/s² on both sides 1.001 = 2 t + 10 t².
  Scene scene = hanging_scene();
  for (auto& body : scene.bodies) body.boxes[0].X_BG = Pose::Identity();
  scene.pairs.resize(1);
  const SceneForces forces(scene, no_contact());
  std::vector<BodyMotion> bodies(4);
  bodies[2].X_WB = pose({0, 0, 3});
  bodies[2].v_WB = {0, 0, -1.5};
  bodies[3].v_WB = {0, 0, 0.5};
  EXPECT_NEAR(forces.time_to_contact(bodies, 1e-3, 0), 1.001 / 2, 1e-12);
  EXPECT_NEAR(forces.time_to_contact(bodies, 1e-3, 10), (-2 + std::sqrt(4 + 4 * 10 * 1.001)) / 20, 1e-12);
  // Parting at 2 m/s it takes acceleration to meet: 1.001 = −2 t + 10 t². Without it they never do.
  bodies[2].v_WB = {0, 0, 2.5};
  EXPECT_NEAR(forces.time_to_contact(bodies, 1e-3, 10), (2 + std::sqrt(4 + 4 * 10 * 1.001)) / 20, 1e-12);
  EXPECT_EQ(forces.time_to_contact(bodies, 1e-3, 0), std::numeric_limits<double>::infinity());
  // Turning at 0.1 rad/s about y alone, the end of the 12 m box comes down at 0.6 m/s.
  bodies[2].v_WB = bodies[3].v_WB = Vector3d::Zero();
  bodies[2].w_WB = {0, 0.1, 0};
  EXPECT_NEAR(forces.time_to_contact(bodies, 1e-3, 0), 1.001 / 0.6, 1e-12);
}

TEST(SceneForces, NeverStepDeeperThanPromised) {
  // Random straight motions: after the promised time the boxes are no deeper than the depth. The points of a body that
  // turns at w accelerate at w²r, below 2.1 m/s² at 0.5 rad/s and 8.3 m.
  Scene scene = hanging_scene();
  scene.pairs.resize(1);
  const SceneForces forces(scene, no_contact());
  SceneForces::Indicators indicators;
  SceneLoads loads = forces.make_loads();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  int close = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto vector = [&](double s) { return Vector3d(s * u(random), s * u(random), s * u(random)); };
    Trial trial;
    for (int b = 0; b < 4; ++b) {
      trial.motions.push_back({vector(6), vector(3), vector(0.28),
                               Quaterniond(u(random), u(random), u(random), u(random)).normalized()});
    }
    const double t = forces.time_to_contact(trial.at(0), 1e-3, 2.1);
    if (t == std::numeric_limits<double>::infinity()) continue;
    ASSERT_GT(t, 0);
    forces.indicators(trial.at(t), {{10, 0, 0}}, loads, indicators);
    EXPECT_LE(indicators.pairs[0], 1e-3 + 1e-12);
    close += indicators.pairs[0] > -0.1;
  }
  EXPECT_GT(close, 100);  // the bound is not idle
}

TEST(SceneForces, LeaveOutWhatALockHoldsWhenBoundingTheStep) {
  Scene scene = hanging_scene();
  scene.pairs = {{1, 0, 2, 0}};
  const SceneForces forces(scene, no_contact());
  std::vector<BodyMotion> bodies(4);
  bodies[1].X_WB = pose({0, 0, 3});
  bodies[1].v_WB = {0, 0, -1};
  EXPECT_LT(forces.time_to_contact(bodies, 1e-3, 10, {0}), 10);
  EXPECT_EQ(forces.time_to_contact(bodies, 1e-3, 10, {1}), std::numeric_limits<double>::infinity());
}

TEST(SceneForces, OpenLocksDoNothingAndTheirEnergyIsKnown) {
  Scene scene = hanging_scene();
  scene.ropes.clear();
  scene.pairs.clear();
  scene.landed_switches.clear();
  const SceneForces forces(scene, no_contact());
  SceneLoads loads = forces.make_loads();
  contact_nn::ContactCounters counters;
  std::mt19937 random(8);
  const auto bodies = random_trial(random).at(0);
  forces.evaluate(bodies, {DriveMotion{}}, {1}, loads, counters);
  EXPECT_GT(loads.potential_energy, 0);
  EXPECT_DOUBLE_EQ(forces.lock_energy(0, bodies), loads.potential_energy);
  forces.evaluate(bodies, {DriveMotion{}}, {0}, loads, counters);
  EXPECT_EQ(loads.potential_energy, 0);
  EXPECT_EQ(loads.bodies[2].f_W, Vector3d::Zero());
}

TEST(SceneForces, EvaluateAllocatesNothing) {
  const Scene scene = hanging_scene();
  const SceneForces forces(scene, exact_contact(), contact_nn::BristleFriction({}));
  SceneLoads loads = forces.make_loads();
  SceneForces::Indicators indicators;
  contact_nn::ContactCounters counters;
  std::mt19937 random(9);
  const Trial trial = random_trial(random);
  const auto bodies = trial.at(0);
  const std::vector<DriveMotion> drives{trial.hoist};
  const std::vector<char> closed{1};
  forces.indicators(bodies, drives, loads, indicators);  // sizes its output
  const std::size_t before = allocation_count();
  forces.evaluate(bodies, drives, closed, loads, counters);
  forces.indicators(bodies, drives, loads, indicators);
  forces.time_to_contact(bodies, 1e-3, 10, closed);
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace quayside::harness
