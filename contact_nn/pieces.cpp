#include "contact_nn/pieces.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace quayside::contact_nn {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Rounding of g_j − g_i in units of ε times the size of the pair [1]: some ten operations. A face that lies in the
// sheet between two cells to within it belongs to the lower cell as a whole, so that it is counted once.
constexpr double kSheetRounding = 16;

// Box X as seen from box Y. Lanes belong to Y's axes.
struct Seen {
  // `columns` of R_YX.
  Seen(const Vector3d& x, const Vector3d& y, const Four (&columns)[3], const Four& p)
      : half_x(x), half_y(four(y)), R_YX{columns[0], columns[1], columns[2]}, p_YX(p) {
    const Four size = abs(p) + four(x) + half_y;
    for (int k = 0; k < 3; ++k) scaled[k] = x[k] * columns[k];
    sheet = kSheetRounding * std::numeric_limits<double>::epsilon() * sum3(size);
  }

  // Centre of a face, and how far the face reaches from it.
  Four centre(int face) const { return face % 2 ? p_YX - scaled[face / 2] : p_YX + scaled[face / 2]; }
  Four reach(int face) const { return abs(scaled[(face / 2 + 1) % 3]) + abs(scaled[(face / 2 + 2) % 3]); }

  Vector3d half_x;
  Four half_y;
  Four R_YX[3], p_YX;
  Four scaled[3];  // columns of R_YX times half_x
  double sheet;    // rounding of g_j − g_i
};

std::array<Seen, 2> both_ways(const Box& a, const Box& b, const Pose& X_AB) {
  const auto column = [&](int k) { return load_four(X_AB.matrix().col(k).data()); };
  const Four columns[3] = {column(0), column(1), column(2)}, p_AB = column(3);
  const Rows rows(columns[0], columns[1], columns[2]);
  const Four p_BA = -(rows.row[0] * p_AB[0] + rows.row[1] * p_AB[1] + rows.row[2] * p_AB[2]);
  return {Seen(a.half, b.half, rows.row, p_BA), Seen(b.half, a.half, columns, p_AB)};
}

double least3(const Four& v) { return std::min(v[0], std::min(v[1], v[2])); }

// Ranges of the distances to Y's planes over some part of a face.
struct Ranges {
  Ranges(const Four& half_y, const Four& low, const Four& high)  // of the position in Y
      : least{half_y - high, half_y + low}, bound(least3(smaller(half_y - low, half_y + high))) {}

  double least_of(int cell) const { return least[cell % 2][cell / 2]; }

  Four least[2];  // of the planes on the positive sides, and on the negative ones
  double bound;   // φ is nowhere greater: a plane that stays farther away than this has no cell
};

[[gnu::always_inline]] inline Ranges ranges_over_rectangle(const Seen& x, int face) {
  const Four centre = x.centre(face), reach = x.reach(face);
  return {x.half_y, centre - reach, centre + reach};
}

// c + u · (first coordinate) + v · (second)
struct Affine {
  double c, u, v;
  double at(double x, double y) const { return c + u * x + v * y; }
};

// A convex polygon in the coordinates of a face of box X: with the face on axis k, u is along axis k+1 and v along
// axis k+2 (cyclic), from the face's centre [m].
struct Polygon {
  struct Vertex {
    double u, v;
  };
  alignas(16) std::array<Vertex, kMaxVertices> vertex;
  int count;
};

// A vertex as one vector. Vertices are copied from polygon to polygon as soon as they are written, and a processor can
// hand over at once what was written in one piece, not what was written in two.
typedef double Two __attribute__((vector_size(16)));
Two two(const Polygon::Vertex& x) {
  Two v;
  std::memcpy(&v, &x, sizeof v);
  return v;
}
Polygon::Vertex vertex(const Two& v) {
  Polygon::Vertex x;
  std::memcpy(&x, &v, sizeof x);
  return x;
}

// The part of a polygon where f ≥ 0. True: it was cut, or vanished (count 0), and is in `out`; false: f is nowhere
// negative and `out` was not touched.
//
// The vertices outside a convex polygon's cut form one run; what is kept is the other run, and two new vertices where
// the line crosses. Rounding at vertices on the line itself may break the runs: then the one with the lowest vertex is
// cut.
bool clip(const Polygon& in, const Affine& f, Polygon& out) {
  const int count = in.count;
  std::array<double, kMaxVertices> value;
  unsigned outside = 0, within = 0;
  for (int k = 0; k < count; ++k) {
    value[k] = f.at(in.vertex[k].u, in.vertex[k].v);
    outside |= unsigned{value[k] < 0} << k;
    within |= unsigned{value[k] > 0} << k;
  }
  if (outside == 0) return false;
  if (within == 0) {
    out.count = 0;
    return true;
  }
  const auto next = [count](int k) { return k + 1 < count ? k + 1 : 0; };
  const auto previous = [count](int k) { return k > 0 ? k - 1 : count - 1; };
  const auto is_outside = [outside](int k) { return outside >> k & 1u; };
  const auto crossing = [&](int kept, int cut) {
    const double t = value[kept] / (value[kept] - value[cut]);
    const Two p = two(in.vertex[kept]), q = two(in.vertex[cut]);
    return vertex(p + t * (q - p));
  };
  // One bit per vertex: those outside whose predecessor, or successor, is not.
  const unsigned after_outside = outside << 1 | outside >> (count - 1);
  const unsigned before_outside = outside >> 1 | (outside & 1u) << (count - 1);
  const unsigned starts = outside & ~after_outside, ends = outside & ~before_outside;
  int first, last;
  if ((starts & (starts - 1)) == 0) {
    first = next(__builtin_ctz(ends));
    last = previous(__builtin_ctz(starts));
  } else {
    const int lowest = static_cast<int>(std::min_element(value.begin(), value.begin() + count) - value.begin());
    first = next(lowest), last = previous(lowest);
    while (is_outside(first)) first = next(first);
    while (is_outside(last)) last = previous(last);
  }

  int n = 0;
  for (int k = first;; k = next(k)) {
    out.vertex[n++] = in.vertex[k];
    if (k == last) break;
  }
  assert(n + 2 <= kMaxVertices);
  out.vertex[n++] = crossing(last, next(last));
  out.vertex[n++] = crossing(first, previous(first));
  out.count = n;
  return true;
}

enum class Clipped { not_at_all, partly, too_many };  // too many vertices for this kind of polygon

Clipped clip_to(const Affine& f, const Polygon& in, Polygon& out) {
  return clip(in, f, out) ? Clipped::partly : Clipped::not_at_all;
}

Polygon rectangle(double half_u, double half_v, const Polygon*) {
  Polygon x;
  x.count = 4;
  x.vertex[0] = vertex(Two{-half_u, -half_v});
  x.vertex[1] = vertex(Two{half_u, -half_v});
  x.vertex[2] = vertex(Two{half_u, half_v});
  x.vertex[3] = vertex(Two{-half_u, half_v});
  return x;
}

// Lanes of `centre`, `along_u` and `along_v`: the position in Y is affine over the face.
Ranges ranges_over_polygon(const Polygon& polygon, const Four& centre, const Four& along_u, const Four& along_v,
                           const Four& half_y) {
  const auto position = [&](const Polygon::Vertex& x) { return centre + x.u * along_u + x.v * along_v; };
  Four low = position(polygon.vertex[0]), high = low;
  for (int k = 1; k < polygon.count; ++k) {
    const Four y = position(polygon.vertex[k]);
    low = smaller(low, y);
    high = larger(high, y);
  }
  return {half_y, low, high};
}

// A piece into a row of the transpose of what `finish` makes.
void put(const Polygon& polygon, int row, EightPieces& pieces) {
  static_assert(kMaxVertices == 2 * kEight, "two rows to a piece");
  pieces.count[row] = polygon.count;
  for (int k = 0; k < (polygon.count > kEight ? 2 * kEight : kEight); ++k) {
    const Polygon::Vertex& x = polygon.vertex[std::min(k, polygon.count - 1)];
    pieces.u[k / kEight * kEight + row][k % kEight] = x.u;
    pieces.v[k / kEight * kEight + row][k % kEight] = x.v;
  }
}

// No piece.
void put_none(int row, EightPieces& pieces) {
  pieces.count[row] = 1;
  store_eight(Eight{}, pieces.u[row]);
  store_eight(Eight{}, pieces.v[row]);
}

#ifdef __AVX512F__
// A convex polygon of at most eight vertices in two vectors; lanes without a vertex repeat the last one. Clipping it takes
// some thirty instructions and no loop.
struct Octagon {
  Eight u, v;
  int count;
};

// Where the vertices of a cut polygon come from: 0 … 7 one of the old vertices, 8 … 15 the crossing on the way from the old
// vertex 0 … 7 to its successor.
struct Origins {
  std::uint8_t count;      // of vertices of the cut polygon, up to 9
  std::uint8_t origin[8];  // the last one repeated
};

// By the number of old vertices, and by which of them are outside. They form one run, or, by rounding at vertices on the line
// itself, several: then all outside are dropped, and every crossing stays: degenerate corners on the line.
constexpr auto kOrigins = [] {
  std::array<std::array<Origins, 256>, 9> all{};
  for (int count = 1; count <= 8; ++count)
    for (int outside = 0; outside < 256; ++outside) {
      Origins& x = all[count][outside];
      int n = 0;
      for (int k = 0; k < count; ++k) {
        const bool out = outside >> k & 1, next_out = outside >> ((k + 1) % count) & 1;
        if (!out) {
          if (n < 8) x.origin[n] = static_cast<std::uint8_t>(k);
          ++n;
        }
        if (out != next_out) {
          if (n < 8) x.origin[n] = static_cast<std::uint8_t>(8 + k);
          ++n;
        }
      }
      x.count = static_cast<std::uint8_t>(n);
      for (int k = n; k < 8 && n > 0; ++k) x.origin[k] = x.origin[n - 1];
    }
  return all;
}();

// Lane k of a rotated vector is that of the successor of vertex k.
alignas(64) constexpr auto kSuccessors = [] {
  std::array<std::array<std::int64_t, 8>, 9> all{};
  for (int count = 1; count <= 8; ++count)
    for (int k = 0; k < 8; ++k) all[count][k] = k + 1 < count ? k + 1 : 0;
  return all;
}();

[[gnu::always_inline]] inline Clipped clip_to(const Affine& f, const Octagon& in, Octagon& out) {
  const Eight value = f.c + f.u * in.u + f.v * in.v;
  const unsigned outside = _mm512_cmp_pd_mask(value, Eight{}, _CMP_LT_OQ);
  if (outside == 0) return Clipped::not_at_all;
  if (_mm512_cmp_pd_mask(value, Eight{}, _CMP_GT_OQ) == 0) {
    out.count = 0;
    return Clipped::partly;
  }
  EightFlags successor, origin;
  std::memcpy(&successor, kSuccessors[in.count].data(), sizeof successor);
  const Eight t = value / (value - __builtin_shuffle(value, successor));
  const Eight u = in.u + t * (__builtin_shuffle(in.u, successor) - in.u);
  const Eight v = in.v + t * (__builtin_shuffle(in.v, successor) - in.v);
  const Origins& origins = kOrigins[in.count][outside];
  origin = reinterpret_cast<EightFlags>(
      _mm512_cvtepu8_epi64(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(origins.origin))));
  out.u = __builtin_shuffle(in.u, u, origin);
  out.v = __builtin_shuffle(in.v, v, origin);
  out.count = origins.count;
  return out.count > 8 ? Clipped::too_many : Clipped::partly;
}

Octagon rectangle(double half_u, double half_v, const Octagon*) {
  return {half_u * Eight{-1, 1, 1, -1, -1, -1, -1, -1}, half_v * Eight{-1, -1, 1, 1, 1, 1, 1, 1}, 4};
}

Ranges ranges_over_polygon(const Octagon& polygon, const Four& centre, const Four& along_u, const Four& along_v,
                           const Four& half_y) {
  Eight y[kEight];
  for (int m = 0; m < 3; ++m) {
    y[m] = centre[m] + along_u[m] * polygon.u + along_v[m] * polygon.v;
    y[4 + m] = -y[m];
  }
  y[3] = y[7] = Eight{};
  const Eight most = lanes_of_each(y, [](const Eight& a, const Eight& b) { return larger(a, b); });
  return {half_y, -__builtin_shufflevector(most, most, 4, 5, 6, 7), __builtin_shufflevector(most, most, 0, 1, 2, 3)};
}

void put(const Octagon& polygon, int row, EightPieces& pieces) {
  pieces.count[row] = polygon.count;
  store_eight(polygon.u, pieces.u[row]);
  store_eight(polygon.v, pieces.v[row]);
}
#endif

// Turns pieces, each in a row, into lanes.
void finish(EightPieces& pieces) {
  pieces.vertices = *std::max_element(pieces.count.begin(), pieces.count.end());
  for (auto* coordinate : {pieces.u, pieces.v})
    for (int first = pieces.vertices > kEight ? kEight : 0; first >= 0; first -= kEight) {
      Eight rows[kEight];
      for (int row = 0; row < kEight; ++row)
        rows[row] = pieces.count[row] > first ? load_eight(coordinate[first + row]) : eight(coordinate[row][kEight - 1]);
      transpose(rows);
      for (int row = 0; row < kEight; ++row) store_eight(rows[row], coordinate[first + row]);
    }
}

// Clips a polygon again and again between two buffers.
template <class Shape>
class Clipper {
 public:
  explicit Clipper(const Shape& start) : now_(&start) {}
  const Shape& polygon() const { return *now_; }
  bool empty() const { return now_->count == 0; }
  // False: there are too many vertices for this shape.
  bool clip(const Affine& f) {
    Shape& target = buffer_[now_ == &buffer_[0]];
    const Clipped how = clip_to(f, *now_, target);
    if (how == Clipped::partly) now_ = &target;
    return how != Clipped::too_many;
  }

 private:
  const Shape* now_;
  std::array<Shape, 2> buffer_;
};

// A face of X, and the part of it that lies inside Y.
template <class Shape>
struct Face {
  Surface surface;
  int number;
  unsigned cells;  // wanted, bit i for face i of Y
  const Seen* seen;
  double half_u, half_v;
  Four centre, along_u, along_v;  // the position in Y is affine over the face …
  std::array<Affine, 6> g;        // … and so are the distances to Y's planes
  Ranges ranges;                  // over the rectangle
  Shape inside;
  bool clipped;                   // the inside is not the rectangle

  Face(Surface surface, int number, const Seen& x, unsigned cells, const Ranges& ranges)
      : surface(surface), number(number), cells(cells), seen(&x), ranges(ranges) {
    const int k = number / 2, k_u = (k + 1) % 3, k_v = (k + 2) % 3;
    half_u = x.half_x[k_u], half_v = x.half_x[k_v];
    centre = x.centre(number), along_u = x.R_YX[k_u], along_v = x.R_YX[k_v];
    const Four to_plane[2] = {x.half_y - centre, x.half_y + centre};
    for (int m = 0; m < 3; ++m) {
      g[2 * m] = {to_plane[0][m], -along_u[m], -along_v[m]};
      g[2 * m + 1] = {to_plane[1][m], along_u[m], along_v[m]};
    }
  }
};

// The rectangle is clipped to g_j ≥ 0 for all j. False: there are too many vertices for this shape.
template <class Shape>
bool find_inside(Face<Shape>& face) {
  const Shape whole = rectangle(face.half_u, face.half_v, static_cast<const Shape*>(nullptr));
  Clipper<Shape> inside(whole);
  for (int j = 0; j < 6; ++j)
    if (face.ranges.least_of(j) < 0 && !inside.clip(face.g[j])) return false;
  face.inside = inside.polygon();
  face.clipped = &inside.polygon() != &whole;
  return true;
}

// The inside is clipped once for each cell i to g_j − g_i ≥ 0. False: there are too many vertices for this shape.
template <class Shape>
bool cut_cells(const Face<Shape>& face, Pieces& pieces) {
  if (face.inside.count == 0) return true;
  const Ranges ranges = face.clipped ? ranges_over_polygon(face.inside, face.centre, face.along_u, face.along_v, face.seen->half_y)
                                     : face.ranges;
  const double bound = ranges.bound;
  std::array<int, 6> candidates;
  int candidate_count = 0;
  for (int i = 0; i < 6; ++i) {
    candidates[candidate_count] = i;
    candidate_count += ranges.least_of(i) <= bound;
  }

  const auto& g = face.g;
  for (int a = 0; a < candidate_count; ++a) {
    const int i = candidates[a];
    if (!(face.cells >> i & 1u)) continue;
    Clipper<Shape> cell(face.inside);
    bool owned = true;
    for (int b = 0; b < candidate_count && owned; ++b) {
      const int j = candidates[b];
      // The opposite plane is no neighbour where the depth cannot reach the middle of Y.
      if (j == i || (j == (i ^ 1) && bound < face.seen->half_y[i / 2])) continue;
      const Affine farther{g[j].c - g[i].c, g[j].u - g[i].u, g[j].v - g[i].v};
      const bool tied = std::abs(farther.c) + std::abs(farther.u) * face.half_u + std::abs(farther.v) * face.half_v <=
                        face.seen->sheet;
      if (!tied && !cell.clip(farther)) return false;
      owned = tied ? i < j : !cell.empty();
    }
    if (!owned) continue;
    EightPieces& eight = pieces.eight[pieces.count / kEight];
    const int row = pieces.count % kEight;
    put(cell.polygon(), row, eight);
    eight.depth[0][row] = g[i].c, eight.depth[1][row] = g[i].u, eight.depth[2][row] = g[i].v;
    pieces.name[pieces.count++] = {face.surface, face.number, i};
    pieces.deepest = std::max(pieces.deepest, bound);
  }
  return true;
}

// All insides first, then all cells: each is a chain of cuts that wait for one another, but not for those of another face.
template <class Shape>
bool cut_faces(const std::array<Seen, 2>& seen, const PieceMask& named, Pieces& pieces) {
  alignas(Face<Shape>) std::array<std::byte, 12 * sizeof(Face<Shape>)> memory;
  Face<Shape>* const faces = reinterpret_cast<Face<Shape>*>(memory.data());
  int count = 0;
  const PieceMask one_face(0b111111);
  for (const Surface surface : {Surface::of_a, Surface::of_b}) {
    const Seen& x = seen[static_cast<int>(surface)];
    for (int number = 0; number < 6; ++number) {
      const PieceMask cells = named >> piece_index(surface, number, 0) & one_face;
      if (cells.none()) continue;
      const Ranges ranges = ranges_over_rectangle(x, number);
      if (ranges.bound <= 0) continue;
      new (&faces[count++]) Face<Shape>(surface, number, x, static_cast<unsigned>(cells.to_ulong()), ranges);
    }
  }
  for (int i = 0; i < count; ++i)
    if (!find_inside(faces[i])) return false;
  for (int i = 0; i < count; ++i)
    if (!cut_cells(faces[i], pieces)) return false;
  return true;
}

}  // namespace

void clip_pieces(const EightPieces& in, const Eight& c, const Eight& u, const Eight& v, EightPieces& out) {
  out.depth = in.depth;
  const auto clip_row = [&](int row, const auto& whole, auto& part) {
    const Clipped how = clip_to({c[row], u[row], v[row]}, whole, part);
    if (how == Clipped::not_at_all) put(whole, row, out);
    else if (part.count > 0) put(part, row, out);
    else put_none(row, out);
    return how != Clipped::too_many;
  };
  bool fits = false;
#ifdef __AVX512F__
  if (in.vertices <= kEight) {
    Eight rows_u[kEight], rows_v[kEight];
    for (int k = 0; k < kEight; ++k) {
      rows_u[k] = load_eight(in.u[std::min(k, in.vertices - 1)]);
      rows_v[k] = load_eight(in.v[std::min(k, in.vertices - 1)]);
    }
    transpose(rows_u);
    transpose(rows_v);
    fits = true;
    Octagon part;
    for (int row = 0; row < kEight; ++row) fits = clip_row(row, Octagon{rows_u[row], rows_v[row], in.count[row]}, part) && fits;
  }
#endif
  for (int row = 0; row < kEight && !fits; ++row) {
    Polygon whole, part;
    whole.count = in.count[row];
    for (int k = 0; k < whole.count; ++k) whole.vertex[k] = {in.u[k][row], in.v[k][row]};
    clip_row(row, whole, part);
  }
  finish(out);
}

PieceMask possible_pieces(const Box& a, const Box& b, const Pose& X_AB) {
  const std::array<Seen, 2> seen = both_ways(a, b, X_AB);
  PieceMask mask;
  for (const Surface surface : {Surface::of_a, Surface::of_b})
    for (int face = 0; face < 6; ++face) {
      const Ranges ranges = ranges_over_rectangle(seen[static_cast<int>(surface)], face);
      if (ranges.bound <= 0) continue;
      for (int cell = 0; cell < 6; ++cell)
        if (ranges.least_of(cell) <= ranges.bound) mask.set(piece_index(surface, face, cell));
    }
  return mask;
}

void cut_pieces(const Box& a, const Box& b, const Pose& X_AB, const PieceMask& named, Pieces& pieces) {
  const std::array<Seen, 2> seen = both_ways(a, b, X_AB);
  bool fits = false;
#ifdef __AVX512F__
  fits = cut_faces<Octagon>(seen, named, pieces);
#endif
  if (!fits) {
    pieces.count = 0;
    cut_faces<Polygon>(seen, named, pieces);
  }
  for (int i = pieces.count; i < kEight * pieces.eights(); ++i) {
    put_none(i % kEight, pieces.eight[i / kEight]);
    for (auto& depth : pieces.eight[i / kEight].depth) depth[i % kEight] = 0;
  }
  for (int i = 0; i < pieces.eights(); ++i) finish(pieces.eight[i]);
}

}  // namespace quayside::contact_nn
