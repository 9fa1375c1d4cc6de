// Moments of the weight φ^(p−1) over convex polygons on which φ is affine, in closed form.
#pragma once

#include <array>

#include <Eigen/Core>

namespace quayside::contact_nn {

inline constexpr int kNorm = 8;  // p: how local the contact is

// Lengths in m from the polygon's first vertex, φ in whatever unit the caller took.
struct Moments {
  double potential;   // ∫ φ^p
  double one;         // ∫ φ^(p−1)
  double u, v;        // first
  double uu, uv, vv;  // second
  static Moments zero() { return {0, 0, 0, 0, 0, 0, 0}; }  // no initializers: 72 of them are not cleared for nothing
};

// Eight triangles at a time. With vertex depths f, area a, m = p − 1, λ barycentric coordinates and h_m the complete
// homogeneous symmetric polynomial:
//
//     ∫φ^m = 2a m!/(m+2)! h_m(f₀,f₁,f₂)
//     ∫φ^m λ_i = 2a m!/(m+3)! h_m(f₀,f₁,f₂,f_i)
//     ∫φ^m λ_i λ_j = 2a m! (1+δ_ij)/(m+4)! h_m(f₀,f₁,f₂,f_i,f_j)
//
// A variable x is appended by h_k(…, x) = h_k(…) + x h_(k−1)(…, x). All terms are positive: nothing cancels.
class TriangleMoments {
 public:
  // Triangle with the vertices (0, 0), (u1, v1), (u2, v2) and these depths; `target` must live until `flush`.
  void add(Moments& target, double f0, double u1, double v1, double f1, double u2, double v2, double f2) {
    f0_[filled_] = f0, f1_[filled_] = f1, f2_[filled_] = f2;
    u1_[filled_] = u1, v1_[filled_] = v1, u2_[filled_] = u2, v2_[filled_] = v2;
    target_[filled_] = &target;
    if (++filled_ == kLanes) flush();
  }
  void flush();

 private:
  static constexpr int kLanes = 8;
  using Lanes = Eigen::Array<double, kLanes, 1>;
  int filled_ = 0;
  Lanes f0_ = Lanes::Zero(), f1_ = f0_, f2_ = f0_, u1_ = f0_, v1_ = f0_, u2_ = f0_, v2_ = f0_;
  std::array<Moments*, kLanes> target_;
};

}  // namespace quayside::contact_nn
