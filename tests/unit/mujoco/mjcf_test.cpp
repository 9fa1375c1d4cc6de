#include "harness/mujoco/mjcf.h"

#include <gtest/gtest.h>

#include "harness/mujoco/model.h"
#include "tests/unit/mujoco/scenes.h"

namespace quayside::harness::mujoco {
namespace {

using crane_models::Body;
using crane_models::JointType;
using crane_models::Pose;
using crane_models::Scene;

constexpr double kRounding = 1e-12;  // a few roundings of numbers up to 100

Pose random_pose(unsigned seed) {
  std::srand(seed);
  return Eigen::Translation3d(Eigen::Vector3d::Random() * 3) * Eigen::Quaterniond::UnitRandom();
}

// One body per kind of joint, each on the one before, with frames at odd places.
Scene chain() {
  Scene scene;
  scene.drives.push_back({"swing", "rad", "angle of the driven hinge", 0.3, 1, 1, 1});
  const std::pair<JointType, int> joints[] = {{JointType::slider, -1}, {JointType::hinge, 0}, {JointType::fixed, -1},
                                              {JointType::pivot, -1}, {JointType::hinge, -1}};
  Pose X_WP = Pose::Identity();
  unsigned seed = 1;
  for (const auto& [type, drive] : joints) {
    Body body = box_body("link " + std::to_string(seed), 10.0 * seed, {1, 2, 3}, {0, 0, 0});
    body.p_BBcm = {0.1, -0.2, 0.3};
    const int parent = static_cast<int>(scene.bodies.size()) - 1;
    body.joint = {type, parent, random_pose(10 + seed), random_pose(20 + seed), drive, 0};
    Pose X_FM = Pose::Identity();
    if (type == JointType::slider) X_FM.translation().x() = 0.7;
    if (type == JointType::hinge) X_FM.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    if (type == JointType::pivot) X_FM.linear() = random_pose(30 + seed).linear();
    X_WP = X_WP * body.joint.X_PF * X_FM * body.joint.X_BM.inverse();
    body.X_WB = X_WP;
    scene.bodies.push_back(body);
    ++seed;
  }
  return scene;
}

std::vector<BodyMotion> start_motions(const Scene& scene, Model& model) {
  std::vector<BodyMotion> motions(scene.bodies.size());
  model.set_start();
  guarded([&] { mj_forward(model.model(), model.data()); });
  model.read_motions(motions);
  return motions;
}

TEST(Mjcf, BodiesStandWhereTheSceneHasThem) {
  const ProcessHooks hooks;
  Scene scene = chain();
  scene.bodies.push_back(box_body("free one", 5, {1, 1, 1}, {1, 2, 3}));
  scene.bodies.back().X_WB = random_pose(99);
  scene.bodies.push_back(ground());
  Model model(scene, to_mjcf(scene, {}));
  const auto motions = start_motions(scene, model);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    EXPECT_LT((motions[i].X_WB.matrix() - scene.bodies[i].X_WB.matrix()).norm(), kRounding) << scene.bodies[i].name;
  }
}

TEST(Mjcf, VelocitiesAtTheStartAreThoseOfTheScene) {
  const ProcessHooks hooks;
  Scene scene = chain();
  scene.bodies.resize(1);  // the slider
  scene.drives.clear();
  const Eigen::Vector3d axis_W = scene.bodies[0].joint.X_PF.linear().col(0);
  scene.bodies[0].v_WB = 0.4 * axis_W;
  Body pendulum = box_body("pendulum", 5, {1, 1, 1}, {0, 0, 0});
  pendulum.joint = {JointType::pivot, 0, random_pose(7), random_pose(8), -1, 0};
  pendulum.X_WB = scene.bodies[0].X_WB * pendulum.joint.X_PF * pendulum.joint.X_BM.inverse();
  pendulum.w_WB = {0.1, 0.2, -0.3};
  const Eigen::Vector3d p_MB_W = -(pendulum.X_WB.linear() * pendulum.joint.X_BM.translation());
  pendulum.v_WB = scene.bodies[0].v_WB + pendulum.w_WB.cross(p_MB_W);
  scene.bodies.push_back(pendulum);
  Body free = box_body("free", 5, {1, 1, 1}, {1, 2, 3});
  free.X_WB = random_pose(9);
  free.v_WB = {1, 2, 3};
  free.w_WB = {-0.5, 0.4, 0.3};
  scene.bodies.push_back(free);
  Model model(scene, to_mjcf(scene, {}));
  const auto motions = start_motions(scene, model);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    EXPECT_LT((motions[i].v_WB - scene.bodies[i].v_WB).norm(), kRounding) << scene.bodies[i].name;
    EXPECT_LT((motions[i].w_WB - scene.bodies[i].w_WB).norm(), kRounding) << scene.bodies[i].name;
  }
}

TEST(Mjcf, InertiaKeepsItsProducts) {
  const ProcessHooks hooks;
  Scene scene;
  scene.bodies.push_back(box_body("box", 7, {1, 2, 3}, {0, 0, 0}));
  const Eigen::Matrix3d R = random_pose(3).linear();
  const Eigen::Matrix3d I = R * scene.bodies[0].I_BBcm_B * R.transpose();
  scene.bodies[0].I_BBcm_B = I;
  scene.bodies[0].p_BBcm = {0.1, 0.2, 0.3};
  const Model model(scene, to_mjcf(scene, {}));
  const mjModel* m = model.model();
  const int id = model.body_id(0);
  EXPECT_EQ(m->body_mass[id], 7);
  const mjtNum* q = m->body_iquat + 4 * id;
  const Eigen::Matrix3d axes = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  const Eigen::Vector3d moments(m->body_inertia[3 * id], m->body_inertia[3 * id + 1], m->body_inertia[3 * id + 2]);
  EXPECT_LT((axes * moments.asDiagonal() * axes.transpose() - I).norm(), kRounding);
}

// A force on a body does the same power along the coordinates as on the body's own motion.
TEST(Mjcf, GeneralizedForcesDoThePowerOfTheForces) {
  const ProcessHooks hooks;
  Scene scene = chain();
  Model model(scene, to_mjcf(scene, {}));
  model.set_start();
  const int nv = model.model()->nv;
  std::srand(5);
  for (int i = 0; i < nv; ++i) model.data()->qvel[i] = Eigen::internal::random<double>(-1, 1);
  guarded([&] { mj_forward(model.model(), model.data()); });
  std::vector<BodyMotion> motions(scene.bodies.size());
  model.read_motions(motions);
  std::vector<BodyForce> forces(scene.bodies.size());
  double power = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    forces[i] = {Eigen::Vector3d::Random(), Eigen::Vector3d::Random()};
    power += forces[i].f_W.dot(motions[i].v_WB) + forces[i].t_W.dot(motions[i].w_WB);
  }
  std::vector<double> generalized(nv, 0.0);
  model.add_forces(forces, generalized.data());
  double generalized_power = 0;
  for (int i = 0; i < nv; ++i) generalized_power += generalized[i] * model.data()->qvel[i];
  EXPECT_NEAR(generalized_power, power, kRounding * nv);
}

TEST(Mjcf, TheKeyframeIsTheStart) {
  const ProcessHooks hooks;
  Scene scene = chain();
  Model model(scene, to_mjcf(scene, {}));
  model.set_start();
  const mjModel* m = model.model();
  ASSERT_EQ(m->nkey, 1);
  for (int i = 0; i < m->nq; ++i) EXPECT_NEAR(m->key_qpos[i], model.data()->qpos[i], kRounding);
  for (int i = 0; i < m->nv; ++i) EXPECT_NEAR(m->key_qvel[i], model.data()->qvel[i], kRounding);
}

TEST(Mjcf, NativeHasTendonsLocksAndPairs) {
  const ProcessHooks hooks;
  Scene scene = crane(20);
  scene.bodies.push_back(ground());
  scene.bodies.push_back(box_body("box/with <odd> & name", 1000, {1, 1, 1}, {0, 0, 0.5}));
  scene.pairs.push_back({2, 0, 3, 0});
  scene.pairs.push_back({1, 0, 3, 0});
  spreader::Lock lock;
  lock.name = "lock";
  lock.body_a = 1;
  lock.body_b = 3;
  lock.pins = {{{1, 0, 0}, {0, 0, 0}}, {{-1, 0, 0}, {0, 0, 1}}};
  lock.stiffness = 1e6;
  lock.closed = false;
  scene.locks.push_back(lock);

  const ModelPointer native = compile(to_mjcf(scene, {}));
  EXPECT_EQ(native->ntendon, 4);
  EXPECT_EQ(native->neq, 2);
  EXPECT_FALSE(native->eq_active[0]);
  EXPECT_EQ(native->npair, 2);
  // The ground is wide against a box of 1 m; the load and the box are boxes to each other. MuJoCo sorts its pairs.
  EXPECT_EQ((native->geom_type[native->pair_geom1[0]] == mjGEOM_PLANE) +
                (native->geom_type[native->pair_geom1[1]] == mjGEOM_PLANE), 1);

  MjcfOptions options;
  options.native = false;
  const ModelPointer bare = compile(to_mjcf(scene, options));
  EXPECT_EQ(bare->ntendon + bare->neq + bare->npair, 0);
  EXPECT_EQ(bare->nbody, native->nbody);
}

TEST(Mjcf, RefusalsNameTheReason) {
  Scene scene;
  scene.bodies.push_back(box_body("box", -1, {1, 1, 1}, {0, 0, 0}));
  EXPECT_THROW(to_mjcf(scene, {}), std::invalid_argument);
  const ProcessHooks hooks;
  try {
    compile("<mujoco><worldbody><body/></worldbody><nonsense/></mujoco>");
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("nonsense"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace quayside::harness::mujoco
