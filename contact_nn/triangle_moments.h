// Moments of the weight φ^(p−1) over convex polygons on which φ is affine, in closed form, eight polygons at a time.
#pragma once

#include "contact_nn/lanes.h"

namespace quayside::contact_nn {

inline constexpr int kNorm = 8;  // p: how local the contact is

// A polygon to each lane. Lengths in m from the polygon's first vertex, φ in whatever unit the caller took.
struct Moments {
  Eight potential;   // ∫ φ^p
  Eight one;         // ∫ φ^(p−1)
  Eight u, v;        // first
  Eight uu, uv, vv;  // second
};

// Triangles with the vertices (0, 0), (u1, v1), (u2, v2), counter-clockwise, and the depths f0, f1, f2.
struct Triangles {
  Eight f0, u1, v1, f1, u2, v2, f2;
};

// Adds a triangle to each lane's moments. With vertex depths f, area a, m = p − 1, λ barycentric coordinates and h_m the
// complete homogeneous symmetric polynomial:
//
//     ∫φ^m = 2a m!/(m+2)! h_m(f₀,f₁,f₂)
//     ∫φ^m λ_i = 2a m!/(m+3)! h_m(f₀,f₁,f₂,f_i)
//     ∫φ^m λ_i λ_j = 2a m! (1+δ_ij)/(m+4)! h_m(f₀,f₁,f₂,f_i,f_j)
//
// A variable x is appended by h_k(…, x) = h_k(…) + x h_(k−1)(…, x). All terms are positive: nothing cancels.
void add_triangles(const Triangles& triangles, Moments& moments);

}  // namespace quayside::contact_nn
