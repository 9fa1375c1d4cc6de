#include "contact_nn/manifold.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "contact_nn/lanes.h"

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

// A corner of the incident face, moved along the normal onto the reference face: where it lands (lanes 0 and 1, from
// the face's centre), and how far it had to go (lane 2). All three are affine over the incident face.
using Corner = Four;

// A rectangle cut by four half-planes has at most eight corners; one more place for what is written but does not count.
struct Corners {
  int count = 0;
  std::array<Corner, 9> corner;
};

// Keeps the part where sign · corner[lane] ≤ limit. Each corner is kept or not, and the crossing with the side behind
// it is kept or not: both are written always and counted only if wanted, since branches that go either way cost more
// than the work.
template <int lane>
void clip(const Corners& in, double sign, double limit, Corners& out) {
  int n = 0;
  const int last = in.count - 1;
  if (last < 0) {
    out.count = 0;
    return;
  }
  const Corner* from = &in.corner[last];
  double f = limit - sign * (*from)[lane];
  for (int k = 0; k <= last; ++k) {
    const Corner& to = in.corner[k];
    const double next = limit - sign * to[lane];
    const double t = f / (f - next);
    out.corner[n] = *from + t * (to - *from);
    n += (f >= 0) != (next >= 0);
    out.corner[n] = to;
    n += next >= 0;
    from = &to;
    f = next;
  }
  assert(n <= 8);
  out.count = n;
}

int largest_component(const Vector3d& n) {
  int k;
  n.cwiseAbs().maxCoeff(&k);
  return k;
}

// The two faces that look most along the normal are held against each other: the incident one, of box Y, is moved along
// the normal onto the reference one, of box X, and clipped by its sides. A corner at depth d is on Y's surface, and d n
// from it is X's: the contact point is halfway. Everything in X's frame, `n` from X to Y.
void face_points(const Vector3d& half_x, const Vector3d& half_y, const Pose& X_XY, const Vector3d& n, double tolerance,
                 double margin, double deepest, const Pose& X_AX, Manifold& manifold) {
  const auto& R = X_XY.linear();
  const Vector3d n_Y = R.transpose() * n;
  const int k = largest_component(n), m = largest_component(n_Y);
  const int k_u = (k + 1) % 3, k_v = (k + 2) % 3, m_u = (m + 1) % 3, m_v = (m + 2) % 3;
  const double plane = sign(n[k]) * half_x[k];
  // Around the incident face, as corners of the reference face: centre and half sides.
  const double inverse = 1 / n[k];
  const auto onto_face = [&](const Vector3d& p, double from_plane) {
    const double depth = from_plane * inverse;
    return four(p[k_u] + depth * n[k_u], p[k_v] + depth * n[k_v], depth);
  };
  const Vector3d middle = X_XY.translation() - sign(n_Y[m]) * half_y[m] * R.col(m);
  const Vector3d side_u = half_y[m_u] * R.col(m_u), side_v = half_y[m_v] * R.col(m_v);
  const Corner c = onto_face(middle, plane - middle[k]);
  const Corner u = onto_face(side_u, -side_u[k]), v = onto_face(side_v, -side_v[k]);
  Corners first, second;
  Corners *now = &first, *then = &second;
  first.count = 4;
  first.corner[0] = c - u - v;
  first.corner[1] = c + u - v;
  first.corner[2] = c + u + v;
  first.corner[3] = c - u + v;
  const double limit_u = half_x[k_u] + tolerance, limit_v = half_x[k_v] + tolerance;
  const double reach_u = std::abs(u[0]) + std::abs(v[0]), reach_v = std::abs(u[1]) + std::abs(v[1]);
  const auto cut = [&](auto lane, double sign, double reach, double limit) {
    if (sign * c[lane.value] + reach <= limit) return;
    clip<lane.value>(*now, sign, limit, *then);
    std::swap(now, then);
  };
  const std::integral_constant<int, 0> lane_u;
  const std::integral_constant<int, 1> lane_v;
  cut(lane_u, -1, reach_u, limit_u);
  cut(lane_v, -1, reach_v, limit_v);
  cut(lane_u, 1, reach_u, limit_u);
  cut(lane_v, 1, reach_v, limit_v);

  // A point and its depth are affine in the corner as well: one vector, stored as it is.
  const auto& Q = X_AX.linear();
  const Four origin = four(X_AX.translation() + plane * Q.col(k));
  const Four along_u = four(Q.col(k_u)), along_v = four(Q.col(k_v));
  const Vector3d half_n = -0.5 * (Q * n);
  const Four per_depth = four(half_n[0], half_n[1], half_n[2], 1);
  static_assert(sizeof(ManifoldPoint) == sizeof(Four), "three coordinates and the depth");
  int count = 0;
  for (int i = 0; i < now->count; ++i) {
    const Corner& corner = now->corner[i];
    const double depth = std::min(corner[2], deepest);  // by rounding
    if (depth < -margin) continue;
    const Four point = origin + corner[0] * along_u + corner[1] * along_v + depth * per_depth;
    std::memcpy(static_cast<void*>(&manifold.points[count++]), &point, sizeof point);
  }
  manifold.count = count;
}

// The point halfway between the two edges that look at each other along n. With o the centres of the edges along e and
// f, o_B + t f − o_A − s e = gap n; its products with f × n and e × n give s and t.
void edge_point(const Box& a, const Box& b, const Pose& X_AB, int i, int j, double tolerance, Manifold& manifold) {
  const Vector3d& n = manifold.n_A;
  const auto& R = X_AB.linear();
  Vector3d o_a = Vector3d::Zero(), o_b = X_AB.translation();
  for (int k = 0; k < 3; ++k) {
    if (k != i) o_a[k] = sign(n[k]) * a.half[k];
    if (k != j) o_b -= sign(n.dot(R.col(k))) * b.half[k] * R.col(k);
  }
  const Vector3d e = Vector3d::Unit(i), f = R.col(j), d = o_b - o_a;
  const double inverse = 1 / n.dot(e.cross(f));  // of the edges' sine
  const double s = d.dot(f.cross(n)) * inverse, t = d.dot(e.cross(n)) * inverse;
  // Where the edges are nearly parallel rounding moves the feet along them by 1 / sine.
  const double slack = tolerance * std::abs(inverse);
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
