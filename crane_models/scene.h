// The Scene: everything an engine has to build, as plain data, and nothing that belongs to one engine.
//
// World frame W: x along the quay, y along the boom towards the water, z up. B is the frame of a body, with its
// origin wherever its maker finds handy; its centre of mass is at p_BBcm. Indices refer to the vectors of Scene;
// parents stand before their children. SI units, radians.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "spreader/lock.h"
#include "spreader/rope.h"

namespace quayside::crane_models {

using Pose = Eigen::Isometry3d;

constexpr int kWorld = -1;

// A collision box fixed on a body; G is its centre, axes along its edges.
struct CollisionBox {
  Eigen::Vector3d half;  // half extents [m]
  Pose X_BG = Pose::Identity();
  // Under which contacts are reported; empty: the body's name. Keeps the load's name when the load becomes one body
  // with its spreader.
  std::string name = {};
};

enum class JointType { fixed, slider, hinge, pivot, free };

// How a body moves against its parent: frame F on the parent P and M on the body B coincide at coordinate zero. A
// slider moves along F's x axis [m], a hinge turns about F's z axis [rad], a pivot turns in all directions, a free
// joint does not hold at all.
struct Joint {
  JointType type = JointType::free;
  int parent = kWorld;
  Pose X_PF = Pose::Identity();
  Pose X_BM = Pose::Identity();
  int drive = -1;        // slider, hinge: this drive prescribes the coordinate (value, rate, acceleration)
  double damping = 0;    // hinge, pivot: [N m s/rad], slider: [N s/m]
};

struct Body {
  std::string name;
  double mass = 0;                                          // [kg]; not used for bodies fixed to the world
  Eigen::Vector3d p_BBcm = Eigen::Vector3d::Zero();         // [m]
  Eigen::Matrix3d I_BBcm_B = Eigen::Matrix3d::Identity();   // about the centre of mass, in B [kg m²]
  std::vector<CollisionBox> boxes;
  Joint joint;
  // Start: pose and velocity of B's origin in the world. Free bodies start there; for other joints the coordinate
  // follows from X_WB (or from the drive).
  Pose X_WB = Pose::Identity();
  Eigen::Vector3d v_WB = Eigen::Vector3d::Zero();  // [m/s]
  Eigen::Vector3d w_WB = Eigen::Vector3d::Zero();  // [rad/s]

  bool is_static() const { return joint.type == JointType::fixed && joint.parent == kWorld; }
};

// A coordinate that a motor moves: a driven joint or the rest length of ropes. As an input it has value, rate,
// acceleration and jerk, so that within a step it is known as value + rate τ + ½ acceleration τ² + ⅙ jerk τ³.
struct Drive {
  std::string name;      // "trolley", "hoist"
  std::string unit;      // of the value: "m" or "rad"
  std::string meaning;
  double start = 0;      // value at the start
  double sign = 1;       // a positive speed command changes the value by `sign` × speed (hoisting shortens ropes: −1)
  double max_speed = 0;         // [unit/s]
  double max_acceleration = 0;  // [unit/s²]
  double max_jerk = 0;          // [unit/s³]; 0: the acceleration may jump
  double emergency_stop = 0;    // deceleration of an emergency stop [unit/s²]
  // Limit switches: beyond them the drive trips the machine, as a load limit does [unit].
  double lowest = -std::numeric_limits<double>::infinity(), highest = std::numeric_limits<double>::infinity();
};

struct DriveMotion {
  double value = 0, rate = 0, acceleration = 0, jerk = 0;
  DriveMotion after(double dt) const {
    return {value + dt * (rate + 0.5 * dt * (acceleration + dt / 3 * jerk)),
            rate + dt * (acceleration + 0.5 * dt * jerk), acceleration + dt * jerk, jerk};
  }
};

// Rest length of a rope [m], its rate, acceleration and jerk. `motion_of`: the DriveMotion of a drive by its index.
template <typename MotionOf>
DriveMotion rest_length(const spreader::Rope& rope, const MotionOf& motion_of) {
  DriveMotion length{rope.rest_length};
  for (const spreader::RopeDrive& part : rope.drives) {
    const DriveMotion motion = motion_of(part.drive);
    length.value += part.share * motion.value;
    length.rate += part.share * motion.rate;
    length.acceleration += part.share * motion.acceleration;
    length.jerk += part.share * motion.jerk;
  }
  return length;
}

inline DriveMotion rest_length(const spreader::Rope& rope, const std::vector<DriveMotion>& drives) {
  return rest_length(rope, [&](int drive) -> const DriveMotion& { return drives[drive]; });
}

// A two-state command, such as closing (true) and opening (false) the twistlocks.
struct Command {
  std::string name;
  std::string meaning;
  bool start = false;
};

// Two collision boxes that may meet.
struct ContactPair {
  int body_a, box_a;
  int body_b, box_b;
};

// True while the upward contact force on a group of bodies from all others exceeds a threshold: the "landed" switch.
struct LandedSwitch {
  std::string name;
  std::vector<int> bodies;
  double threshold = 0;  // [N]
};

// What is reported under a name: a frame R fixed on a body, for example the centre of a container's bottom face. It
// survives the merging of bodies by the reduction.
struct ReportedFrame {
  std::string name;
  int body = -1;
  Pose X_BR = Pose::Identity();
};

// Wind that blows alike everywhere. Its drive's rate is the speed of the air (its value the way the air has made), so
// that gusts are ramps like those of any drive. Every box of a body that is not static is pushed at its centre by
// pressure factor × area seen from the wind × (speed of the air less the box's own along it), squared with its sign.
struct Wind {
  int drive = -1;  // −1: no wind
  Eigen::Vector3d direction_W = Eigen::Vector3d::UnitX();  // where to; a unit vector
  double pressure_factor = 0;                              // ½ ρ c_d [kg/m³]
};

// A guard of the machine: when the summed tension of some ropes has stayed above a threshold for a time, it trips, and
// the drives make an emergency stop.
struct LoadLimit {
  std::string name;        // "overload", "snag"
  std::vector<int> ropes;
  double threshold = 0;    // [N]
  double delay = 0;        // [s]
};

struct Scene {
  std::string title;
  Eigen::Vector3d gravity{0, 0, -9.81};  // [m/s²]
  std::vector<Body> bodies;
  std::vector<spreader::Rope> ropes;
  std::vector<spreader::Lock> locks;
  std::vector<Drive> drives;
  std::vector<Command> commands;
  std::vector<ContactPair> pairs;
  std::vector<LandedSwitch> landed_switches;
  Wind wind;
  std::vector<LoadLimit> load_limits;
  std::vector<ReportedFrame> frames;
};

// Contacts are reported per pair of named things, whatever number of boxes they consist of.
struct ContactGroup {
  std::string a, b;        // names as of `contact_name`
  std::vector<int> pairs;  // indices in Scene::pairs
};

// The name under which the contacts of a box are reported.
const std::string& contact_name(const Scene& scene, int body, int box);

// All pairs, grouped by the two names, in the order of their first appearance.
std::vector<ContactGroup> contact_groups(const Scene& scene);

// Rest length at the start [m].
double rest_length_at_start(const Scene& scene, const spreader::Rope& rope);

// Velocity degrees of freedom that an engine integrates (driven joints do not count).
int degrees_of_freedom(const Scene& scene);

// Throws std::invalid_argument, naming body, rope or lock, for indices out of range, masses and sizes that are not
// positive, inertias that no mass distribution has, joints whose parent does not stand before them.
void check(const Scene& scene);

}  // namespace quayside::crane_models
