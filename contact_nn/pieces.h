// The surface of each of two overlapping boxes inside the other, cut into the pieces on which the depth is affine.
//
// The depth of a point inside box Y is φ_Y = min_j g_j, g_j the distance to Y's plane j. A piece is the part of face f
// of box X that lies inside the other box Y and to which face i of Y, its cell, is the nearest: there φ_Y = g_i. It is
// a convex polygon. Faces are numbered 2 · axis + (negative side ? 1 : 0).
#pragma once

#include <array>
#include <bitset>

#include "contact_nn/contact.h"

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

// c + u · (first coordinate) + v · (second)
struct Affine {
  double c, u, v;
  double at(double x, double y) const { return c + u * x + v * y; }
};

// Every edge of a piece lies on another line: 4 sides of the face, 6 planes, 5 neighbours, and one cut more.
inline constexpr int kMaxVertices = 16;

// A convex polygon in the coordinates of a face of box X: with the face on axis k, u is along axis k+1 and v along
// axis k+2 (cyclic), from the face's centre [m].
struct Polygon {
  struct Vertex {
    double u, v;
  };
  alignas(16) std::array<Vertex, kMaxVertices> vertex;
  int count;
};

// The part of a polygon where f ≥ 0. True: it was cut, or vanished (count 0), and is in `out`; false: f is nowhere
// negative and `out` was not touched.
bool clip(const Polygon& in, const Affine& f, Polygon& out);

struct Piece {
  Surface surface;
  int face, cell;
  Affine depth;  // φ_Y = g_i over the face's coordinates [m]
  Polygon polygon;
};

struct Pieces {
  int count = 0;
  double deepest = 0;  // no point is deeper, and the deepest one not by much less [m]
  std::array<Piece, kPieceCount> piece;
};

// Cuts the named pieces; those that turn out empty are left out.
void cut_pieces(const Box& a, const Box& b, const Pose& X_AB, const PieceMask& named, Pieces& pieces);

}  // namespace quayside::contact_nn
