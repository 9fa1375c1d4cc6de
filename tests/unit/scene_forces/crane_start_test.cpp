// The crane's start is a static equilibrium, and the reduced scene has the forces of the full one.
#include <cmath>

#include <gtest/gtest.h>

#include "crane_models/load_bodies.h"
#include "crane_models/rope_crane.h"
#include "crane_models/reduction.h"
#include "harness/scene_forces.h"

namespace quayside::harness {
namespace {

using crane_models::Pose;
using crane_models::Scene;
using Eigen::Vector3d;

constexpr double kG = 9.81;

std::shared_ptr<const contact_nn::ContactModule> exact_contact() {
  contact_nn::ContactSettings settings;
  settings.model = contact_nn::Model::exact;
  return contact_nn::make_contact_module(settings);
}

Scene skewed_crane() {
  Scene scene;
  crane_models::RopeCrane crane = crane_models::quayside_crane();
  crane.trolley_position = 20;
  crane.trolley_height = 32;
  crane.rope_length = 20;
  crane.anchor_skew = 2 * EIGEN_PI / 180;
  crane.load_side.loads = {{"load", 30480}};
  crane_models::add_rope_crane(crane, scene);
  scene.pairs = {{1, 0, 2, 0}};
  return scene;
}

std::vector<BodyMotion> start_of(const Scene& scene) {
  std::vector<BodyMotion> bodies;
  for (const auto& body : scene.bodies) bodies.push_back({body.X_WB, body.v_WB, body.w_WB});
  return bodies;
}

std::vector<crane_models::DriveMotion> drives_of(const Scene& scene) {
  std::vector<crane_models::DriveMotion> drives;
  for (const auto& drive : scene.drives) drives.push_back({drive.start, 0, 0});
  return drives;
}

SceneLoads loads_of(const Scene& scene, const std::vector<BodyMotion>& bodies) {
  const SceneForces forces(scene, exact_contact());
  SceneLoads loads = forces.make_loads();
  contact_nn::ContactCounters counters;
  const std::vector<char> closed(scene.locks.size(), 1);
  forces.evaluate(bodies, drives_of(scene), closed, loads, counters);
  return loads;
}

// Torque about the centre of mass.
Vector3d central_torque(const Scene& scene, int body, const BodyMotion& motion, const BodyForce& force) {
  return force.t_W - (motion.X_WB.linear() * scene.bodies[body].p_BBcm).cross(force.f_W);
}

TEST(CraneStart, IsAnEquilibrium) {
  const Scene scene = skewed_crane();
  const auto bodies = start_of(scene);
  const SceneLoads loads = loads_of(scene, bodies);
  EXPECT_FALSE(loads.pairs[0].contact.touching);
  for (const int body : {1, 2}) {
    const Vector3d weight = scene.bodies[body].mass * kG * Vector3d::UnitZ();
    EXPECT_LT((loads.bodies[body].f_W - weight).norm(), 1e-9 * weight.norm()) << scene.bodies[body].name;
    EXPECT_LT(central_torque(scene, body, bodies[body], loads.bodies[body]).norm(), 1e-9 * weight.norm());
  }
  for (const auto& rope : loads.ropes) EXPECT_GT(rope.tension, 0);
}

TEST(CraneStart, TurnsBackAsAQuadrifilarPendulum) {
  // T = 2π √(I h / (m g (x_t x_b + y_t y_b))) holds for similar rectangles: against a small yaw φ the slanted ropes
  // turn back with m g (x_t x_b + y_t y_b) φ / h. Ours are not similar: each rope pulls with a moment of T/l times
  // ± c = ± (x_b y_t − y_b x_t), which cancel until the yaw stretches two ropes by c φ / l and relieves the others.
  // With d(T/l)/dl = k L0/l² that adds 4 k L0 c² φ / l³. What is left is of order φ², 1e-8.
  const Scene scene = skewed_crane();
  auto bodies = start_of(scene);
  const double yaw = 1e-4;
  const Eigen::AngleAxisd turn(yaw, Vector3d::UnitZ());
  for (const int body : {1, 2}) bodies[body].X_WB.linear() = turn * bodies[body].X_WB.linear();
  const SceneLoads loads = loads_of(scene, bodies);
  const double h = bodies[0].X_WB.translation().z() - (bodies[1].X_WB.translation().z() + 1.1);
  const double mass = scene.bodies[1].mass + scene.bodies[2].mass;
  const double c = (5.55 * 1.30 - 0.80 * 5.78) / 4, k_L0 = 84e6;
  const double l = std::sqrt(h * h + (std::pow(5.78 - 5.55, 2) + std::pow(1.30 - 0.80, 2)) / 4);
  const double expected = (mass * kG * (5.78 * 5.55 + 1.30 * 0.80) / 4 / h + 4 * k_L0 * c * c / (l * l * l)) * yaw;
  EXPECT_NEAR(loads.bodies[1].t_W.z() + loads.bodies[2].t_W.z(), -expected, 1e-6 * expected);
}

TEST(ReducedScene, HasTheForcesOfTheFullOne) {
  // The load lies askew on a box, spreader and load move as one rigid body: the locks' inner forces cancel, and what
  // ropes and contacts do to both together is what they do to the merged body.
  Scene full = skewed_crane();
  auto box = crane_models::box_body("box", {3, 2, 1}, 5000);
  box.X_WB.translation() = full.bodies[2].X_WB.translation() + Vector3d(4, 0.3, -0.5 - 1.2955 + 2e-3);
  full.bodies.push_back(box);
  full.pairs = {{1, 0, 2, 0}, {1, 0, 3, 0}, {2, 0, 3, 0}};
  crane_models::ReductionReport report;
  const Scene reduced = crane_models::reduce(full, {{true, true}, {false}}, report);

  auto in_full = start_of(full);
  const Vector3d v(0.1, -0.2, -0.3), w(0.01, -0.02, 0.05);
  for (const int body : {1, 2}) {
    in_full[body].w_WB = w;
    in_full[body].v_WB = v + w.cross(in_full[body].X_WB.translation());
  }
  const std::vector<BodyMotion> in_reduced{in_full[0], in_full[1], in_full[3]};
  const SceneLoads a = loads_of(full, in_full), b = loads_of(reduced, in_reduced);

  ASSERT_TRUE(a.pairs[2].contact.touching);
  const Vector3d arm = in_full[2].X_WB.translation() - in_full[1].X_WB.translation();
  const Vector3d f = a.bodies[1].f_W + a.bodies[2].f_W;
  const Vector3d t = a.bodies[1].t_W + a.bodies[2].t_W + arm.cross(a.bodies[2].f_W);
  // The contact's stiffness turns rounding of the pose, 1e-14 m, into 1e-5 N.
  EXPECT_LT((b.bodies[1].f_W - f).norm(), 1e-4);
  EXPECT_LT((b.bodies[1].t_W - t).norm(), 1e-3);
  EXPECT_LT((b.bodies[2].f_W - a.bodies[3].f_W).norm(), 1e-4);
  EXPECT_GT(a.bodies[3].f_W.norm(), 1e4);
}

}  // namespace
}  // namespace quayside::harness
