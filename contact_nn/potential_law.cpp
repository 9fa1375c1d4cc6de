#include "contact_nn/potential_law.h"

#include <algorithm>
#include <cmath>

#include "contact_nn/separating_axes.h"
#include "contact_nn/triangle_moments.h"

namespace quayside::contact_nn {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// x^(2/p) by square roots.
double small_root(double x) {
  static_assert((kNorm & (kNorm - 1)) == 0, "p must be a power of two");
  for (int p = kNorm; p > 2; p /= 2) x = std::sqrt(x);
  return x;
}

// Adds a convex polygon as a fan of triangles around its first vertex. `unit` [m] is what depths are measured in.
void add_fan(const Polygon& polygon, const Affine& depth, double unit, TriangleMoments& triangles, Moments& target) {
  const auto [u0, v0] = polygon.vertex[0];
  const double scale = 1 / unit;
  const auto scaled_depth = [&](const Polygon::Vertex& x) { return std::max(0.0, scale * depth.at(x.u, x.v)); };
  const double f0 = scaled_depth(polygon.vertex[0]);
  double u = polygon.vertex[1].u - u0, v = polygon.vertex[1].v - v0, f = scaled_depth(polygon.vertex[1]);
  for (int k = 2; k < polygon.count; ++k) {
    const Polygon::Vertex& x = polygon.vertex[k];
    const double next_u = x.u - u0, next_v = x.v - v0, next_f = scaled_depth(x);
    triangles.add(target, f0, u, v, f, next_u, next_v, next_f);
    u = next_u;
    v = next_v;
    f = next_f;
  }
}

// Moments of all pieces, depths in units of the deepest so that φ^p neither overflows nor vanishes.
void take_moments(const Pieces& pieces, std::array<Moments, kPieceCount>& moments) {
  TriangleMoments triangles;
  for (int k = 0; k < pieces.count; ++k) {
    moments[k] = Moments::zero();
    add_fan(pieces.piece[k].polygon, pieces.piece[k].depth, pieces.deepest, triangles, moments[k]);
  }
  triangles.flush();
}

// ∫ w (1 + c s) over a piece and its first moments.
struct Pressure {
  double one, u, v;
};

Pressure pressure(const Moments& w, double c, const Affine& s) {
  return {w.one + c * (s.c * w.one + s.u * w.u + s.v * w.v), w.u + c * (s.c * w.u + s.u * w.uu + s.v * w.uv),
          w.v + c * (s.c * w.v + s.u * w.uv + s.v * w.vv)};
}

// The same for the factor (1 + c s)₊: nothing ever pulls, not even one end of a rocking face. Where the factor turns
// negative the polygon is cut along its zero line, so the force stays exact and continuous. s is the approach speed as
// a function of the coordinates from the piece's first vertex. `width_u`, `width_v`: the piece is no wider than its
// face.
Pressure damped_pressure(const Piece& piece, double unit, const Moments& w, double c, const Affine& s, double width_u,
                         double width_v) {
  if (c * (s.c - std::abs(s.u) * width_u - std::abs(s.v) * width_v) > -1) return pressure(w, c, s);
  const auto [u0, v0] = piece.polygon.vertex[0];
  const Affine factor{1 + c * (s.c - s.u * u0 - s.v * v0), c * s.u, c * s.v};
  bool pulls = false;
  for (int k = 0; k < piece.polygon.count; ++k)
    pulls |= factor.at(piece.polygon.vertex[k].u, piece.polygon.vertex[k].v) < 0;
  if (!pulls) return pressure(w, c, s);

  Polygon pressed;
  clip(piece.polygon, factor, pressed);
  if (pressed.count == 0) return {0, 0, 0};
  Moments part = Moments::zero();
  TriangleMoments triangles;
  add_fan(pressed, piece.depth, unit, triangles, part);
  triangles.flush();
  const double du = pressed.vertex[0].u - u0, dv = pressed.vertex[0].v - v0;  // its first vertex from the piece's
  Pressure result = pressure(part, c, {s.at(du, dv), s.u, s.v});
  result.u += du * result.one;
  result.v += dv * result.one;
  return result;
}

// The vector with these components along the axes k, k + 1 and k + 2 (cyclic). By choice and not by index: a vector
// that is written to memory by its components must wait there before it is read as a whole.
Vector3d on_axes(int k, double along_k, double along_u, double along_v) {
  return {k == 0 ? along_k : k == 1 ? along_v : along_u, k == 0 ? along_u : k == 1 ? along_k : along_v,
          k == 0 ? along_v : k == 1 ? along_u : along_k};
}

// What the pieces on one box' surface add up to, in that box' frame X and about its centre. The pressure of a piece
// acts along one of the other box' axes, so loads and their moments are gathered per axis.
struct Side {
  Side(Surface surface, const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB)
      : of_a(surface == Surface::of_a), half(of_a ? a.half : b.half) {
    const auto& R = X_AB.linear();
    if (of_a) {
      axes = R;
      w = V_AB.w_A;
      v = V_AB.v_A - V_AB.w_A.cross(X_AB.translation());
    } else {
      axes = R.transpose();
      w = R.transpose() * V_AB.w_A;
      v = R.transpose() * V_AB.v_A;
    }
    for (int m = 0; m < 3; ++m) {
      approach[m] = -axes.col(m).dot(v);
      approach_gradient.col(m) = w.cross(axes.col(m));
      spin[m] = axes.col(m).dot(w);
    }
  }

  // The pressure pushes B along this sign times the cell's axis: A's surface is pushed out of B through the cell's
  // face, so B goes the other way.
  double push(const Piece& piece) const { return of_a == (piece.cell % 2 == 1) ? 1 : -1; }

  bool of_a;
  Vector3d half;
  Matrix3d axes;                      // of the other box, as columns
  Vector3d w, v;                      // motion of B relative to A, v of its point at this box' centre
  Vector3d approach;                  // speed against each axis at this box' centre …
  Matrix3d approach_gradient;         // … and its gradient, as columns
  Vector3d spin;                      // about each axis
  Vector3d load = Vector3d::Zero();   // pressure on B along each axis …
  Matrix3d load_moment = Matrix3d::Zero();      // … and its first moment, as columns
  Vector3d drag = Vector3d::Zero(), drag_torque = Vector3d::Zero();  // friction on B
  double elastic = 0;                            // sum of the elastic pressures …
  Vector3d elastic_moment = Vector3d::Zero();    // … and its first moment
};

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
  std::array<Moments, kPieceCount> moments;
  take_moments(pieces, moments);

  const double unit = pieces.deepest;
  double integral = 0;  // I = integral · unit^p
  for (int k = 0; k < pieces.count; ++k) integral += 0.5 * moments[k].potential;
  if (integral <= 0) return result;
  const double stiffness = law.stiffness * small_root(integral / kReferenceArea);
  const double sigma = 0.5 * stiffness * unit / integral;  // for φ^(p−1) in units of unit^(p−1)
  result.touching = true;
  result.potential_energy = 0.5 * stiffness * unit * unit;

  std::array<Side, 2> sides = {Side(Surface::of_a, a, b, X_AB, V_AB), Side(Surface::of_b, a, b, X_AB, V_AB)};
  for (int i = 0; i < pieces.count; ++i) {
    const Moments& w = moments[i];
    if (w.one <= 0) continue;  // a sliver within rounding
    const Piece& piece = pieces.piece[i];
    Side& side = sides[static_cast<int>(piece.surface)];
    const int k = piece.face / 2, k_u = (k + 1) % 3, k_v = (k + 2) % 3, m = piece.cell / 2;
    const double push = side.push(piece);
    const double first_k = piece.face % 2 ? -side.half[k] : side.half[k];
    const auto [first_u, first_v] = piece.polygon.vertex[0];
    const Vector3d first = on_axes(k, first_k, first_u, first_v);  // where the piece's first vertex is

    const double weight = sigma * w.one, inverse = 1 / w.one;
    const double mean_u = w.u * inverse, mean_v = w.v * inverse;
    const Vector3d centre = on_axes(k, first_k, first_u + mean_u, first_v + mean_v);
    side.elastic += weight;
    side.elastic_moment += weight * centre;

    const auto gradient = side.approach_gradient.col(m);
    const Affine approach{push * (side.approach[m] + gradient.dot(first)), push * gradient[k_u], push * gradient[k_v]};
    Pressure load{w.one, w.u, w.v};
    if (law.damping > 0) {
      load = damped_pressure(piece, unit, w, law.damping, approach, 2 * side.half[k_u], 2 * side.half[k_v]);
      const double power = approach.c * (load.one - w.one) + approach.u * (load.u - w.u) + approach.v * (load.v - w.v);
      result.dissipated_power += std::max(0.0, sigma * power);  // below zero by rounding only
    }
    const double N = sigma * load.one;
    result.normal_force += N;
    side.load[m] += push * N;
    side.load_moment.col(m) +=
        push * on_axes(k, first_k * N, first_u * N + sigma * load.u, first_v * N + sigma * load.v);

    if (law.friction > 0) {
      const auto axis = side.axes.col(m);
      const double r2 = std::max(0.0, (w.uu + w.vv) * inverse - mean_u * mean_u - mean_v * mean_v);
      const Vector3d v_t = side.v + side.w.cross(centre) + push * approach.at(mean_u, mean_v) * axis;
      const double spin = side.spin[m], squared = v_t.squaredNorm() + r2 * spin * spin;
      const double factor = law.friction * N / std::sqrt(squared + law.transition_speed * law.transition_speed);
      side.drag -= factor * v_t;
      side.drag_torque -= factor * (centre.cross(v_t) + (r2 * spin) * axis);
      result.dissipated_power += factor * squared;
    }
  }

  std::array<Vector3d, 2> force, torque;
  for (int s = 0; s < 2; ++s) {
    force[s] = sides[s].axes * sides[s].load + sides[s].drag;
    torque[s] = sides[s].drag_torque;
    for (int m = 0; m < 3; ++m) torque[s] += sides[s].load_moment.col(m).cross(sides[s].axes.col(m));
  }
  const auto& R = X_AB.linear();
  const Vector3d p_AB = X_AB.translation(), force_b = R * force[1];
  result.f_A = force[0] + force_b;
  result.t_A = torque[0] + R * torque[1] + p_AB.cross(force_b);
  const Vector3d elastic_moment = sides[0].elastic_moment + R * sides[1].elastic_moment + sides[1].elastic * p_AB;
  result.impact_point_A = elastic_moment / (sides[0].elastic + sides[1].elastic);
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
  std::array<Moments, kPieceCount> moments;
  take_moments(pieces, moments);
  double sum = 0;
  for (int k = 0; k < pieces.count; ++k) sum += std::max(0.0, moments[k].one);
  if (sum == 0) return loads;
  for (int k = 0; k < pieces.count; ++k) {
    const Piece& piece = pieces.piece[k];
    loads[piece_index(piece.surface, piece.face, piece.cell)] = std::max(0.0, moments[k].one) / sum;
  }
  return loads;
}

}  // namespace quayside::contact_nn
