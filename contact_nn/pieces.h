// The surface of each of two overlapping boxes inside the other, cut into the pieces on which the depth is affine.
//
// The depth of a point inside box Y is φ_Y = min_j g_j, g_j the distance to Y's plane j. A piece is the part of face f
// of box X that lies inside the other box Y and to which face i of Y, its cell, is the nearest: there φ_Y = g_i. It is
// a convex polygon. Faces are numbered 2 · axis + (negative side ? 1 : 0).
#pragma once

#include <array>
#include <bitset>

#include "contact_nn/contact.h"
#include "contact_nn/lanes.h"

namespace quayside::contact_nn {

enum class Surface { of_a, of_b };  // whose face is integrated over; the other box gives the cells

inline constexpr int kPieceCount = 72;
using PieceMask = std::bitset<kPieceCount>;

constexpr int piece_index(Surface surface, int face, int cell) {
  return 36 * static_cast<int>(surface) + 6 * face + cell;
}
inline PieceMask all_pieces() { return PieceMask().set(); }

// Pieces that cannot be proved empty from the ranges of the distances over the face's rectangle: every piece that is
// not empty is among them. Much cheaper than the cutting that would tell exactly.
PieceMask possible_pieces(const Box& a, const Box& b, const Pose& X_AB);

// Every edge of a piece lies on another line: 4 sides of the face, 6 planes, 5 neighbours, and one cut more.
inline constexpr int kMaxVertices = 16;

struct PieceName {
  Surface surface;
  int face, cell;
};

// Pieces side by side, one to a lane. A piece with fewer vertices than the others repeats its last one; a lane without a
// piece has no area and no depth.
struct EightPieces {
  std::array<int, kEight> count;               // of vertices …
  int vertices;                                // … and the most of any lane
  alignas(64) double u[kMaxVertices][kEight];  // the face's coordinates [m]
  alignas(64) double v[kMaxVertices][kEight];
  alignas(64) std::array<std::array<double, kEight>, 3> depth;  // c, u, v of φ_Y = g_i over them [m]
};

struct Pieces {
  int count = 0;
  double deepest = 0;  // no point is deeper, and the deepest one not by much less [m]
  std::array<PieceName, kPieceCount> name;
  std::array<EightPieces, kPieceCount / kEight> eight;  // piece i is in lane i % 8 of the i / 8-th

  int eights() const { return (count + kEight - 1) / kEight; }
};

// The parts of pieces where c + u · (first coordinate) + v · (second) ≥ 0; a lane to each piece.
void clip_pieces(const EightPieces& in, const Eight& c, const Eight& u, const Eight& v, EightPieces& out);

// Cuts the named pieces; those that turn out empty are left out. `pieces` is empty before.
void cut_pieces(const Box& a, const Box& b, const Pose& X_AB, const PieceMask& named, Pieces& pieces);

}  // namespace quayside::contact_nn
