#include "contact_nn/manifold.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace quayside::contact_nn {
namespace {

using Eigen::Vector3d;

// The reference face is widened by this many ε times the size of the pair [1], so that boxes of the same size which
// are aligned to within rounding keep the four corners and not two or eight.
constexpr double kFaceRounding = 64;

// Cosine of the angle below which two faces count as flat on each other: 2.5 degrees [1].
constexpr double kFlatCosine = 0.999;

double rounding(const Box& a, const Box& b, const Vector3d& p_AB) {
  return kFaceRounding * std::numeric_limits<double>::epsilon() * (a.half.sum() + b.half.sum() + p_AB.lpNorm<1>());
}

double sign(double x) { return x < 0 ? -1 : 1; }

// A corner of the incident face, moved along the normal onto the reference face: where it lands, from the face's centre, and
// how far it had to go. All three are affine over the incident face.
struct Corner {
  double u, v, depth;
};

// A rectangle cut by four half-planes has at most eight corners.
struct Corners {
  int count = 0;
  std::array<Corner, 8> corner;
  void add(const Corner& c) {
    assert(count < 8);
    corner[count++] = c;
  }
};

// Keeps the part where s · (u or v) ≤ limit.
Corners clip(const Corners& in, double Corner::*coordinate, double s, double limit) {
  Corners out;
  for (int k = 0; k < in.count; ++k) {
    const Corner &from = in.corner[k], &to = in.corner[k + 1 < in.count ? k + 1 : 0];
    const double f = limit - s * from.*coordinate, next = limit - s * to.*coordinate;
    if (f >= 0) out.add(from);
    if ((f >= 0) != (next >= 0)) {
      const double t = f / (f - next);
      out.add({from.u + t * (to.u - from.u), from.v + t * (to.v - from.v), from.depth + t * (to.depth - from.depth)});
    }
  }
  return out;
}

int largest_component(const Vector3d& n) {
  int k;
  n.cwiseAbs().maxCoeff(&k);
  return k;
}

// The two faces that look most along the normal are held against each other: the incident one, of box Y, is moved along the
// normal onto the reference one, of box X, and clipped by its sides. A corner at depth d is on Y's surface, and d n from it is X's:
// the contact point is halfway. Everything in X's frame, `n` from X to Y.
void face_points(const Vector3d& half_x, const Vector3d& half_y, const Pose& X_XY, const Vector3d& n, double tolerance,
                 double margin, double deepest, const Pose& X_AX, Manifold& manifold) {
  const auto& R = X_XY.linear();
  const Vector3d n_Y = R.transpose() * n;
  const int k = largest_component(n), m = largest_component(n_Y);
  const int k_u = (k + 1) % 3, k_v = (k + 2) % 3, m_u = (m + 1) % 3, m_v = (m + 2) % 3;
  const double plane = sign(n[k]) * half_x[k];
  const Vector3d centre = X_XY.translation() - sign(n_Y[m]) * half_y[m] * R.col(m);
  const Vector3d u = half_y[m_u] * R.col(m_u), v = half_y[m_v] * R.col(m_v);
  Corners corners;
  for (const auto& [s, t] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const Vector3d p = centre + s * u + t * v;
    const double depth = (plane - p[k]) / n[k];
    corners.add({p[k_u] + depth * n[k_u], p[k_v] + depth * n[k_v], depth});
  }
  for (const double s : {-1.0, 1.0}) {
    corners = clip(corners, &Corner::u, s, half_x[k_u] + tolerance);
    corners = clip(corners, &Corner::v, s, half_x[k_v] + tolerance);
  }
  for (int i = 0; i < corners.count; ++i) {
    const Corner& corner = corners.corner[i];
    const double depth = std::min(corner.depth, deepest);  // by rounding
    if (depth < -margin) continue;
    Vector3d p;
    p[k] = plane;
    p[k_u] = corner.u;
    p[k_v] = corner.v;
    manifold.points[manifold.count++] = {X_AX * (p - 0.5 * depth * n), depth};
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
  const Vector3d n_B = X_AB.linear().transpose() * axis.n_A;
  if (axis.axis < 3) {
    manifold.contact_class = ContactClass::face_a;
  } else if (axis.axis < 6) {
    manifold.contact_class = ContactClass::face_b;
  } else {
    manifold.contact_class = ContactClass::edge_edge;
  }
  const bool flat = axis.n_A.cwiseAbs().maxCoeff() > kFlatCosine && n_B.cwiseAbs().maxCoeff() > kFlatCosine;
  if (axis.axis < 3 || (axis.axis >= 6 && flat)) {
    face_points(a.half, b.half, X_AB, axis.n_A, tolerance, margin, -axis.gap, Pose::Identity(), manifold);
  } else if (axis.axis < 6) {
    face_points(b.half, a.half, X_AB.inverse(Eigen::Isometry), -n_B, tolerance, margin, -axis.gap, X_AB, manifold);
  }
  if (axis.axis >= 6 && manifold.count == 0)
    edge_point(a, b, X_AB, (axis.axis - 6) / 3, (axis.axis - 6) % 3, tolerance, manifold);
  if (manifold.count == 0) manifold.contact_class = ContactClass::apart;
  return manifold;
}

}  // namespace quayside::contact_nn
