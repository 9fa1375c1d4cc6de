#include "contact_nn/pieces.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

namespace quayside::contact_nn {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Rounding of g_j − g_i in units of ε times the size of the pair [1]: some ten operations. A face that lies in the
// sheet between two cells to within it belongs to the lower cell as a whole, so that it is counted once.
constexpr double kSheetRounding = 16;

// Box X as seen from box Y.
struct Seen {
  Seen(const Vector3d& x, const Vector3d& y, const Matrix3d& R, const Vector3d& p)
      : half_x(x), half_y(y), R_YX(R), p_YX(p), scaled(R * x.asDiagonal()), scaled_abs(scaled.cwiseAbs()),
        width(scaled_abs.rowwise().sum()),
        sheet(kSheetRounding * std::numeric_limits<double>::epsilon() * (x.sum() + y.sum() + p.lpNorm<1>())) {}

  // Centre of a face, and how far the face reaches from it, along Y's axis m.
  double centre(int face, int m) const { return p_YX[m] + (face % 2 ? -scaled(m, face / 2) : scaled(m, face / 2)); }
  double reach(int face, int m) const { return width[m] - scaled_abs(m, face / 2); }

  Vector3d half_x, half_y;
  Matrix3d R_YX;
  Vector3d p_YX;
  Matrix3d scaled, scaled_abs;  // R_YX times half_x
  Vector3d width;               // half the extent of X along Y's axes
  double sheet;                 // rounding of g_j − g_i
};

std::array<Seen, 2> both_ways(const Box& a, const Box& b, const Pose& X_AB) {
  const Matrix3d R_BA = X_AB.linear().transpose();
  return {Seen(a.half, b.half, R_BA, -(R_BA * X_AB.translation())),
          Seen(b.half, a.half, X_AB.linear(), X_AB.translation())};
}

// Ranges of the distances to Y's planes over some part of a face.
struct Ranges {
  std::array<double, 6> least, most;
  void set(int m, double half, double low, double high) {  // low ≤ y_m ≤ high
    least[2 * m] = half - high;
    most[2 * m] = half - low;
    least[2 * m + 1] = half + low;
    most[2 * m + 1] = half + high;
  }
  // φ is nowhere greater: a plane that stays farther away than this has no cell.
  double bound() const { return *std::min_element(most.begin(), most.end()); }
};

Ranges ranges_over_rectangle(const Seen& x, int face) {
  Ranges ranges;
  for (int m = 0; m < 3; ++m) {
    const double c = x.centre(face, m), reach = x.reach(face, m);
    ranges.set(m, x.half_y[m], c - reach, c + reach);
  }
  return ranges;
}

Ranges ranges_over_polygon(const Polygon& polygon, const std::array<Affine, 3>& y, const Vector3d& half_y) {
  Ranges ranges;
  for (int m = 0; m < 3; ++m) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (int k = 0; k < polygon.count; ++k) {
      const double value = y[m].at(polygon.vertex[k].u, polygon.vertex[k].v);
      low = std::min(low, value);
      high = std::max(high, value);
    }
    ranges.set(m, half_y[m], low, high);
  }
  return ranges;
}

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

// Clips a polygon again and again between two buffers.
class Clipper {
 public:
  explicit Clipper(const Polygon& start) : now_(&start) {}
  const Polygon& polygon() const { return *now_; }
  bool empty() const { return now_->count == 0; }
  void clip(const Affine& f) {
    Polygon& target = buffer_[now_ == &buffer_[0]];
    if (contact_nn::clip(*now_, f, target)) now_ = &target;
  }

 private:
  const Polygon* now_;
  std::array<Polygon, 2> buffer_;
};

// The rectangle is clipped to g_j ≥ 0 for all j, then once for each cell i to g_j − g_i ≥ 0. `cells` names the wanted
// cells, bit i for face i of Y.
void cut_face(Surface surface, int face, const Seen& x, unsigned cells, Pieces& pieces) {
  Ranges ranges = ranges_over_rectangle(x, face);
  if (ranges.bound() <= 0) return;

  const int k = face / 2, k_u = (k + 1) % 3, k_v = (k + 2) % 3;
  const double half_u = x.half_x[k_u], half_v = x.half_x[k_v];
  std::array<Affine, 3> y;  // position in Y
  for (int m = 0; m < 3; ++m) y[m] = {x.centre(face, m), x.R_YX(m, k_u), x.R_YX(m, k_v)};
  std::array<Affine, 6> g;
  for (int m = 0; m < 3; ++m) {
    g[2 * m] = {x.half_y[m] - y[m].c, -y[m].u, -y[m].v};
    g[2 * m + 1] = {x.half_y[m] + y[m].c, y[m].u, y[m].v};
  }

  Polygon rectangle;
  rectangle.count = 4;
  rectangle.vertex[0] = vertex(Two{-half_u, -half_v});
  rectangle.vertex[1] = vertex(Two{half_u, -half_v});
  rectangle.vertex[2] = vertex(Two{half_u, half_v});
  rectangle.vertex[3] = vertex(Two{-half_u, half_v});
  Clipper inside(rectangle);
  for (int j = 0; j < 6; ++j)
    if (ranges.least[j] < 0) inside.clip(g[j]);
  if (inside.empty()) return;
  if (&inside.polygon() != &rectangle) ranges = ranges_over_polygon(inside.polygon(), y, x.half_y);

  const double bound = ranges.bound();
  std::array<int, 6> candidates;
  int candidate_count = 0;
  for (int i = 0; i < 6; ++i)
    if (ranges.least[i] <= bound) candidates[candidate_count++] = i;

  for (int a = 0; a < candidate_count; ++a) {
    const int i = candidates[a];
    if (!(cells >> i & 1u)) continue;
    Clipper cell(inside.polygon());
    bool owned = true;
    for (int b = 0; b < candidate_count && owned; ++b) {
      const int j = candidates[b];
      // The opposite plane is no neighbour where the depth cannot reach the middle of Y.
      if (j == i || (j == (i ^ 1) && bound < x.half_y[i / 2])) continue;
      const Affine farther{g[j].c - g[i].c, g[j].u - g[i].u, g[j].v - g[i].v};
      const bool tied = std::abs(farther.c) + std::abs(farther.u) * half_u + std::abs(farther.v) * half_v <= x.sheet;
      if (!tied) cell.clip(farther);
      owned = tied ? i < j : !cell.empty();
    }
    if (!owned) continue;
    Piece& piece = pieces.piece[pieces.count++];
    piece.surface = surface;
    piece.face = face;
    piece.cell = i;
    piece.depth = g[i];
    piece.polygon.count = cell.polygon().count;
    for (int n = 0; n < piece.polygon.count; ++n) piece.polygon.vertex[n] = cell.polygon().vertex[n];
    pieces.deepest = std::max(pieces.deepest, bound);
  }
}

}  // namespace

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

PieceMask possible_pieces(const Box& a, const Box& b, const Pose& X_AB) {
  const std::array<Seen, 2> seen = both_ways(a, b, X_AB);
  PieceMask mask;
  for (const Surface surface : {Surface::of_a, Surface::of_b})
    for (int face = 0; face < 6; ++face) {
      const Ranges ranges = ranges_over_rectangle(seen[static_cast<int>(surface)], face);
      const double bound = ranges.bound();
      if (bound <= 0) continue;
      for (int cell = 0; cell < 6; ++cell)
        if (ranges.least[cell] <= bound) mask.set(piece_index(surface, face, cell));
    }
  return mask;
}

void cut_pieces(const Box& a, const Box& b, const Pose& X_AB, const PieceMask& named, Pieces& pieces) {
  const std::array<Seen, 2> seen = both_ways(a, b, X_AB);
  const PieceMask one_face(0b111111);
  for (const Surface surface : {Surface::of_a, Surface::of_b})
    for (int face = 0; face < 6; ++face) {
      const PieceMask cells = named >> piece_index(surface, face, 0) & one_face;
      if (cells.any())
        cut_face(surface, face, seen[static_cast<int>(surface)], static_cast<unsigned>(cells.to_ulong()), pieces);
    }
}

}  // namespace quayside::contact_nn
