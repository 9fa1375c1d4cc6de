// A Scene as a Simbody MultibodySystem with the forces of SceneForces: coordinates in, accelerations, loads and
// energies out.
//
// Coordinates y = [q of the joints that move freely, their u], in Simbody's generalized coordinates: quaternion (w, x,
// y, z) and position for free joints, the first four of these for pivots, one value for sliders and hinges; driven
// joints have none, their drive prescribes them. Speeds u of free joints and pivots: angular velocity, then velocity,
// in the parent's frame. The position of a free joint is that of the centre of mass. Where friction sticks, the bristle of every
// pair of boxes follows.
#pragma once

#include <memory>
#include <vector>

#include "harness/scene_forces.h"

namespace quayside::harness {

class MultibodyModel {
 public:
  enum class Quantity { position, angle, quaternion, velocity, angular_velocity, deflection };

  // The scene must outlive this object. `free_bodies_directly`: where nothing moves but bodies that are free, evaluations take
  // Newton's and Euler's equations for each, which are what Simbody's recursion comes to then, in place of its tree.
  MultibodyModel(const crane_models::Scene& scene, std::shared_ptr<const contact_nn::ContactModule> contact,
                 std::optional<contact_nn::BristleFriction> bristle = {}, bool free_bodies_directly = false);
  ~MultibodyModel();

  int size() const { return static_cast<int>(quantities_.size()); }
  const std::vector<Quantity>& quantities() const { return quantities_; }  // of each coordinate
  // Coordinates of bodies that joints connect, or of a bristle.
  const std::vector<std::vector<int>>& blocks() const { return blocks_; }
  const std::vector<int>& quaternions() const { return quaternions_; }     // where in y each begins

  // What the drives do from `reference` on, until told otherwise.
  void set_drive(int drive, double reference, const crane_models::DriveMotion& motion);
  crane_models::DriveMotion drive(int drive, double t) const;
  double drive_reference(int drive) const { return drives_[drive].reference; }
  void set_lock(int lock, bool closed) { locks_closed_[lock] = closed; }
  bool lock_closed(int lock) const { return locks_closed_[lock] != 0; }
  void hold_contacts(bool hold) { loads_.contacts_held = hold; }

  // A rope whose drive has left it no length at t to speak of, so that its stiffness EA / L0 has no meaning; −1: none.
  int spent_rope(double t) const;

  // The scene's start: poses and velocities of its bodies, driven joints where their drives are at t.
  void start(double t, double* y);

  // Moves to (t, y) and evaluates motions, ropes, locks and contacts there. Allocates nothing, nor does `derivative`.
  void evaluate(double t, const double* y);
  // The same, and dy/dt. `y` is read before `y_dot` is written.
  void derivative(double t, const double* y, double* y_dot);

  // ∂(dy/dt)/∂y, column after column, by differences; `y_dot` belongs to (t, y). Bodies that neither touch now nor share
  // a rope, a closed lock or a joint do not feel each other: their columns are taken together, so that the evaluations
  // needed grow with the most neighbours that a body has and not with the number of bodies. Where every body that moves
  // is free, Newton's and Euler's laws stand in for Simbody's tree, which costs more than the forces. Allocates nothing.
  // `speeds` leaves the columns of positions as they are.
  enum class Columns { all, speeds };
  void jacobian(double t, const double* y, const double* y_dot, double* jacobian, Columns columns = Columns::all);

  // At the last evaluation:
  double time() const { return time_; }
  const std::vector<BodyMotion>& motions() const { return motions_; }
  const SceneLoads& loads() const { return loads_; }
  void indicators(SceneForces::Indicators& out) const { forces_.indicators(motions_, drive_now_, loads_, out); }
  double time_to_contact(double depth, double acceleration) const {
    return forces_.time_to_contact(motions_, depth, acceleration, locks_closed_);
  }
  double moving_mass() const { return moving_mass_; }  // of all bodies that are not fixed to the world [kg]
  double moving_weight() const { return moving_mass_ * scene_.gravity.norm(); }  // [N]
  double kinetic_energy() const;
  double potential_energy() const;  // gravity, ropes, locks, contacts
  double work_power() const;        // of rope drives and driven joints; where these move, after `derivative` only
  double dissipated_power() const;  // ropes, locks, contacts, joints
  bool driven_joints_move(double t) const;  // whether any does, so that its drive works

  std::uint64_t evaluations = 0;  // of the forces: calls of `evaluate` and `derivative`, and those for the Jacobian
  contact_nn::ContactCounters contact_counters;

 private:
  struct Simbody;
  struct DriveState {
    double reference = 0;  // [s]
    crane_models::DriveMotion motion;
  };

  // A body that nothing but forces ties to others.
  struct FreeBody {
    int body, block;
    crane_models::Pose X_WF;        // of its joint's fixed frame
    Eigen::Matrix3d inverse_I_B;    // of its inertia about the centre of mass
  };

  int first_bristle() const;  // in y
  void read_bristles(const double* y, SceneLoads& loads) const;
  void find_blocks();
  void find_free_bodies();
  void move_tree(double t, const double* y);
  bool tree_is_there() const;
  void place_free_bodies(const double* y, std::vector<BodyMotion>& motions) const;
  void accelerate_free_bodies(const double* y, const std::vector<BodyMotion>& motions, const SceneLoads& loads, double* y_dot) const;
  void free_derivative(const double* y, double* y_dot);
  void find_coupling();
  void colour_blocks();

  const crane_models::Scene& scene_;
  const bool free_bodies_directly_;
  SceneForces forces_;
  std::vector<Quantity> quantities_;
  std::vector<int> quaternions_;
  std::vector<int> driven_;  // bodies with driven joints
  std::vector<DriveState> drives_;
  std::vector<crane_models::DriveMotion> drive_now_;
  bool tree_moved_ = false;                             // Simbody's, at least once,
  std::vector<crane_models::DriveMotion> tree_drives_;  // and its drives when it was last
  std::vector<char> locks_closed_;
  double moving_mass_ = 0;
  double time_ = 0;
  std::vector<BodyMotion> motions_;
  SceneLoads loads_;
  double joint_dissipation_ = 0;  // [W]

  // Coordinates in blocks: one for each bristle, first, since to eliminate it couples no others than it did; then one for
  // each tree of joints that move freely.
  std::vector<std::vector<int>> blocks_;  // where in y
  std::vector<int> block_of_body_;        // −1: does not move, or as driven
  std::vector<char> coupled_;             // blocks × blocks: whether one now feels the other
  std::vector<int> colours_;              // of blocks; no block feels two of one colour
  int colour_count_ = 0;
  std::vector<FreeBody> free_bodies_;     // of all blocks; none where a block is anything else
  bool direct_now_ = false;                // at the last evaluation
  std::vector<double> y_shifted_, y_dot_shifted_, y_dot_begin_, shifts_;
  std::vector<BodyMotion> motions_shifted_;
  SceneLoads loads_shifted_;
  std::unique_ptr<Simbody> simbody_;
};

}  // namespace quayside::harness
