#include "contact_nn/manifold.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace quayside::contact_nn {
namespace {

using Eigen::Vector3d;

// The reference face is widened by this many ε times the size of the pair [1], so that boxes of the same size which
// are aligned to within rounding keep the four corners and not two or eight.
constexpr double kFaceRounding = 64;

double rounding(const Box& a, const Box& b, const Vector3d& p_AB) {
  return kFaceRounding * std::numeric_limits<double>::epsilon() * (a.half.sum() + b.half.sum() + p_AB.lpNorm<1>());
}

double sign(double x) { return x < 0 ? -1 : 1; }

// A rectangle cut by four half-planes has at most eight corners.
struct Corners {
  int count = 0;
  std::array<Vector3d, 8> p;
  void add(const Vector3d& x) {
    assert(count < 8);
    p[count++] = x;
  }
};

// Keeps the part where s · x[axis] ≤ limit.
Corners clip(const Corners& in, int axis, double s, double limit) {
  Corners out;
  for (int k = 0; k < in.count; ++k) {
    const Vector3d &from = in.p[k], &to = in.p[(k + 1) % in.count];
    const double f = limit - s * from[axis], next = limit - s * to[axis];
    if (f >= 0) out.add(from);
    if ((f >= 0) != (next >= 0)) out.add(from + f / (f - next) * (to - from));
  }
  return out;
}

// Clips the incident face of box Y, the one that looks most against the reference normal, by the sides of the reference
// face of box X, in X's frame. A corner at depth d is on Y's surface and d n away from X's: the contact point is between.
void face_points(const Vector3d& half_x, const Vector3d& half_y, const Pose& X_XY, int axis, double outward,
                 double tolerance, double margin, double deepest, const Pose& X_AX, Manifold& manifold) {
  const auto& R = X_XY.linear();
  int m = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(R(axis, k)) > std::abs(R(axis, m))) m = k;
  const double side = -sign(outward * R(axis, m));
  const Vector3d centre = X_XY.translation() + side * half_y[m] * R.col(m);
  const Vector3d u = half_y[(m + 1) % 3] * R.col((m + 1) % 3), v = half_y[(m + 2) % 3] * R.col((m + 2) % 3);
  Corners corners;
  corners.add(centre - u - v);
  corners.add(centre + u - v);
  corners.add(centre + u + v);
  corners.add(centre - u + v);
  for (const int k : {(axis + 1) % 3, (axis + 2) % 3})
    for (const double s : {-1.0, 1.0}) {
      corners = clip(corners, k, s, half_x[k] + tolerance);
      if (corners.count == 0) return;
    }
  for (int k = 0; k < corners.count; ++k) {
    Vector3d p = corners.p[k];
    const double depth = std::min(half_x[axis] - outward * p[axis], deepest);
    if (depth < -margin) continue;
    p[axis] += 0.5 * depth * outward;
    manifold.points[manifold.count++] = {X_AX * p, depth};
  }
}

// The point halfway between the two edges that look at each other along n. With o the centres of the edges along e and f,
// o_B + t f − o_A − s e = gap n; its products with f × n and e × n give s and t.
void edge_point(const Box& a, const Box& b, const Pose& X_AB, int i, int j, double tolerance, Manifold& manifold) {
  const Vector3d& n = manifold.n_A;
  const auto& R = X_AB.linear();
  Vector3d o_a = Vector3d::Zero(), o_b = X_AB.translation();
  for (int k = 0; k < 3; ++k) {
    if (k != i) o_a[k] = sign(n[k]) * a.half[k];
    if (k != j) o_b -= sign(n.dot(R.col(k))) * b.half[k] * R.col(k);
  }
  const Vector3d e = Vector3d::Unit(i), f = R.col(j), d = o_b - o_a;
  const double sine = n.dot(e.cross(f));
  const double s = d.dot(f.cross(n)) / sine, t = d.dot(e.cross(n)) / sine;
  // Where the edges are nearly parallel rounding moves the feet along them by 1 / sine.
  const double slack = tolerance / std::abs(sine);
  const bool facing = std::abs(s) <= a.half[i] + slack && std::abs(t) <= b.half[j] + slack;
  if (manifold.gap > 0 && !facing) return;
  const Vector3d on_a = o_a + std::clamp(s, -a.half[i], a.half[i]) * e;
  const Vector3d on_b = o_b + std::clamp(t, -b.half[j], b.half[j]) * f;
  manifold.points[manifold.count++] = {0.5 * (on_a + on_b), -manifold.gap};
}

}  // namespace

Manifold contact_manifold(const Box& a, const Box& b, const Pose& X_AB, double margin) {
  return contact_manifold(a, b, X_AB, margin, largest_separation(a, b, X_AB));
}

Manifold contact_manifold(const Box& a, const Box& b, const Pose& X_AB, double margin, const AxisSeparation& axis) {
  Manifold manifold;
  manifold.gap = axis.gap;
  manifold.n_A = axis.n_A;
  manifold.contact_class = ContactClass::apart;
  manifold.count = 0;
  if (axis.gap > margin) return manifold;

  const double tolerance = rounding(a, b, X_AB.translation());
  if (axis.axis < 3) {
    manifold.contact_class = ContactClass::face_a;
    face_points(a.half, b.half, X_AB, axis.axis, sign(axis.n_A[axis.axis]), tolerance, margin, -axis.gap,
                Pose::Identity(), manifold);
  } else if (axis.axis < 6) {
    const int k = axis.axis - 3;
    manifold.contact_class = ContactClass::face_b;
    face_points(b.half, a.half, X_AB.inverse(Eigen::Isometry), k, -sign(axis.n_A.dot(X_AB.linear().col(k))), tolerance,
                margin, -axis.gap, X_AB, manifold);
  } else {
    manifold.contact_class = ContactClass::edge_edge;
    edge_point(a, b, X_AB, (axis.axis - 6) / 3, (axis.axis - 6) % 3, tolerance, manifold);
  }
  if (manifold.count == 0) manifold.contact_class = ContactClass::apart;
  return manifold;
}

}  // namespace quayside::contact_nn
