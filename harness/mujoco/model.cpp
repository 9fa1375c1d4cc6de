#include "harness/mujoco/model.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <mutex>
#include <stdexcept>

#include "harness/mujoco/mjcf.h"

namespace quayside::harness::mujoco {
namespace {

using Vector3Map = Eigen::Map<const Eigen::Vector3d>;
using Matrix3Map = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

constexpr char kFileName[] = "scene.xml";

}  // namespace

ModelPointer compile(const std::string& mjcf) {
  const ProcessHooks hooks;
  static std::mutex parser;  // MuJoCo keeps the last parsed model in one place
  const std::lock_guard<std::mutex> lock(parser);
  const auto vfs = std::make_unique<mjVFS>();
  mj_defaultVFS(vfs.get());
  char error[1000] = "";
  mjModel* model = nullptr;
  std::string warning;
  try {
    guarded([&] {
#if mjVERSION_HEADER >= 310
      mj_addBufferVFS(vfs.get(), kFileName, mjcf.data(), static_cast<int>(mjcf.size()));
#else
      mj_makeEmptyFileVFS(vfs.get(), kFileName, static_cast<int>(mjcf.size()));
      std::memcpy(vfs->filedata[mj_findFileVFS(vfs.get(), kFileName)], mjcf.data(), mjcf.size());
#endif
      model = mj_loadXML(kFileName, vfs.get(), error, sizeof(error));
    });
  } catch (const MujocoError& e) {
    warning = e.what();
  }
  mj_deleteVFS(vfs.get());
  mj_freeLastXML();
  ModelPointer owned(model);
  if (!owned || !warning.empty()) {
    throw std::invalid_argument("MuJoCo refuses the scene: " + (warning.empty() ? std::string(error) : warning));
  }
  return owned;
}

Model::Model(const crane_models::Scene& scene, const std::string& mjcf) : scene_(scene), model_(compile(mjcf)) {
  mjModel* m = model_.get();
  mjData* d = nullptr;
  guarded([&] { d = mj_makeData(m); });
  data_.reset(d);
  for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i) {
    const auto& body = scene.bodies[i];
    bodies_.push_back(mj_name2id(m, mjOBJ_BODY, body.name.c_str()));
    assert(bodies_.back() > 0);
    if (body.joint.drive >= 0) {
      const int joint = m->body_jntadr[bodies_.back()];
      driven_.push_back(
          {body.joint.drive, m->jnt_qposadr[joint], m->jnt_dofadr[joint], m->dof_armature[m->jnt_dofadr[joint]]});
    }
  }
}

void Model::set_start() {
  mj_resetData(model_.get(), data_.get());
  const auto start = start_coordinates(scene_);
  for (std::size_t i = 0; i < start.size(); ++i) {
    if (start[i].position.empty()) continue;
    const int joint = model_->body_jntadr[bodies_[i]];
    std::copy(start[i].position.begin(), start[i].position.end(), data_->qpos + model_->jnt_qposadr[joint]);
    std::copy(start[i].velocity.begin(), start[i].velocity.end(), data_->qvel + model_->jnt_dofadr[joint]);
  }
}

// MuJoCo keeps the velocity of a body as that of the material point that passes the centre of mass of its tree.
Eigen::Vector3d Model::velocity_at(int id, const mjtNum* point) const {
  const Vector3Map w(data_->cvel + 6 * id), v(data_->cvel + 6 * id + 3);
  const Vector3Map centre(data_->subtree_com + 3 * model_->body_rootid[id]);
  return v + w.cross(Vector3Map(point) - centre);
}

void Model::read_motions(std::vector<BodyMotion>& motions) const {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const int id = bodies_[i];
    BodyMotion& motion = motions[i];
    motion.X_WB.translation() = Vector3Map(data_->xpos + 3 * id);
    motion.X_WB.linear() = Matrix3Map(data_->xmat + 9 * id);
    motion.v_WB = velocity_at(id, data_->xpos + 3 * id);
    motion.w_WB = Vector3Map(data_->cvel + 6 * id);
  }
}

void Model::add_forces(const std::vector<BodyForce>& forces, mjtNum* generalized) const {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const int id = bodies_[i];
    const Vector3Map centre(data_->subtree_com + 3 * model_->body_rootid[id]);
    const Vector3Map origin(data_->xpos + 3 * id);
    const Eigen::Vector3d& force = forces[i].f_W;
    const Eigen::Vector3d torque = forces[i].t_W + (origin - centre).cross(force);
    // The last coordinate that moves the body; its own, or that of the nearest ancestor that has one.
    int carrier = id;
    while (carrier > 0 && model_->body_dofnum[carrier] == 0) carrier = model_->body_parentid[carrier];
    if (carrier == 0) continue;
    int dof = model_->body_dofadr[carrier] + model_->body_dofnum[carrier] - 1;
    for (; dof >= 0; dof = model_->dof_parentid[dof]) {
      const mjtNum* axis = data_->cdof + 6 * dof;
      generalized[dof] += Vector3Map(axis).dot(torque) + Vector3Map(axis + 3).dot(force);
    }
  }
}

double Model::kinetic_energy() const {
  double energy = 0;
  for (const int id : bodies_) {
    if (model_->body_mass[id] == 0) continue;
    const Eigen::Vector3d v = velocity_at(id, data_->xipos + 3 * id);
    const Eigen::Vector3d w = Matrix3Map(data_->ximat + 9 * id).transpose() * Vector3Map(data_->cvel + 6 * id);
    energy += 0.5 * model_->body_mass[id] * v.squaredNorm() +
              0.5 * Vector3Map(model_->body_inertia + 3 * id).dot(w.cwiseAbs2());
  }
  return energy;
}

double Model::potential_energy() const {
  double energy = 0;
  for (const int id : bodies_) {
    energy -= model_->body_mass[id] * scene_.gravity.dot(Vector3Map(data_->xipos + 3 * id));
  }
  return energy;
}

double Model::joint_damping_power() const {
  double power = 0;
  for (int i = 0; i < model_->nv; ++i) power += model_->dof_damping[i] * data_->qvel[i] * data_->qvel[i];
  return power;
}

}  // namespace quayside::harness::mujoco
