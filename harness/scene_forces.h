// The forces of a Scene, engine-neutral: ropes, locks, contacts, wind. Called at every evaluation of the right-hand side by
// the Simbody unit and through MuJoCo's passive callback by the same-law unit.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "contact_nn/bristle.h"
#include "contact_nn/contact.h"
#include "crane_models/scene.h"

namespace quayside::harness {

// Pose and velocity of a body's frame B in the world.
struct BodyMotion {
  crane_models::Pose X_WB = crane_models::Pose::Identity();
  Eigen::Vector3d v_WB = Eigen::Vector3d::Zero();  // of B's origin [m/s]
  Eigen::Vector3d w_WB = Eigen::Vector3d::Zero();  // [rad/s]
};

// Force on a body and its torque about B's origin, in the world frame.
struct BodyForce {
  Eigen::Vector3d f_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d t_W = Eigen::Vector3d::Zero();
};

// Per pair of boxes (as in Scene::pairs): force on body b and where.
struct PairLoad {
  contact_nn::ContactForce contact;            // in the frame of box a
  Eigen::Vector3d f_W = Eigen::Vector3d::Zero();   // on body b
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();   // centre of pressure
  Eigen::Vector3d t_W = Eigen::Vector3d::Zero();   // torque on body b about p_W
};

// Everything that a caller may want to know beside the forces; sized once by `SceneForces::make_loads`.
struct SceneLoads {
  std::vector<BodyForce> bodies;                 // total of ropes, locks, contacts and wind per body (no gravity)
  std::vector<spreader::RopeTension> ropes;
  std::vector<PairLoad> pairs;
  double potential_energy = 0;   // ropes, locks, contacts [J]
  double rope_work_in = 0;       // power put in through rest lengths, and by the wind [W]
  double dissipated_power = 0;   // ropes, locks, contacts [W]

  // Contacts stay what they were at the last evaluation: the same forces at the same places in the world, so that momentum is
  // kept all the same.
  bool contacts_held = false;

  // Where friction sticks, one per pair, else none: what the engine says before an evaluation, and d/dt of it after.
  std::vector<contact_nn::Bristle> bristles, bristle_rates;
};

class SceneForces {
 public:
  // The scene must outlive this object.
  // With `bristle` the loads have states that the engine integrates; `contact` then leaves friction to it.
  SceneForces(const crane_models::Scene& scene, std::shared_ptr<const contact_nn::ContactModule> contact,
              std::optional<contact_nn::BristleFriction> bristle = {});

  SceneLoads make_loads() const;

  // `bodies`, `drives`, `locks_closed` have the scene's sizes. Overwrites `loads`. Allocates nothing.
  void evaluate(const std::vector<BodyMotion>& bodies, const std::vector<crane_models::DriveMotion>& drives,
                const std::vector<char>& locks_closed, SceneLoads& loads, contact_nn::ContactCounters& counters) const;

  // Adds the wind's force on every body and returns its power [W]. Part of `evaluate`; for engines with forces of their own.
  double add_wind(const std::vector<BodyMotion>& bodies, const std::vector<crane_models::DriveMotion>& drives,
                  std::vector<BodyForce>& forces) const;

  // Elastic energy that the lock holds now: lost when it opens [J].
  double lock_energy(int lock, const std::vector<BodyMotion>& bodies) const;

  // Signed indicators whose sign changes are events: per rope the stretch (positive: taut), per pair minus the
  // separation of the boxes (positive: touching; a lower bound of the distance where they are far apart), per landed
  // switch the upward force over its threshold minus 1.
  struct Indicators {
    std::vector<double> ropes, pairs, switches;
  };
  void indicators(const std::vector<BodyMotion>& bodies, const std::vector<crane_models::DriveMotion>& drives,
                  const SceneLoads& loads, Indicators& out) const;

  // The longest step [s] after which no pair that is apart now can be deeper than `depth` [m], given the present
  // velocities, and accelerations of all points of moving bodies up to `acceleration` [m/s²]; infinite where no pair is
  // apart. Bodies that a closed lock holds together are left out: their distance is the lock's, which an integrator
  // resolves. `locks_closed`: as for `evaluate`; empty: no lock is closed.
  double time_to_contact(const std::vector<BodyMotion>& bodies, double depth, double acceleration,
                         const std::vector<char>& locks_closed = {}) const;

  const crane_models::Scene& scene() const { return scene_; }

 private:
  // What does not change about a pair of boxes.
  struct Pair {
    int body_a, body_b;
    contact_nn::Box a, b;
    crane_models::Pose X_BGa, X_BGb;  // boxes in their bodies
    double radius_a, radius_b;        // of the spheres about the boxes [m]
    int moving_sides;                 // how many of the bodies are not static
    std::vector<int> locks;           // that may hold the two bodies together
  };
  // A pair with one body in a switch's group, and the sign of its force on the group.
  struct SwitchTerm {
    int pair;
    double sign;
  };

  // A lower bound of the distance [m], where it is positive at little cost.
  static double distance_bound(const Pair& pair, const std::vector<BodyMotion>& bodies);
  crane_models::Pose relative_pose(const Pair& pair, const std::vector<BodyMotion>& bodies) const;
  spreader::RopeTension rope_state(const spreader::Rope& rope, const std::vector<BodyMotion>& bodies,
                                   const std::vector<crane_models::DriveMotion>& drives,
                                   Eigen::Vector3d& direction_W) const;

  void add_rope(std::size_t index, const std::vector<BodyMotion>& bodies,
                const std::vector<crane_models::DriveMotion>& drives, SceneLoads& loads) const;
  void add_lock(const spreader::Lock& lock, const std::vector<BodyMotion>& bodies, SceneLoads& loads) const;
  void add_contact(std::size_t index, const std::vector<BodyMotion>& bodies, SceneLoads& loads,
                   contact_nn::ContactCounters& counters) const;
  void add_held_contact(std::size_t index, const std::vector<BodyMotion>& bodies, SceneLoads& loads) const;

  const crane_models::Scene& scene_;
  std::shared_ptr<const contact_nn::ContactModule> contact_;
  std::optional<contact_nn::BristleFriction> bristle_;
  std::vector<Pair> pairs_;                             // as in Scene::pairs
  std::vector<std::vector<SwitchTerm>> switch_terms_;   // as in Scene::landed_switches
};

}  // namespace quayside::harness
