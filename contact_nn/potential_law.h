// The p-norm potential of two overlapping boxes, its gradient, and the damping and friction that ride on it.
//
// φ_Y(x) = min_j g_j(x) is the depth of a point inside box Y, g_j the distance to Y's plane j. With
//
//     I = ½ [ ∫_{∂A∩B} φ_B^p dS + ∫_{∂B∩A} φ_A^p dS ],     U = ½ K (I/A_f)^(2/p),
//
// a flat contact of area A_f and depth δ has U = ½ K δ², one of area A′ the stiffness K (A′/A_f)^(2/p); edges stiffen
// as δ^(1 + 2/p), corners as δ^(1 + 4/p). φ vanishes at the border of the overlap, so force and torque are the
// gradient of U without boundary terms, and they are continuous.
#pragma once

#include <array>
#include <bitset>

#include "contact_nn/contact.h"
#include "contact_nn/law_parameters.h"

namespace quayside::contact_nn {

inline constexpr int kNorm = 8;                 // p: how local the contact is
inline constexpr double kReferenceArea = 29.7;  // A_f: footprint of a 40 ft box [m²]

// A piece: the part of face f of box X inside the other box Y to which face i of Y (the cell) is the nearest.
// Faces are numbered 2 · axis + (negative side ? 1 : 0).
inline constexpr int kPieceCount = 72;
using PieceMask = std::bitset<kPieceCount>;

enum class Surface { of_a, of_b };  // whose face is integrated over; the other box gives the cells

constexpr int piece_index(Surface surface, int face, int cell) {
  return 36 * static_cast<int>(surface) + 6 * face + cell;
}
inline PieceMask all_pieces() { return PieceMask().set(); }

// The force from the named pieces alone: the law itself if every other piece is empty.
ContactForce potential_force(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                             const LawParameters& law, const PieceMask& pieces);

// The law: all pieces, after the separating-axis test.
ContactForce potential_force(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                             const LawParameters& law);

// Pieces that cannot be proved empty from interval bounds over the face's rectangle: contains every piece that is not
// empty, and cheaper than the clipping that would tell exactly.
PieceMask possible_pieces(const Box& a, const Box& b, const Pose& X_AB);

// What each piece contributes to ∫φ^(p−1) dS, as a share of the whole: the load it carries. All zero when apart.
std::array<double, kPieceCount> piece_loads(const Box& a, const Box& b, const Pose& X_AB);

}  // namespace quayside::contact_nn
