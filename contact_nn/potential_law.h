// The p-norm potential of two overlapping boxes, its gradient, and the damping and friction that ride on it.
//
// With φ_Y the depth of a point inside box Y (see pieces.h), the potential is
//
//     I = ½ [ ∫_{∂A∩B} φ_B^p dS + ∫_{∂B∩A} φ_A^p dS ],     U = ½ K (I/A_f)^(2/p).
//
// A flat contact of area A_f and depth δ has U = ½ K δ², one of area A′ the stiffness K (A′/A_f)^(2/p); edges stiffen
// as δ^(1 + 2/p), corners as δ^(1 + 4/p). φ vanishes at the border of the overlap, so force and torque are the gradient
// of U without boundary terms, and they are continuous.
//
// One exception, far deeper than any contact: U has a kink, and the force a jump, where a whole face of one box passes
// through a plane from which two faces of the other are equally far (flat contact: at half the thickness).
#pragma once

#include <array>

#include "contact_nn/contact.h"
#include "contact_nn/law_parameters.h"
#include "contact_nn/pieces.h"

namespace quayside::contact_nn {

inline constexpr double kReferenceArea = 29.7;  // A_f: footprint of a 40 ft box [m²]

// The law: all pieces, after the separating-axis test.
ContactForce potential_force(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                             const LawParameters& law);

// The force from the named pieces alone: the law itself if every other piece is empty. No separating-axis test.
ContactForce potential_force(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                             const LawParameters& law, const PieceMask& named);

// What each piece contributes to ∫φ^(p−1) dS, as a share of the whole: the load it carries. All zero when apart.
std::array<double, kPieceCount> piece_loads(const Box& a, const Box& b, const Pose& X_AB);

}  // namespace quayside::contact_nn
