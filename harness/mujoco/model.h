// MuJoCo's model and data of a Scene, and the way between its coordinates and our bodies.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>

#include "crane_models/scene.h"
#include "harness/mujoco/guard.h"
#include "harness/scene_forces.h"

namespace quayside::harness::mujoco {

struct ModelDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DataDeleter {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using ModelPointer = std::unique_ptr<mjModel, ModelDeleter>;
using DataPointer = std::unique_ptr<mjData, DataDeleter>;

// Throws std::invalid_argument with MuJoCo's message.
ModelPointer compile(const std::string& mjcf);

class Model {
 public:
  // The scene must outlive this object; a ProcessHooks must live.
  Model(const crane_models::Scene& scene, const std::string& mjcf);

  mjModel* model() const { return model_.get(); }
  mjData* data() const { return data_.get(); }
  int body_id(int body) const { return body < 0 ? 0 : bodies_[body]; }

  // A joint that a drive moves.
  struct DrivenJoint {
    int drive;        // in the scene
    int qpos, dof;    // addresses
    double armature;  // [kg or kg m²]
  };
  const std::vector<DrivenJoint>& driven_joints() const { return driven_; }

  void set_start();

  // Poses and velocities as of the last position and velocity stage.
  void read_motions(std::vector<BodyMotion>& motions) const;
  // Adds what the forces on the bodies do along each coordinate.
  void add_forces(const std::vector<BodyForce>& forces, mjtNum* generalized) const;

  // As of the last position and velocity stage; potential: of gravity, zero at the world's origin.
  double kinetic_energy() const;
  double potential_energy() const;
  double joint_damping_power() const;  // [W], not negative

 private:
  Eigen::Vector3d velocity_at(int id, const mjtNum* point) const;

  const crane_models::Scene& scene_;
  ModelPointer model_;
  DataPointer data_;
  std::vector<int> bodies_;
  std::vector<DrivenJoint> driven_;
};

}  // namespace quayside::harness::mujoco
