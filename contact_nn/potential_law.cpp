#include "contact_nn/potential_law.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "contact_nn/separating_axes.h"

// How the law is evaluated. Each face of X is a rectangle with coordinates (u, v), on which the distances g_j to the
// six planes of Y are affine functions. The rectangle is clipped to g_j ≥ 0, then split into the cells in which one
// plane i is the nearest, g_j − g_i ≥ 0. Every cell is a convex polygon on which φ = g_i is affine, so it is cut into
// a fan of triangles whose moments are known in closed form. Depths are taken in units of the deepest vertex, so
// that φ^p neither overflows nor vanishes.

namespace quayside::contact_nn {
namespace {

using Eigen::Vector3d;

// Every edge of a cell lies on another line: 4 sides, 6 planes, 5 neighbours, and the damping's cut.
constexpr int kMaxVertices = 16;

// Rounding of g_j − g_i in units of ε times the size of the boxes [1]. A face that lies in the sheet between two cells
// to within it belongs to the lower cell as a whole, so that it is counted once.
constexpr double kSheetRounding = 16;

struct Affine {
  double c, u, v;  // c + u · (first coordinate) + v · (second)
  double at(double x, double y) const { return c + u * x + v * y; }
};

struct Polygon {
  int count;
  std::array<double, kMaxVertices> u, v;
};

// Keeps the part where f ≥ 0. `values` are those of f at the vertices.
void clip(const Polygon& in, const std::array<double, kMaxVertices>& values, Polygon& out) {
  int n = 0;
  double u = in.u[in.count - 1], v = in.v[in.count - 1], f = values[in.count - 1];
  for (int k = 0; k < in.count; ++k) {
    const double next_u = in.u[k], next_v = in.v[k], next_f = values[k];
    if ((f >= 0) != (next_f >= 0)) {
      const double t = f / (f - next_f);
      assert(n < kMaxVertices);
      out.u[n] = u + t * (next_u - u);
      out.v[n] = v + t * (next_v - v);
      ++n;
    }
    if (next_f >= 0) {
      assert(n < kMaxVertices);
      out.u[n] = next_u;
      out.v[n] = next_v;
      ++n;
    }
    u = next_u;
    v = next_v;
    f = next_f;
  }
  out.count = n;
}

void clip(Polygon& polygon, const Affine& f) {
  std::array<double, kMaxVertices> values;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < polygon.count; ++k) {
    values[k] = f.at(polygon.u[k], polygon.v[k]);
    least = std::min(least, values[k]);
  }
  if (least >= 0) return;
  Polygon kept;
  clip(polygon, values, kept);
  polygon.count = kept.count;
  std::copy_n(kept.u.begin(), kept.count, polygon.u.begin());
  std::copy_n(kept.v.begin(), kept.count, polygon.v.begin());
}

// Face `face` of box X as seen from box Y.
struct Face {
  Face(const Vector3d& half_x, const Pose& X_YX, int face) {
    const int k = face / 2, k_u = (k + 1) % 3, k_v = (k + 2) % 3;
    const double h = face % 2 ? -half_x[k] : half_x[k];
    half_u = half_x[k_u];
    half_v = half_x[k_v];
    for (int m = 0; m < 3; ++m)
      y[m] = {X_YX.translation()[m] + X_YX.linear()(m, k) * h, X_YX.linear()(m, k_u), X_YX.linear()(m, k_v)};
  }
  double reach(int m) const { return std::abs(y[m].u) * half_u + std::abs(y[m].v) * half_v; }

  double half_u, half_v;
  std::array<Affine, 3> y;  // position in Y [m]
};

// Distance to Y's face j inside Y.
Affine inside_distance(const Face& f, const Vector3d& half_y, int j) {
  const Affine& y = f.y[j / 2];
  return j % 2 ? Affine{half_y[j / 2] + y.c, y.u, y.v} : Affine{half_y[j / 2] - y.c, -y.u, -y.v};
}

struct Piece {
  Surface surface;
  int face, cell;
  int first, count;  // its vertices in `Pieces`
  Affine depth;
};

struct Pieces {
  int count = 0, vertex_count = 0;
  double deepest = 0;
  std::array<Piece, kPieceCount> piece;
  std::array<double, kPieceCount * kMaxVertices> u, v, depth;
};

// Adds the pieces of one face of X whose cells are in `cells` (bit i: face i of Y).
void cut_face(Surface surface, int face_number, const Vector3d& half_x, const Vector3d& half_y, const Pose& X_YX,
              unsigned cells, Pieces& pieces) {
  const Face face(half_x, X_YX, face_number);
  double reach[3];
  for (int m = 0; m < 3; ++m) {
    reach[m] = face.reach(m);
    if (std::abs(face.y[m].c) - reach[m] >= half_y[m]) return;
  }

  Polygon inside{4, {-face.half_u, face.half_u, face.half_u, -face.half_u},
                 {-face.half_v, -face.half_v, face.half_v, face.half_v}};
  for (int j = 0; j < 6; ++j) {
    const int m = j / 2;
    const double towards = j % 2 ? -face.y[m].c : face.y[m].c;
    if (towards + reach[m] <= half_y[m]) continue;  // no part of the face is beyond plane j
    clip(inside, inside_distance(face, half_y, j));
    if (inside.count < 3) return;
  }

  // Distances to all planes at the vertices, and their ranges.
  std::array<std::array<double, kMaxVertices>, 6> g;
  std::array<double, 6> least, most;
  for (int m = 0; m < 3; ++m) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (int k = 0; k < inside.count; ++k) {
      const double y = face.y[m].at(inside.u[k], inside.v[k]);
      g[2 * m][k] = half_y[m] - y;
      g[2 * m + 1][k] = half_y[m] + y;
      low = std::min(low, y);
      high = std::max(high, y);
    }
    least[2 * m] = half_y[m] - high;
    most[2 * m] = half_y[m] - low;
    least[2 * m + 1] = half_y[m] + low;
    most[2 * m + 1] = half_y[m] + high;
  }
  const double nearest_most = *std::min_element(most.begin(), most.end());
  const double sheet = kSheetRounding * std::numeric_limits<double>::epsilon() *
                       (half_x.sum() + half_y.sum() + X_YX.translation().lpNorm<1>());

  for (int i = 0; i < 6; ++i) {
    if (!(cells >> i & 1u) || most[i] <= 0 || least[i] > nearest_most) continue;
    Polygon cell = inside;
    const Affine g_i = inside_distance(face, half_y, i);
    for (int j = 0; j < 6 && cell.count >= 3; ++j) {
      if (j == i || least[j] > most[i]) continue;
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (int k = 0; k < inside.count; ++k) {
        low = std::min(low, g[j][k] - g[i][k]);
        high = std::max(high, g[j][k] - g[i][k]);
      }
      const bool tied = -sheet <= low && high <= sheet;
      if (tied ? j < i : high <= 0) cell.count = 0;
      if (tied || low >= 0) continue;
      const Affine g_j = inside_distance(face, half_y, j);
      if (cell.count >= 3) clip(cell, {g_j.c - g_i.c, g_j.u - g_i.u, g_j.v - g_i.v});
    }
    if (cell.count < 3) continue;

    pieces.piece[pieces.count++] = {surface, face_number, i, pieces.vertex_count, cell.count, g_i};
    for (int k = 0; k < cell.count; ++k, ++pieces.vertex_count) {
      const double depth = std::max(0.0, g_i.at(cell.u[k], cell.v[k]));
      pieces.u[pieces.vertex_count] = cell.u[k];
      pieces.v[pieces.vertex_count] = cell.v[k];
      pieces.depth[pieces.vertex_count] = depth;
      pieces.deepest = std::max(pieces.deepest, depth);
    }
  }
}

void cut_all(const Box& a, const Box& b, const Pose& X_AB, const PieceMask& mask, Pieces& pieces) {
  const Pose X_BA = X_AB.inverse(Eigen::Isometry);
  for (const Surface surface : {Surface::of_a, Surface::of_b}) {
    const bool of_a = surface == Surface::of_a;
    for (int face = 0; face < 6; ++face) {
      unsigned cells = 0;
      for (int cell = 0; cell < 6; ++cell) cells |= unsigned{mask[piece_index(surface, face, cell)]} << cell;
      if (cells == 0) continue;
      cut_face(surface, face, of_a ? a.half : b.half, of_a ? b.half : a.half, of_a ? X_BA : X_AB, cells, pieces);
    }
  }
}

// Moments of the weight φ^(p−1) over a piece, φ in units of the deepest vertex, lengths in m from the first vertex.
struct Moments {
  double potential = 0;          // ∫ φ^p
  double one = 0;                // ∫ φ^(p−1)
  double u = 0, v = 0;           // first
  double uu = 0, uv = 0, vv = 0; // second
};

// Closed-form moments of eight triangles at a time. With vertex depths f, area a, m = p − 1, and h_m the complete
// homogeneous symmetric polynomial: ∫φ^m = 2a m!/(m+2)! h_m(f₀,f₁,f₂); ∫φ^m λ_i = 2a m!/(m+3)! h_m(f₀,f₁,f₂,f_i);
// ∫φ^m λ_i λ_j = 2a m! (1+δ_ij)/(m+4)! h_m(f₀,f₁,f₂,f_i,f_j), λ barycentric. All terms are positive: nothing cancels.
// A variable x is appended to h by h_k(…, x) = h_k(…) + x h_(k−1)(…, x).
class TriangleMoments {
 public:
  // Triangle with vertices 0, (u1, v1), (u2, v2) and these depths.
  void add(Moments& target, double f0, double u1, double v1, double f1, double u2, double v2, double f2) {
    f0_[filled_] = f0, f1_[filled_] = f1, f2_[filled_] = f2;
    u1_[filled_] = u1, v1_[filled_] = v1, u2_[filled_] = u2, v2_[filled_] = v2;
    target_[filled_] = &target;
    if (++filled_ == kLanes) flush();
  }

  void flush() {
    if (filled_ == 0) return;
    constexpr double m = kNorm - 1;
    Lanes power = Lanes::Ones(), h01 = Lanes::Ones(), h = h01, h1 = h01, h2 = h01, h11 = h01, h12 = h01, h22 = h01;
    for (int k = 0; k < kNorm - 1; ++k) {
      power *= f0_;
      h01 = power + f1_ * h01;
      h = h01 + f2_ * h;
      h1 = h + f1_ * h1;
      h2 = h + f2_ * h2;
      h11 = h1 + f1_ * h11;
      h12 = h1 + f2_ * h12;
      h22 = h2 + f2_ * h22;
    }
    const Lanes h_next = power * f0_ + f1_ * h01 + f2_ * h;  // of order p
    const Lanes twice_area = u1_ * v2_ - u2_ * v1_;
    const Lanes one = twice_area / ((m + 1) * (m + 2));
    const Lanes first = one / (m + 3), second = first / (m + 4);
    const Lanes potential = one * h_next * ((m + 1) / (m + 3));
    const Lanes w = one * h, w1 = first * h1, w2 = first * h2;
    const Lanes w11 = 2 * second * h11, w12 = second * h12, w22 = 2 * second * h22;
    const Lanes u = w1 * u1_ + w2 * u2_, v = w1 * v1_ + w2 * v2_;
    const Lanes uu = w11 * u1_ * u1_ + 2 * w12 * u1_ * u2_ + w22 * u2_ * u2_;
    const Lanes uv = w11 * u1_ * v1_ + w12 * (u1_ * v2_ + u2_ * v1_) + w22 * u2_ * v2_;
    const Lanes vv = w11 * v1_ * v1_ + 2 * w12 * v1_ * v2_ + w22 * v2_ * v2_;
    for (int k = 0; k < filled_; ++k) {
      Moments& target = *target_[k];
      target.potential += potential[k];
      target.one += w[k];
      target.u += u[k];
      target.v += v[k];
      target.uu += uu[k];
      target.uv += uv[k];
      target.vv += vv[k];
    }
    filled_ = 0;
  }

 private:
  static constexpr int kLanes = 8;
  using Lanes = Eigen::Array<double, kLanes, 1>;
  int filled_ = 0;
  Lanes f0_ = Lanes::Zero(), f1_ = f0_, f2_ = f0_, u1_ = f0_, v1_ = f0_, u2_ = f0_, v2_ = f0_;
  std::array<Moments*, kLanes> target_;
};

// Adds the fan of a convex polygon, given by coordinates and depths, around its first vertex.
void add_fan(const double* u, const double* v, const double* depth, int count, double scale, TriangleMoments& triangles,
             Moments& target) {
  for (int k = 1; k + 1 < count; ++k)
    triangles.add(target, depth[0] * scale, u[k] - u[0], v[k] - v[0], depth[k] * scale, u[k + 1] - u[0],
                  v[k + 1] - v[0], depth[k + 1] * scale);
}

std::array<Moments, kPieceCount> all_moments(const Pieces& pieces) {
  std::array<Moments, kPieceCount> moments;
  TriangleMoments triangles;
  const double scale = 1 / pieces.deepest;
  for (int k = 0; k < pieces.count; ++k) {
    const Piece& piece = pieces.piece[k];
    moments[k] = {};
    add_fan(&pieces.u[piece.first], &pieces.v[piece.first], &pieces.depth[piece.first], piece.count, scale, triangles,
            moments[k]);
  }
  triangles.flush();
  return moments;
}

// Where a piece is in A: point = origin + du · e_u + dv · e_v, du and dv from its first vertex. `n` is the direction
// in which the pressure pushes B.
struct PieceFrame {
  PieceFrame(const Piece& piece, const Pieces& pieces, const Box& a, const Box& b, const Pose& X_AB) {
    const int k = piece.face / 2, k_u = (k + 1) % 3, k_v = (k + 2) % 3;
    const double face_sign = piece.face % 2 ? -1 : 1, cell_sign = piece.cell % 2 ? -1 : 1;
    const bool of_a = piece.surface == Surface::of_a;
    Vector3d local;
    local[k] = face_sign * (of_a ? a : b).half[k];
    local[k_u] = pieces.u[piece.first];
    local[k_v] = pieces.v[piece.first];
    const auto& R = X_AB.linear();
    if (of_a) {  // A's surface is pushed out of B through B's face, so B is pushed the other way
      origin = local;
      e_u = Vector3d::Unit(k_u);
      e_v = Vector3d::Unit(k_v);
      n = -cell_sign * R.col(piece.cell / 2);
    } else {
      origin = X_AB * local;
      e_u = R.col(k_u);
      e_v = R.col(k_v);
      n = cell_sign * Vector3d::Unit(piece.cell / 2);
    }
  }
  Vector3d origin, e_u, e_v, n;
};

// ∫ w (1 + c s) over a piece and its first moments.
struct Pressure {
  double one, u, v;
};

Pressure pressure(const Moments& w, double c, const Affine& s) {
  return {w.one + c * (s.c * w.one + s.u * w.u + s.v * w.v), w.u + c * (s.c * w.u + s.u * w.uu + s.v * w.uv),
          w.v + c * (s.c * w.v + s.u * w.uv + s.v * w.vv)};
}

// The same for the factor (1 + c s)₊: nothing ever pulls, not even one end of a rocking face. Where the factor turns
// negative the polygon is cut along its zero line, so the force stays continuous and exact. s is the approach speed,
// as a function of the coordinates from the piece's first vertex.
Pressure damped_pressure(const Piece& piece, const Pieces& pieces, const Moments& w, double c, const Affine& s) {
  const double *u = &pieces.u[piece.first], *v = &pieces.v[piece.first];
  std::array<double, kMaxVertices> factor;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < piece.count; ++k) {
    factor[k] = 1 + c * s.at(u[k] - u[0], v[k] - v[0]);
    least = std::min(least, factor[k]);
  }
  if (least >= 0) return pressure(w, c, s);

  Polygon whole, pressed;
  whole.count = piece.count;
  std::copy_n(u, piece.count, whole.u.begin());
  std::copy_n(v, piece.count, whole.v.begin());
  clip(whole, factor, pressed);
  if (pressed.count < 3) return {0, 0, 0};
  std::array<double, kMaxVertices> depth;
  for (int k = 0; k < pressed.count; ++k) depth[k] = std::max(0.0, piece.depth.at(pressed.u[k], pressed.v[k]));
  Moments part;
  TriangleMoments triangles;
  add_fan(pressed.u.data(), pressed.v.data(), depth.data(), pressed.count, 1 / pieces.deepest, triangles, part);
  triangles.flush();
  const double du = pressed.u[0] - u[0], dv = pressed.v[0] - v[0];  // its own first vertex, seen from the piece's
  Pressure result = pressure(part, c, {s.at(du, dv), s.u, s.v});
  result.u += du * result.one;
  result.v += dv * result.one;
  return result;
}

// Speed that a point of B at p_A has relative to A.
Vector3d velocity_at(const Vector3d& p_A, const Vector3d& p_AB, const RelativeVelocity& V) {
  return V.v_A + V.w_A.cross(p_A - p_AB);
}

}  // namespace

// Force and torque of a piece with outward normal n of Y's face i are σ M₀ n and σ M₁ × n on X, with
// σ = ½ K A_f^(−2/p) I^(2/p − 1), M₀ = ∫φ^(p−1), M₁ = ∫φ^(p−1) x; B's wrench is minus A's by construction.
//
// Damping multiplies the weight by (1 + c s)₊, s the approach speed along n at each point, so rocking is damped as well.
//
// Friction acts per piece at its centre of pressure x̄, with torsion: with N the piece's load, v_t the sliding velocity at
// x̄, ω_n the spin about n and r² the polar moment of the pressure about x̄ over N, F = −k v_t and T = −k r² ω_n with
// k = μ N / √(|v_t|² + r² ω_n² + v_t0²). It takes the power k (|v_t|² + r² ω_n²).
ContactForce potential_force(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                             const LawParameters& law, const PieceMask& mask) {
  Pieces pieces;
  cut_all(a, b, X_AB, mask, pieces);
  ContactForce result;
  if (pieces.deepest == 0) return result;
  const std::array<Moments, kPieceCount> moments = all_moments(pieces);

  double integral = 0;  // I, φ in units of the deepest vertex d: I = d^p · integral
  for (int k = 0; k < pieces.count; ++k) integral += 0.5 * moments[k].potential;
  if (integral <= 0) return result;
  const double d = pieces.deepest, root = std::pow(integral / kReferenceArea, 2.0 / kNorm);
  result.touching = true;
  result.potential_energy = 0.5 * law.stiffness * d * d * root;
  const double sigma = 0.5 * law.stiffness * d * root / integral;  // times φ^(p−1) in units of d^(p−1)

  const Vector3d p_AB = X_AB.translation();
  Vector3d centre = Vector3d::Zero();
  double elastic_load = 0;
  for (int k = 0; k < pieces.count; ++k) {
    const Moments& w = moments[k];
    if (w.one <= 0) continue;  // a sliver below rounding
    const Piece& piece = pieces.piece[k];
    const PieceFrame frame(piece, pieces, a, b, X_AB);
    const Vector3d first_moment = frame.origin * w.one + frame.e_u * w.u + frame.e_v * w.v;
    centre += sigma * first_moment;
    elastic_load += sigma * w.one;

    Pressure load{w.one, w.u, w.v};
    if (law.damping > 0) {
      const Affine approach{-frame.n.dot(velocity_at(frame.origin, p_AB, V_AB)),
                            -frame.n.dot(V_AB.w_A.cross(frame.e_u)), -frame.n.dot(V_AB.w_A.cross(frame.e_v))};
      load = damped_pressure(piece, pieces, w, law.damping, approach);
      const double power = approach.c * (load.one - w.one) + approach.u * (load.u - w.u) + approach.v * (load.v - w.v);
      result.dissipated_power += std::max(0.0, sigma * power);  // below zero by rounding only
    }
    const double N = sigma * load.one;
    result.normal_force += N;
    result.f_A += N * frame.n;
    result.t_A += sigma * (frame.origin * load.one + frame.e_u * load.u + frame.e_v * load.v).cross(frame.n);

    if (law.friction > 0) {
      const double mean_u = w.u / w.one, mean_v = w.v / w.one;
      const double r2 = std::max(0.0, (w.uu + w.vv) / w.one - mean_u * mean_u - mean_v * mean_v);
      const Vector3d at = first_moment / w.one;
      const Vector3d v = velocity_at(at, p_AB, V_AB), v_t = v - frame.n * frame.n.dot(v);
      const double spin = frame.n.dot(V_AB.w_A);
      const double squared = v_t.squaredNorm() + r2 * spin * spin;
      const double factor = law.friction * N / std::sqrt(squared + law.transition_speed * law.transition_speed);
      result.f_A -= factor * v_t;
      result.t_A -= factor * (at.cross(v_t) + r2 * spin * frame.n);
      result.dissipated_power += factor * squared;
    }
  }
  result.impact_point_A = centre / elastic_load;
  return result;
}

ContactForce potential_force(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                             const LawParameters& law) {
  if (surely_apart(a, b, X_AB)) return {};
  return potential_force(a, b, X_AB, V_AB, law, all_pieces());
}

PieceMask possible_pieces(const Box& a, const Box& b, const Pose& X_AB) {
  const Pose X_BA = X_AB.inverse(Eigen::Isometry);
  PieceMask mask;
  for (const Surface surface : {Surface::of_a, Surface::of_b}) {
    const bool of_a = surface == Surface::of_a;
    const Vector3d &half_x = of_a ? a.half : b.half, &half_y = of_a ? b.half : a.half;
    for (int f = 0; f < 6; ++f) {
      const Face face(half_x, of_a ? X_BA : X_AB, f);
      std::array<double, 6> least, most;  // ranges of the distances to Y's planes over the rectangle
      for (int m = 0; m < 3; ++m) {
        const double c = face.y[m].c, reach = face.reach(m);
        least[2 * m] = half_y[m] - c - reach;
        most[2 * m] = half_y[m] - c + reach;
        least[2 * m + 1] = half_y[m] + c - reach;
        most[2 * m + 1] = half_y[m] + c + reach;
      }
      const double nearest_most = *std::min_element(most.begin(), most.end());
      if (nearest_most <= 0) continue;  // beyond one of the planes
      for (int cell = 0; cell < 6; ++cell)
        if (least[cell] <= nearest_most) mask.set(piece_index(surface, f, cell));
    }
  }
  return mask;
}

std::array<double, kPieceCount> piece_loads(const Box& a, const Box& b, const Pose& X_AB) {
  std::array<double, kPieceCount> loads{};
  if (surely_apart(a, b, X_AB)) return loads;
  Pieces pieces;
  cut_all(a, b, X_AB, all_pieces(), pieces);
  if (pieces.deepest == 0) return loads;
  const std::array<Moments, kPieceCount> moments = all_moments(pieces);
  double sum = 0;
  for (int k = 0; k < pieces.count; ++k) sum += moments[k].one;
  if (sum == 0) return loads;
  for (int k = 0; k < pieces.count; ++k) {
    const Piece& piece = pieces.piece[k];
    loads[piece_index(piece.surface, piece.face, piece.cell)] = moments[k].one / sum;
  }
  return loads;
}

}  // namespace quayside::contact_nn
