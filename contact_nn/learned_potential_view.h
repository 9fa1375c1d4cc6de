// What the network for the contact potential sees of two boxes, and how forces come back from it.
//
// Seen along the axis z that the boxes press on, canonical: B above A, its z and x axes along A's as far as may be (see
// `Canonical`). Everything is written for a scalar `T`: `double` for one pair, or an Eigen array for several at once.
//
// *Scale.* s is a depth that is zero exactly when an axis near z separates the boxes. For each such axis, S is the sum of the
// eighth powers of the depths of the corners or edges that could be deepest on it, so a smooth support function, and
//
//     s = (Σ f⁸ / S)^(−1/8),     f = sine² / √(sine² + w²)
//
// over A's and B's face (sine 1) and the four pairs of horizontal edges. The maximum and the absolute values of the
// separating-axis test, which would leave a kink in every aligned pose, are not needed. An edge's term is its depth to
// the power of −8 where the sine is large, while nearly parallel edges, whose common normal means nothing, fade out.
// Horizontal axes
// have no term: the domain asks for an overlap of decimetres there.
//
// *Base.* Q is where the overlap of the two rectangles has its four corners: sides of A and of B, whichever comes first,
// by a minimum rounded over s; L its sides' mean lengths. A flat contact of depth g has d = g (L_x L_y/A_f)^(1/8). So
//
//     log d = log s + ⅛ log(L_x L_y / A_f) + network(x),
//
// and for flat contacts the network has a constant to learn.
//
// *Inputs x*: asinh of depth/s at Q's corners, at B's and at A's (12), and along the common
// normals of edges that cross (2; that of parallel edges has no limit and may not be seen); s/L (2); tilts (2); sine of the yaw; how far B's
// sides reach beyond A's at Q's corners, u/√(u² + w²) (8). Lengths of a sideways move are only seen over decimetres: a box at
// rest must not feel the network's ripples as a sideways force.
#pragma once

#include <array>
#include <cmath>

#include "contact_nn/contact.h"
#include "contact_nn/potential_law.h"

namespace quayside::contact_nn::learned {

inline constexpr int kInputs = 27;
inline constexpr int kDepths = 14;          // the first inputs, through asinh
inline constexpr double kReach = 0.3;       // w of the inputs on B's and A's sides [m]
inline constexpr double kParallel = 0.05;     // w, of edges that begin to count as parallel [1]
inline constexpr double kLeastLength = 0.1;  // rounds L where Q has all but turned over [m]
inline constexpr double kTiltScale = 30, kYawScale = 10, kSlenderScale = 10;  // inputs of order one [1]

// Turns and mirrors that leave both boxes as they are and bring B above A, z and x axes within a quarter turn; and where A's x
// and B's y axis have a sine of at least `cross_from`, B's x and y axes change places. Constant over each part of a domain
// that keeps away from quarter turns and from that sine, so nothing jumps.
struct Canonical {
  explicit Canonical(const Pose& X_AB, double cross_from = kNeverCrossed) {
    const auto& R = X_AB.linear();
    mirror = X_AB.translation().z() < 0 ? -1 : 1;
    if (std::abs(R(0, 1)) > cross_from) axis = {1, 0, 2};
    for (int j = 0; j < 3; ++j) turn[static_cast<std::size_t>(j)] = R(j, of_b(j)) < 0 ? -1 : 1;
  }
  static constexpr double kNeverCrossed = 2;  // no sine is that large
  bool crossed() const { return axis[0] == 1; }
  int of_b(int j) const { return axis[static_cast<std::size_t>(j)]; }  // which of B's axes is the canonical j
  double sign(int i) const { return i == 2 ? mirror : 1; }
  double sign(int i, int j) const { return sign(i) * sign(j) * turn[static_cast<std::size_t>(j)]; }

  double mirror;               // of A's z axis and B's
  std::array<int, 3> axis{0, 1, 2};
  std::array<double, 3> turn;  // of B's axes
};

// A gradient with respect to p_AB and R_AB.
template <class T>
struct PoseGradient {
  T p[3], R[3][3];
};

inline double root(double x) { return std::sqrt(x); }
inline double positive(double x) { return x > 0 ? x : 0; }
inline double logarithm(double x) { return std::log(x); }
inline double sign_of(double x) { return x < 0 ? -1 : 1; }
template <class D>
typename D::PlainObject root(const Eigen::ArrayBase<D>& x) { return x.sqrt(); }
template <class D>
typename D::PlainObject positive(const Eigen::ArrayBase<D>& x) { return x.max(0.0); }
template <class D>
typename D::PlainObject logarithm(const Eigen::ArrayBase<D>& x) { return x.log(); }
template <class D>
typename D::PlainObject sign_of(const Eigen::ArrayBase<D>& x) {
  using Plain = typename D::PlainObject;
  return (x < 0.0).select(Plain::Constant(-1.0), Plain::Constant(1.0));
}

template <class T>
class View {
 public:
  T p[3], R[3][3], a[3], b[3];  // to be filled in: canonical pose and half extents

  T s;                 // [m]; only meaningful where `load` > 0
  T load;              // s is (unit⁸/load)^(1/8): zero or infinite when apart
  T log_base;          // log s + ⅛ log(L_x L_y / A_f)
  T input[kInputs];    // the first `kDepths` before asinh
  T length[2];         // L [m]

  // Depth s alone, first of all; the rest is only for pairs that touch.
  void scale() {
    const T above = a[2] - p[2] + R[2][2] * b[2];
    const T x = R[2][0] * b[0], y = R[2][1] * b[1];
    const T level = b[2] + R[2][2] * (a[2] - p[2]) - R[0][2] * p[0] - R[1][2] * p[1];
    const T u = R[0][2] * a[0], v = R[1][2] * a[1];
    for (int c = 0; c < 4; ++c) {
      depth_b[c] = above - sx(c) * x - sy(c) * y;
      depth_a[c] = level + sx(c) * u + sy(c) * v;
    }
    T largest = depth_b[0];
    for (int c = 1; c < 4; ++c) largest = largest + positive(T(depth_b[c] - largest));
    // Any length of the right size would do: it keeps eighth powers in range.
    unit = positive(largest) + 1e-12;
    inverse_unit = 1.0 / unit;
    load = 1.0 / powers(depth_a, power_a);
    load_a = load;
    load_b = 1.0 / powers(depth_b, power_b);
    load = load + load_b;
    for (int k = 0; k < 4; ++k) {
      const int i = k / 2, j = k % 2, o = 1 - i, m = 1 - j;
      // Normal e_i × f_j turned upwards: (0, −R_2j, R_1j) for i = 0, (R_2j, 0, −R_0j) for i = 1.
      const double f = i == 0 ? 1 : -1, h = j == 0 ? 1 : -1;
      up[k] = f * sign_of(R[o][j]);
      sine2[k] = R[o][j] * R[o][j] + R[2][j] * R[2][j];
      const T middle = f * (R[o][j] * (a[2] - p[2]) + R[2][j] * p[o]) - h * b[2] * R[i][m];
      const T along_a = -f * R[2][j] * a[o], along_b = -h * R[i][2] * b[m];
      for (int c = 0; c < 4; ++c) depth_e[k][c] = up[k] * (middle + sx(c) * along_a + sy(c) * along_b);
      const T s4 = sine2[k] * sine2[k] * sine2[k] * sine2[k];
      inverse_e[k] = 1.0 / powers(depth_e[k], power_e[k]);
      const T wide = sine2[k] + kParallel * kParallel, wide2 = wide * wide;
      fade[k] = s4 * s4 / (wide2 * wide2);
      fade_slope[k] = s4 * sine2[k] * sine2[k] * sine2[k] / (wide2 * wide2 * wide) * (2.0 * wide - sine2[k]);
      load = load + fade[k] * inverse_e[k];
    }
    s = unit / root(root(root(load)));
  }

  void inputs() {
    inverse_s = 1.0 / s;
    for (int k = 1; k < 3; ++k) input[11 + k] = unit / root(root(root(inverse_e[k]))) * inverse_s;
    inverse_r00 = 1.0 / R[0][0];
    inverse_r11 = 1.0 / R[1][1];
    const T level = b[2] + R[2][2] * (a[2] - p[2]) - R[0][2] * p[0] - R[1][2] * p[1];
    const T lift = a[2] - p[2];
    for (int c = 0; c < 4; ++c) {
      const double x = sx(c), y = sy(c);
      // Q's corner: first y without yaw, then x, y and x again, which leaves the yaw to the fourth power.
      side_b(1, c, T(p[0]), lift, side[c][0]);
      const T y0 = rounded(1, y, side[c][0], slope[c][0], width[c][0]);
      side_b(0, c, y0, lift, side[c][1]);
      const T x1 = rounded(0, x, side[c][1], slope[c][1], width[c][1]);
      side_b(1, c, x1, lift, side[c][2]);
      const T y2 = rounded(1, y, side[c][2], slope[c][2], width[c][2]);
      side_b(0, c, y2, lift, side[c][3]);
      const T x3 = rounded(0, x, side[c][3], slope[c][3], width[c][3]);
      corner[c][0] = x3;
      corner[c][1] = y2;
      corner_y0[c] = y0;
      corner_x1[c] = x1;
      input[c] = (level + R[0][2] * x3 + R[1][2] * y2) * inverse_s;
      input[4 + c] = depth_b[c] * inverse_s;
      input[8 + c] = depth_a[c] * inverse_s;
      for (int k = 0; k < 2; ++k) {
        const T beyond = (k == 0 ? x * side[c][3] : y * side[c][2]) - a[k];
        reach_root[c][k] = 1.0 / root(T(beyond * beyond + kReach * kReach));
        input[19 + 2 * c + k] = beyond * reach_root[c][k];
      }
    }
    for (int k = 0; k < 2; ++k) {
      const int near = 2 - k;  // the corner that differs from the first one along k
      const T mean = 0.5 * (corner[0][k] - corner[near][k] + corner[3 - near][k] - corner[3][k]);
      const T rounding = root(T(mean * mean + kLeastLength * kLeastLength));
      length[k] = 0.5 * (mean + rounding);
      length_slope[k] = 0.5 + 0.5 * mean / rounding;
      input[14 + k] = kSlenderScale * s / length[k];
      input[16 + k] = kTiltScale * R[k][2];
    }
    input[18] = kYawScale * R[1][0];
    log_base = logarithm(s) + 0.125 * logarithm(T(length[0] * length[1] * (1 / kReferenceArea)));
  }

  // Gradient of `scale_weight` · log s + `base_weight` · log_base + Σ weight[i] input[i].
  void gradient(const T* weight, double scale_weight, double base_weight, PoseGradient<T>& g) const {
    const T zero = p[0] * 0.0;
    for (int i = 0; i < 3; ++i) {
      g.p[i] = zero;
      for (int j = 0; j < 3; ++j) g.R[i][j] = zero;
    }
    T log_s = zero + (scale_weight + base_weight);
    T to_depth_a[4], to_depth_b[4];
    for (int c = 0; c < 4; ++c) to_depth_a[c] = to_depth_b[c] = zero;
    T to_level = zero;
    if (weight || base_weight != 0) {
      T to_corner[4][2], to_length[2];
      for (int k = 0; k < 2; ++k) {
        const T slender = weight ? T(weight[14 + k] * input[14 + k]) : zero;
        to_length[k] = (0.125 * base_weight - slender) / length[k] * length_slope[k];
        log_s = log_s + slender;
        if (weight) g.R[k][2] = g.R[k][2] + kTiltScale * weight[16 + k];
      }
      if (weight) g.R[1][0] = g.R[1][0] + kYawScale * weight[18];
      const T lift = a[2] - p[2];
      for (int c = 0; c < 4; ++c) {
        const double x = sx(c), y = sy(c);
        to_corner[c][0] = 0.5 * x * to_length[0];
        to_corner[c][1] = 0.5 * y * to_length[1];
        T to_x_side = zero, to_y_side = zero;  // of side[c][3], side[c][2]
        if (weight) {
          const T w = weight[c] * inverse_s;
          log_s = log_s - weight[c] * input[c] - weight[4 + c] * input[4 + c] - weight[8 + c] * input[8 + c];
          to_level = to_level + w;
          g.R[0][2] = g.R[0][2] + w * corner[c][0];
          g.R[1][2] = g.R[1][2] + w * corner[c][1];
          to_corner[c][0] = to_corner[c][0] + w * R[0][2];
          to_corner[c][1] = to_corner[c][1] + w * R[1][2];
          to_depth_b[c] = weight[4 + c] * inverse_s;
          to_depth_a[c] = weight[8 + c] * inverse_s;
          // d/du u/√(u² + w²) = w²/√³
          const auto through = [&](int k) -> T {
            const T r = reach_root[c][k];
            return weight[19 + 2 * c + k] * (kReach * kReach) * r * r * r;
          };
          to_x_side = x * through(0);
          to_y_side = y * through(1);
        }
        // Back through x3, y2, x1, y0.
        log_s = log_s + to_corner[c][0] * width[c][3];
        to_x_side = to_x_side + to_corner[c][0] * slope[c][3];
        T to_y2 = to_corner[c][1] + back_side(0, c, to_x_side, corner[c][1], side[c][3], lift, g);
        log_s = log_s + to_y2 * width[c][2];
        to_y_side = to_y_side + to_y2 * slope[c][2];
        const T to_x1 = back_side(1, c, to_y_side, corner_x1[c], side[c][2], lift, g);
        log_s = log_s + to_x1 * width[c][1];
        const T to_y0 = back_side(0, c, T(to_x1 * slope[c][1]), corner_y0[c], side[c][1], lift, g);
        log_s = log_s + to_y0 * width[c][0];
        const T to_p0 = back_side(1, c, T(to_y0 * slope[c][0]), p[0], side[c][0], lift, g);
        g.p[0] = g.p[0] + to_p0;
      }
    }
    // Through s.
    if (weight) log_s = log_s - weight[12] * input[12] - weight[13] * input[13];
    const T share = log_s / load;
    for (int c = 0; c < 4; ++c) {
      to_depth_a[c] = to_depth_a[c] + share * load_a * load_a * power_a[c] * inverse_unit;
      to_depth_b[c] = to_depth_b[c] + share * load_b * load_b * power_b[c] * inverse_unit;
    }
    for (int k = 0; k < 4; ++k) {
      const int i = k / 2, j = k % 2, o = 1 - i, m = 1 - j;
      const double f = i == 0 ? 1 : -1, h = j == 0 ? 1 : -1;
      const T to_log = weight && (k == 1 || k == 2) ? T(weight[11 + k] * input[11 + k]) : zero;  // of the input
      const T common = up[k] * (share * inverse_e[k] * fade[k] + to_log) * inverse_e[k] * inverse_unit;
      T sum = zero, sum_a = zero, sum_b = zero;
      for (int c = 0; c < 4; ++c) {
        const T t = common * power_e[k][c];
        sum = sum + t;
        sum_a = sum_a + sx(c) * t;
        sum_b = sum_b + sy(c) * t;
      }
      const T to_sine2 = -0.5 * share * inverse_e[k] * fade_slope[k];
      g.R[o][j] = g.R[o][j] + 2.0 * to_sine2 * R[o][j] + f * sum * (a[2] - p[2]);
      g.R[2][j] = g.R[2][j] + 2.0 * to_sine2 * R[2][j] + f * (sum * p[o] - sum_a * a[o]);
      g.p[2] = g.p[2] - f * sum * R[o][j];
      g.p[o] = g.p[o] + f * sum * R[2][j];
      g.R[i][m] = g.R[i][m] - h * sum * b[2];
      g.R[i][2] = g.R[i][2] - h * sum_b * b[m];
    }
    T above = zero, x = zero, y = zero, u = zero, v = zero;
    for (int c = 0; c < 4; ++c) {
      above = above + to_depth_b[c];
      x = x - sx(c) * to_depth_b[c];
      y = y - sy(c) * to_depth_b[c];
      to_level = to_level + to_depth_a[c];
      u = u + sx(c) * to_depth_a[c];
      v = v + sy(c) * to_depth_a[c];
    }
    g.p[2] = g.p[2] - above - to_level * R[2][2];
    g.p[0] = g.p[0] - to_level * R[0][2];
    g.p[1] = g.p[1] - to_level * R[1][2];
    g.R[2][2] = g.R[2][2] + above * b[2] + to_level * (a[2] - p[2]);
    g.R[2][0] = g.R[2][0] + x * b[0];
    g.R[2][1] = g.R[2][1] + y * b[1];
    g.R[0][2] = g.R[0][2] + u * a[0] - to_level * p[0];
    g.R[1][2] = g.R[1][2] + v * a[1] - to_level * p[1];
  }

 private:
  // Corners in the order ++, +−, −+, −−.
  static double sx(int c) { return c < 2 ? 1 : -1; }
  static double sy(int c) { return c % 2 == 0 ? 1 : -1; }

  // Sum of (depth/unit)₊⁸, and the seventh powers.
  T powers(const T* depth, T* seventh) const {
    T sum = p[0] * 0.0 + 1e-300;
    for (int c = 0; c < 4; ++c) {
      const T x = positive(T(depth[c] * inverse_unit)), x2 = x * x, x4 = x2 * x2;
      seventh[c] = x4 * x2 * x;
      sum = sum + x4 * x4;
    }
    return sum;
  }

  // Where B's side across axis k meets A's face, at the coordinate `at` of the other axis.
  void side_b(int k, int c, const T& at, const T& lift, T& where) const {
    const int o = 1 - k;
    where = p[k] + ((k == 0 ? sx(c) : sy(c)) * b[k] - R[o][k] * (at - p[o]) - R[2][k] * lift) *
                       (k == 0 ? inverse_r00 : inverse_r11);
  }
  // Adds what `weight` · side_b contributes; returns its share for `at`.
  T back_side(int k, int c, const T& weight, const T& at, const T& where, const T& lift, PoseGradient<T>& g) const {
    const int o = 1 - k;
    const T w = weight * (k == 0 ? inverse_r00 : inverse_r11);
    g.p[k] = g.p[k] + weight;
    g.p[o] = g.p[o] + w * R[o][k];
    g.p[2] = g.p[2] + w * R[2][k];
    g.R[o][k] = g.R[o][k] - w * (at - p[o]);
    g.R[2][k] = g.R[2][k] - w * lift;
    g.R[k][k] = g.R[k][k] - w * (where - p[k]);
    return -w * R[o][k];
  }

  // ± the smaller of A's half extent and ± B's side, rounded over s; its derivatives to the side and to log s.
  T rounded(int k, double sign, const T& where, T& to_side, T& to_log_s) const {
    const T difference = a[k] - sign * where;
    const T r = root(T(difference * difference + s * s));
    const T half = 0.5 / r;
    to_side = 0.5 + difference * half;
    to_log_s = -sign * s * s * half;
    return sign * (0.5 * (a[k] + sign * where - r));
  }

  T unit, inverse_unit, inverse_s, inverse_r00, inverse_r11;
  T depth_a[4], depth_b[4], depth_e[4][4], power_a[4], power_b[4], power_e[4][4];
  T load_a, load_b, inverse_e[4], sine2[4], fade[4], fade_slope[4], up[4], length_slope[2];
  T side[4][4], slope[4][4], width[4][4], corner[4][2], corner_y0[4], corner_x1[4], reach_root[4][2];
};

}  // namespace quayside::contact_nn::learned
