// A Scene as MJCF, MuJoCo's XML. The text can be opened in MuJoCo's viewer; its keyframe "start" is the scene's start.
//
//   body            body with its inertial frame along the principal axes; a body fixed to the world has no mass
//   slider, hinge   slide, hinge; pivot: ball; free: freejoint
//   driven joint    the same with an armature so large that nothing but the drive moves it (see `drive_armature`)
//   collision box   geom "<body>.<index>"; beside it a plane "<body>.<index>.top" where that stands for it in contacts
//                   (native: boxes of one size differ by 0.1 mm, see contact_half in mjcf.cpp)
//   rope            spatial tendon "<rope>" between two sites, its length limited to the rest length   (native only)
//   lock            one connect constraint "<lock>.<pin>" per pin                                      (native only)
//   contact pair    one or more <pair>s                                                                (native only)
#pragma once

#include <string>
#include <vector>

#include "crane_models/scene.h"

namespace quayside::harness::mujoco {

// MuJoCo's "direct" solref, without its signs: what stiffness and damping become in front of an inverse mass A.
struct SolverReference {
  double stiffness = 0;  // K·A·(1 − d) [1/s²]
  double damping = 0;    // C·A·(1 − d) [1/s]
};

// Constant impedance d: the smallest that MuJoCo takes. A constraint with it is a spring and a damper that add the mass
// d/A to what they hold.
constexpr double kImpedance = 1e-4;

struct MjcfOptions {
  bool native = true;   // tendons, locks and contacts of MuJoCo's own; false: the bodies and joints alone
  double step = 1e-3;   // [s]
  double friction = 0;  // Coulomb coefficient
  double impratio = 1;  // MuJoCo's ratio of friction to normal impedance
  // Per rope, lock and contact pair of the scene; empty: MuJoCo's default softness.
  std::vector<SolverReference> ropes, locks, pairs;
};

// Throws std::invalid_argument for a scene that `crane_models::check` refuses.
std::string to_mjcf(const crane_models::Scene& scene, const MjcfOptions& options);

// Coordinates of a body's joint at the start, in MuJoCo's order: a free joint has position, quaternion (w, x, y, z) and
// linear velocity in the world, angular velocity in B; a pivot quaternion and angular velocity in B.
struct StartCoordinates {
  std::vector<double> position, velocity;
};
std::vector<StartCoordinates> start_coordinates(const crane_models::Scene& scene);

// Inertia added to a driven joint [kg or kg m²]. With it and the force armature × acceleration the joint follows its
// drive within 1e-7 of the acceleration that its load would cause, at every stage of the integrator, and what it
// deviates tells the force of the drive.
double drive_armature(const crane_models::Scene& scene, int body);

// Whether the box stands still, is level and so wide against the other one that its top is a plane for it.
bool is_plane_for(const crane_models::Scene& scene, int body, int box, int other_body, int other_box);

// Names in the model.
std::string geom_name(const crane_models::Scene& scene, int body, int box, bool as_plane);
std::string pin_name(const spreader::Lock& lock, int pin);
inline std::string joint_name(const crane_models::Body& body) { return body.name + ".joint"; }

}  // namespace quayside::harness::mujoco
