// Springs at the points of the manifold: the law of most rigid-body engines, kept for comparison with them.
//
// The stiffness K is split evenly over the n points: F_i = (K/n) δ_i (1 + c s_i)₊ along the manifold's normal, s_i the
// approach speed there, and friction μ F_i v_t / √(|v_t|² + v_t0²) against the sliding. The damping is that of Hunt and
// Crossley, not a linear one: a linear damper needs the mass to give a restitution, and it starts with a jump.
// Where points appear or the axis changes, the force jumps: the law is not the gradient of its `potential_energy`.
#pragma once

#include "contact_nn/contact.h"
#include "contact_nn/law_parameters.h"

namespace quayside::contact_nn {

ContactForce points_force(const Manifold& manifold, const Pose& X_AB, const RelativeVelocity& V_AB,
                          const LawParameters& law);

}  // namespace quayside::contact_nn
