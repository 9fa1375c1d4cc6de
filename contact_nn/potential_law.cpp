#include "contact_nn/potential_law.h"

#include <algorithm>
#include <cmath>

#include "contact_nn/lanes.h"
#include "contact_nn/separating_axes.h"
#include "contact_nn/triangle_moments.h"

namespace quayside::contact_nn {
namespace {

using Eigen::Vector3d;

// x^(2/p) by square roots.
double small_root(double x) {
  static_assert((kNorm & (kNorm - 1)) == 0, "p must be a power of two");
  for (int p = kNorm; p > 2; p /= 2) x = std::sqrt(x);
  return x;
}

// Moments of eight pieces, each cut into a fan of triangles around its first vertex. `unit` [m] is what depths are measured
// in.
Moments moments_of(const EightPieces& pieces, double unit) {
  const double scale = 1 / unit;
  const Eight u0 = load_eight(pieces.u[0]), v0 = load_eight(pieces.v[0]), c = scale * load_eight(pieces.depth[0].data()),
              slope_u = scale * load_eight(pieces.depth[1].data()), slope_v = scale * load_eight(pieces.depth[2].data());
  const auto scaled_depth = [&](const Eight& u, const Eight& v) {
    return larger(Eight{}, c + slope_u * u + slope_v * v);
  };
  Moments moments{};
  Triangles triangles;
  triangles.f0 = scaled_depth(u0, v0);
  for (int k = 1; k < pieces.vertices; ++k) {
    const Eight u = load_eight(pieces.u[k]), v = load_eight(pieces.v[k]);
    triangles.u2 = u - u0;
    triangles.v2 = v - v0;
    triangles.f2 = scaled_depth(u, v);
    if (k > 1) add_triangles(triangles, moments);
    triangles.u1 = triangles.u2;
    triangles.v1 = triangles.v2;
    triangles.f1 = triangles.f2;
  }
  return moments;
}

using AllMoments = std::array<Moments, kPieceCount / kEight>;

// ∫φ^p over all pieces, in units of the deepest so that φ^p neither overflows nor vanishes.
double take_moments(const Pieces& pieces, AllMoments& moments) {
  Eight potential{};
  for (int i = 0; i < pieces.eights(); ++i) {
    moments[i] = moments_of(pieces.eight[i], pieces.deepest);
    potential += moments[i].potential;
  }
  return sum(potential);
}

// Eight vectors, or one for eight.
struct Vectors {
  Eight x, y, z;
  Vectors() : x{}, y{}, z{} {}
  Vectors(const Eight& x, const Eight& y, const Eight& z) : x(x), y(y), z(z) {}
  explicit Vectors(const Vector3d& v) : x(eight(v[0])), y(eight(v[1])), z(eight(v[2])) {}
  void operator+=(const Vectors& v) { x += v.x, y += v.y, z += v.z; }
};
Vectors operator+(const Vectors& a, const Vectors& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vectors operator*(const Eight& s, const Vectors& v) { return {s * v.x, s * v.y, s * v.z}; }
Eight dot(const Vectors& a, const Vectors& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vectors cross(const Vectors& a, const Vectors& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Eight pieces as they lie in A. Points are from A's centre.
struct Placed {
  Vectors first;             // each piece's first vertex
  Vectors along_u, along_v;  // its face's coordinate axes
  Vectors push;              // where its pressure pushes B
};

// The boxes' axes and centres in A, to place pieces by.
struct Places {
  Places(const Box& a, const Box& b, const Pose& X_AB) : half{&a.half, &b.half} {
    axes[0][0] = four(1, 0, 0), axes[0][1] = four(0, 1, 0), axes[0][2] = four(0, 0, 1);
    for (int k = 0; k < 3; ++k) axes[1][k] = load_four(X_AB.matrix().col(k).data());
    centre[0] = Four{}, centre[1] = load_four(X_AB.matrix().col(3).data());
  }

  Placed place(const Pieces& pieces, int i) const {
    alignas(64) double row[2][kEight][8];  // a piece to a row: first and push; along_u and along_v
    const EightPieces& eight = pieces.eight[i];
    for (int lane = 0; lane < kEight; ++lane) {
      const PieceName& piece = pieces.name[std::min(kEight * i + lane, pieces.count - 1)];
      const int x = static_cast<int>(piece.surface), k = piece.face / 2, m = piece.cell / 2;
      const Four &u = axes[x][(k + 1) % 3], &v = axes[x][(k + 2) % 3], &n = axes[1 - x][m];
      const double height = piece.face % 2 ? -(*half[x])[k] : (*half[x])[k];
      // A's surface is pushed out of B through the cell's face, so B goes the other way.
      const bool outward = (piece.surface == Surface::of_a) == (piece.cell % 2 == 1);
      store_four(centre[x] + height * axes[x][k] + eight.u[0][lane] * u + eight.v[0][lane] * v, row[0][lane]);
      store_four(outward ? n : -n, row[0][lane] + 4);
      store_four(u, row[1][lane]);
      store_four(v, row[1][lane] + 4);
    }
    Eight first[kEight], second[kEight];
    for (int lane = 0; lane < kEight; ++lane) {
      first[lane] = load_eight(row[0][lane]);
      second[lane] = load_eight(row[1][lane]);
    }
    transpose(first);
    transpose(second);
    return {{first[0], first[1], first[2]}, {second[0], second[1], second[2]}, {second[4], second[5], second[6]},
            {first[4], first[5], first[6]}};
  }

  const Vector3d* half[2];
  Four axes[2][3], centre[2];
};

// An affine function of the coordinates from a piece's first vertex.
struct AffineFromFirst {
  Eight c, u, v;
};

// ∫ w (1 + c s) over a piece and its first moments.
struct Pressure {
  Eight one, u, v;
};

Pressure pressure(const Moments& w, double c, const AffineFromFirst& s) {
  return {w.one + c * (s.c * w.one + s.u * w.u + s.v * w.v), w.u + c * (s.c * w.u + s.u * w.uu + s.v * w.uv),
          w.v + c * (s.c * w.v + s.u * w.uv + s.v * w.vv)};
}

// The pressure with the factor (1 + c s)₊: nothing ever pulls, not even one end of a rocking face. Where the factor turns
// negative the polygon is cut along its zero line, so the force stays exact and continuous.
Pressure damped_pressure(const EightPieces& pieces, double unit, const Moments& w, double c, const AffineFromFirst& s) {
  Pressure result = pressure(w, c, s);
  const Eight u0 = load_eight(pieces.u[0]), v0 = load_eight(pieces.v[0]);
  Eight slowest = s.c;
  for (int k = 1; k < pieces.vertices; ++k)
    slowest = smaller(slowest, s.c + s.u * (load_eight(pieces.u[k]) - u0) + s.v * (load_eight(pieces.v[k]) - v0));
  const Eight pull = -1 - c * slowest;  // positive where some part of a piece pulls
  if (least(-pull) >= 0) return result;

  EightPieces pressed;
  clip_pieces(pieces, 1 + c * (s.c - s.u * u0 - s.v * v0), c * s.u, c * s.v, pressed);
  const Eight du = load_eight(pressed.u[0]) - u0, dv = load_eight(pressed.v[0]) - v0;
  const Pressure part = pressure(moments_of(pressed, unit), c, {s.c + s.u * du + s.v * dv, s.u, s.v});
  result.one = if_positive(pull, part.one, result.one);
  result.u = if_positive(pull, part.u + du * part.one, result.u);
  result.v = if_positive(pull, part.v + dv * part.one, result.v);
  return result;
}

// Polar moment of the elastic pressure about the axis n through c, over its sum.
double polar_moment(const Pieces& pieces, const AllMoments& moments, const Places& places, const Vector3d& n, const Vector3d& c) {
  const Vectors axis(n), back(Vector3d(-c));
  const auto across = [&](const Vectors& x) { return x + -dot(x, axis) * axis; };
  Eight polar{}, load{};
  for (int i = 0; i < pieces.eights(); ++i) {
    const Moments& w = moments[i];
    const Placed piece = places.place(pieces, i);
    const Vectors d = across(piece.first + back), u = across(piece.along_u), v = across(piece.along_v);
    polar += w.one * dot(d, d) + w.uu * dot(u, u) + w.vv * dot(v, v) +
             2 * (w.u * dot(d, u) + w.v * dot(d, v) + w.uv * dot(u, v));
    load += w.one;
  }
  return std::max(0.0, sum(polar) / sum(load));
}

}  // namespace

// Force and torque of a piece with outward normal n of Y's face i are σ M₀ n and σ M₁ × n on X, with
// σ = ½ K A_f^(−2/p) I^(2/p − 1), M₀ = ∫φ^(p−1), M₁ = ∫φ^(p−1) x; the other box gets the opposite at the same points.
//
// Damping multiplies the weight by (1 + c s)₊, s the approach speed along n at each point, so rocking is damped as
// well.
//
// Friction acts per piece at the centre x̄ of its elastic pressure, with torsion: with N the piece's load, v_t the
// sliding velocity at x̄, ω_n the spin about n and r² the polar moment of the elastic pressure about x̄ over its sum, F
// = −k v_t and T = −k r² ω_n n with k = μ N / √(|v_t|² + r² ω_n² + v_t0²). It takes the power k (|v_t|² + r² ω_n²).
ContactForce potential_force(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                             const LawParameters& law, const PieceMask& named) {
  Pieces pieces;
  cut_pieces(a, b, X_AB, named, pieces);
  ContactForce result;
  if (pieces.deepest <= 0) return result;
  AllMoments moments;
  const double unit = pieces.deepest;
  const double integral = 0.5 * take_moments(pieces, moments);  // I = integral · unit^p
  if (integral <= 0) return result;
  const double stiffness = law.stiffness * small_root(integral / kReferenceArea);
  const double sigma = 0.5 * stiffness * unit / integral;  // for φ^(p−1) in units of unit^(p−1)
  result.touching = true;
  result.potential_energy = 0.5 * stiffness * unit * unit;

  const Places places(a, b, X_AB);
  const Vectors w_A(V_AB.w_A), v_A(V_AB.v_A - V_AB.w_A.cross(X_AB.translation()));  // B's motion: of its point at A's centre
  Vectors force, torque, elastic_moment;  // a piece, or what one in eight of them add up to, to each lane
  Eight elastic{}, normal{}, power{};
  for (int i = 0; i < pieces.eights(); ++i) {
    const Moments& w = moments[i];
    const Placed piece = places.place(pieces, i);
    const Eight inverse = if_positive(w.one, 1 / w.one, Eight{});  // zero: no piece, or a sliver within rounding
    const Eight mean_u = w.u * inverse, mean_v = w.v * inverse;
    const Vectors centre = piece.first + mean_u * piece.along_u + mean_v * piece.along_v;
    elastic += w.one;
    elastic_moment += w.one * centre;

    const Vectors slope = cross(piece.push, w_A);
    const AffineFromFirst approach{-dot(piece.push, v_A + cross(w_A, piece.first)), -dot(slope, piece.along_u),
                                   -dot(slope, piece.along_v)};
    Pressure load{w.one, w.u, w.v};
    if (law.damping > 0) {
      load = damped_pressure(pieces.eight[i], unit, w, law.damping, approach);
      const Eight taken = approach.c * (load.one - w.one) + approach.u * (load.u - w.u) + approach.v * (load.v - w.v);
      power += larger(Eight{}, taken);  // below zero by rounding only
    }
    normal += load.one;
    force += load.one * piece.push;
    const Vectors moment = load.one * piece.first + load.u * piece.along_u + load.v * piece.along_v;
    torque += cross(moment, piece.push);

    if (law.friction > 0) {
      const Eight r2 = larger(Eight{}, (w.uu + w.vv) * inverse - mean_u * mean_u - mean_v * mean_v);
      const Vectors v = v_A + cross(w_A, centre), v_t = v + -dot(v, piece.push) * piece.push;
      const Eight spin = dot(w_A, piece.push), squared = dot(v_t, v_t) + r2 * spin * spin;
      const Eight factor = law.friction * load.one / square_root(squared + law.transition_speed * law.transition_speed);
      force += -factor * v_t;
      torque += -factor * (cross(centre, v_t) + r2 * spin * piece.push);
      power += factor * squared;
    }
  }

  Eight wrench[kEight] = {force.x, force.y, force.z, torque.x, torque.y, torque.z, normal, power};
  const Eight total = sigma * sums(wrench);
  result.f_A = {total[0], total[1], total[2]};
  result.t_A = {total[3], total[4], total[5]};
  result.normal_force = total[6];
  result.dissipated_power = total[7];
  const Vector3d moment(sum(elastic_moment.x), sum(elastic_moment.y), sum(elastic_moment.z));
  result.impact_point_A = moment / sum(elastic);
  if (const double f = result.f_A.norm(); law.pressure_radius && f > 0) {
    result.pressure_radius2 = polar_moment(pieces, moments, places, result.f_A / f, result.impact_point_A);
  }
  return result;
}

ContactForce potential_force(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                             const LawParameters& law) {
  if (surely_apart(a, b, X_AB)) return {};
  return potential_force(a, b, X_AB, V_AB, law, all_pieces());
}

std::array<double, kPieceCount> piece_loads(const Box& a, const Box& b, const Pose& X_AB) {
  std::array<double, kPieceCount> loads{};
  if (surely_apart(a, b, X_AB)) return loads;
  Pieces pieces;
  cut_pieces(a, b, X_AB, all_pieces(), pieces);
  if (pieces.deepest <= 0) return loads;
  AllMoments moments;
  take_moments(pieces, moments);
  const auto load = [&](int k) { return std::max(0.0, moments[k / kEight].one[k % kEight]); };
  double sum = 0;
  for (int k = 0; k < pieces.count; ++k) sum += load(k);
  if (sum == 0) return loads;
  for (int k = 0; k < pieces.count; ++k) {
    const PieceName& piece = pieces.name[k];
    loads[piece_index(piece.surface, piece.face, piece.cell)] = load(k) / sum;
  }
  return loads;
}

}  // namespace quayside::contact_nn
