// The contact module's public face: boxes and poses in, contacts and forces out.
//
// Two questions are kept apart. *Where do two boxes touch?* is the geometry query (`Manifold`); *which force
// follows?* is the law (`ContactForce`). A `ContactModule` answers both for one legal pair of law and model.
//
// Frames: A and B are the centres of the two boxes, axes along their edges. `X_AB` is the pose of B in A;
// a vector with suffix `_A` is expressed in A. SI units.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include <Eigen/Geometry>

namespace quayside::contact_nn {

using Pose = Eigen::Isometry3d;

// A solid box, given by its half extents [m] along its own axes, all positive.
struct Box {
  Eigen::Vector3d half;
};

enum class ContactClass { apart, face_a, face_b, edge_edge };

struct ManifoldPoint {
  Eigen::Vector3d p_A;  // halfway between the two surfaces [m]
  double depth;         // positive when penetrating [m]
};

// The geometry query's answer. `gap` is the largest separation over the 15 axes of the separating-axis test
// [m], negative when the boxes overlap; `n_A` is the unit normal of that axis, pointing from A to B. The
// points share this normal. A pair farther apart than the query's margin has no points.
struct Manifold {
  double gap;
  Eigen::Vector3d n_A;
  ContactClass contact_class;
  int count;
  std::array<ManifoldPoint, 8> points;
};

// Motion of B relative to A, expressed in A: angular velocity [rad/s] and velocity of B's centre [m/s].
// The point of B at p_A moves relative to A at v_A + w_A × (p_A − p_AB).
struct RelativeVelocity {
  Eigen::Vector3d w_A = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_A = Eigen::Vector3d::Zero();
};

// What the law says. Force on B [N] and its torque about A's centre [N m]; A gets exactly the opposite pair
// at the same point, so momentum is kept to the last bit. All zero when the boxes are apart.
struct ContactForce {
  bool touching = false;
  Eigen::Vector3d f_A = Eigen::Vector3d::Zero();
  Eigen::Vector3d t_A = Eigen::Vector3d::Zero();
  Eigen::Vector3d impact_point_A = Eigen::Vector3d::Zero();  // centre of pressure [m]
  double normal_force = 0;      // sum of the pressures, elastic and damping [N]
  double potential_energy = 0;  // stored elastically [J]
  double dissipated_power = 0;  // taken by damping and friction [W], never negative
  // Polar moment of the elastic pressure over its sum, about the force through the impact point [m²]: what friction that
  // sticks needs to know of torsion, and only given for it.
  double pressure_radius2 = 0;
};

// `potential`: p-norm potential over the overlapping surfaces, force and torque its gradient.
// `points`: springs at the points of the manifold, which share the stiffness of the whole.
// `pads`: the same, with the stiffness of a quarter of the whole each, as engines have it that know contacts as points: a
// flat contact on four corners has all of it, one on an edge half (pads_law.h). Closed form, whatever the model.
// `learned`: a network for the potential where it was trained, `potential` elsewhere (learned_potential.h).
enum class Law { potential, points, pads, learned };

// Who finds where the boxes touch: closed form over everything, or a gate network followed by closed form
// on what it names, checked.
enum class Model { exact, committee };

// `regularised`: grows with sliding until it is Coulomb's, a function of pose and motion; creeps under a steady load.
// `bristle`: sticks as a spring up to Coulomb's limit, without creep, and has a state for that (bristle.h). A module made for
// it leaves friction to `BristleFriction`.
enum class Friction { regularised, bristle };

struct ContactSettings {
  Model model = Model::committee;
  Law law = Law::potential;
  double stiffness = 6e8;         // flat contact over the reference area (29.7 m²), K [N/m]
  double restitution = 0.3;       // rebound over approach speed at `reference_speed`, in (0, 1]; 1: elastic
  double reference_speed = 0.5;   // [m/s]
  double friction = 0.4;          // Coulomb coefficient
  Friction friction_law = Friction::regularised;
  double transition_speed = 1e-3; // below it regularised friction grows linearly with sliding [m/s]
  std::string network;            // ONNX file of the gate; empty: the one that ships
};

// Work counted by the caller, since the module keeps no state.
struct ContactCounters {
  std::uint64_t queries = 0;              // pairs asked for
  std::uint64_t network_evaluations = 0;  // forward passes of a gate
  std::uint64_t fallbacks = 0;            // answers taken from the exact path because a check failed
};

// Stateless and free of allocation after construction: safe to share between threads and units.
// Force requirements (all tested): zero when apart; continuous in the pose; with no friction and
// restitution 1 the gradient of `potential_energy`; damping and friction only take energy.
class ContactModule {
 public:
  virtual ~ContactModule() = default;

  // Where the boxes touch. Points are given for gaps up to `margin` [m] (default: touching only).
  virtual Manifold query(const Box& a, const Box& b, const Pose& X_AB, ContactCounters& counters,
                         double margin = 0) const = 0;

  // The contact force for this pose and motion.
  virtual ContactForce force(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                             ContactCounters& counters) const = 0;
};

// Throws std::invalid_argument for values out of range, std::runtime_error for a network file that is
// missing, damaged or of another interface, with what to change.
std::unique_ptr<ContactModule> make_contact_module(const ContactSettings& settings);

// Largest separation over the 15 axes [m]: positive is a lower bound of the distance, negative means overlap.
double separation(const Box& a, const Box& b, const Pose& X_AB);

}  // namespace quayside::contact_nn
