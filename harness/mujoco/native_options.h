// Our physical parameters in MuJoCo's terms.
//
// A constraint of MuJoCo with constant impedance d and solref = (−k, −b) exerts the force (k r + b ṙ)/(A (1 − d)) for
// the violation r, as if its two sides had the inverse mass A, and adds an inertia of d/(A (1 − d)) between them. A is
// a constant of the model: `tendon_invweight0`, or the sum of the two bodies' `body_invweight0`. So k = K A (1 − d) and
// b = C A (1 − d) make it a spring of stiffness K and a damper C, and a small d makes the inertia negligible.
#pragma once

#include <vector>

#include <mujoco/mujoco.h>

#include "contact_nn/contact.h"
#include "crane_models/scene.h"
#include "harness/mujoco/mjcf.h"

namespace quayside::harness::mujoco {

// What MuJoCo's collider tells of two boxes that are pressed together flat.
struct FlatContact {
  double area = 0;            // of the smaller of the two faces [m²]
  int points = 0;
  double reported_depth = 1;  // mean reported depth over the true one: the 2.2.2 collider of two boxes reports half
};

// The two boxes turned against each other as at the start, but level and centred, as if the one had landed on the
// other.
FlatContact press_flat(const crane_models::Scene& scene, const crane_models::ContactPair& pair);

// Damping ratio of a linear spring and damper without pull that leaves with `restitution` times the speed it came with:
// the root ζ of e = exp(−2ζ acos ζ/√(1 − ζ²)).
double damping_ratio(double restitution);

// Spring and damper as a solref with the inverse mass A.
SolverReference reference(double stiffness, double damping, double inverse_mass);
// A of two bodies of the model.
double inverse_mass(const mjModel* model, int body_a, int body_b);

// Everything for `to_mjcf` to make the model of the engine "mujoco".
//
//   ropes      K = EA/L0 and C as they are at the start
//   locks      K and C per pin
//   contacts   the flat stiffness of the pair's faces (see contact law) split over the points that MuJoCo finds, so
//              that the whole contact has it; damping likewise, for the restitution at a full flat hit. Under the law `pads`
//              a quarter of it per point, as there. Stiffness per point is over the share of the depth that the collider
//              reports: 2.2.2 reports half between boxes. Left alone, contacts there are half as stiff under the same damper,
//              and peak forces of blows between boxes are too low by 29 % when elastic and by 15 % at a restitution of 0.4
//   friction   MuJoCo's friction sticks like a damper of impratio × C. It is made to creep as ours does under the
//              weight of the heaviest pair: impratio = μ m g/(C v_t), one number for the whole model. With restitution
//              1 there is no damper to make friction of: a damping ratio of `kLeastDampingRatio` is then used
MjcfOptions native_options(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact);

constexpr double kLeastDampingRatio = 0.01;

}  // namespace quayside::harness::mujoco
