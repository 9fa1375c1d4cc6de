#include "contact_nn/separating_axes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact_nn/lanes.h"

namespace quayside::contact_nn {
namespace {

constexpr int kFirstEdge = 6;  // number of the first edge pair's axis

// The pair as all axes need it. Lane i or j of a `Four` belongs to A's axis i or B's axis j.
struct Relative {
  Relative(const Box& box_a, const Box& box_b, const Pose& X_AB)
      : a(box_a.half), b(box_b.half), X(X_AB), columns{column(0), column(1), column(2)},
        rows(columns[0], columns[1], columns[2]), p(column(3)) {
    const Four half_a = four(a), half_b = four(b);
    for (int i = 0; i < 3; ++i) rows_abs[i] = abs(rows.row[i]);
    q = rows.row[0] * p[0] + rows.row[1] * p[1] + rows.row[2] * p[2];
    face_a = abs(p) - half_a - (abs(columns[0]) * b[0] + abs(columns[1]) * b[1] + abs(columns[2]) * b[2]);
    face_b = abs(q) - half_b - (rows_abs[0] * a[0] + rows_abs[1] * a[1] + rows_abs[2] * a[2]);
    rounding = kAxisRounding * std::numeric_limits<double>::epsilon() * sum3(half_a + half_b + abs(p));
  }

  const Eigen::Vector3d &a, &b;
  const Pose& X;
  Four columns[3];  // of R_AB
  Rows rows;
  Four p, q;        // B's centre along A's axes, and along B's
  Four rows_abs[3];
  Four face_a, face_b;  // separations
  double rounding;

 private:
  Four column(int k) const { return load_four(X.matrix().col(k).data()); }
};

// The edge pairs (i, 0), (i, 1), (i, 2).
struct EdgePairs {
  EdgePairs(const Relative& x, int i) {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    const Four &row_k = x.rows.row[k], &row_l = x.rows.row[l];
    const Four half_b = four(x.b);
    const Four reach_a = x.a[k] * x.rows_abs[l] + x.a[l] * x.rows_abs[k];
    const Four reach_b =
        rotated(half_b) * rotated_twice(x.rows_abs[i]) + rotated_twice(half_b) * rotated(x.rows_abs[i]);
    numerator = abs(x.p[l] * row_k - x.p[k] * row_l) - reach_a - reach_b;
    squared_sine = row_k * row_k + row_l * row_l;  // and not 1 − R_ij², which cancels for small angles
  }
  Four numerator;  // separation times sine
  Four squared_sine;
};

// x² with the sign of x: grows with x.
double signed_square(double x) { return x * std::abs(x); }
Four signed_square(const Four& x) { return x * abs(x); }

// A separation that is not divided out: numerator / √squared_sine. So axes are compared without roots and divisions.
struct Fraction {
  double numerator, squared_sine;
  double value() const { return numerator / std::sqrt(squared_sine); }
};

// Faces first. Then an edge must win by more than the rounding of its own evaluation, which grows as its sine falls:
// otherwise noise would turn the flat contact of nearly aligned boxes into an edge contact.
struct Best {
  Fraction gap;
  int axis;
};

Best best_axis(const Relative& x) {
  double face[6];
  for (int i = 0; i < 3; ++i) face[i] = x.face_a[i], face[3 + i] = x.face_b[i];
  Best best{{face[0], 1}, 0};
  for (int axis = 1; axis < 6; ++axis) {
    const bool better = face[axis] > best.gap.numerator;
    best.gap.numerator = better ? face[axis] : best.gap.numerator;
    best.axis = better ? axis : best.axis;
  }
  const double best_face = signed_square(best.gap.numerator);
  for (int i = 0; i < 3; ++i) {
    const EdgePairs edges(x, i);
    const auto beats_faces = (signed_square(edges.numerator - x.rounding) > best_face * edges.squared_sine) &
                             (edges.squared_sine >= kParallelSine * kParallelSine);
    if (!(beats_faces[0] | beats_faces[1] | beats_faces[2])) continue;
    for (int j = 0; j < 3; ++j) {
      const double numerator = edges.numerator[j], squared = edges.squared_sine[j];
      if (!beats_faces[j] || !(signed_square(numerator - x.rounding) * best.gap.squared_sine >
                               signed_square(best.gap.numerator) * squared))
        continue;
      best = {{numerator, squared}, kFirstEdge + 3 * i + j};
    }
  }
  return best;
}

}  // namespace

AxisSeparation largest_separation(const Box& a, const Box& b, const Pose& X_AB) {
  const Relative x(a, b, X_AB);
  const Best best = best_axis(x);
  return {best.axis < kFirstEdge ? best.gap.numerator : best.gap.value(), best.axis,
          axis_normal(X_AB, best.axis)};
}

Eigen::Vector3d axis_normal(const Pose& X_AB, int axis) {
  const auto R = X_AB.linear();
  const Eigen::Vector3d p = X_AB.translation();
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  if (axis < 3) {
    n[axis] = p[axis] < 0 ? -1 : 1;
  } else if (axis < kFirstEdge) {
    n = R.col(axis - 3);
    if (n.dot(p) < 0) n = -n;
  } else {
    const int i = (axis - kFirstEdge) / 3, j = (axis - kFirstEdge) % 3, k = (i + 1) % 3, l = (i + 2) % 3;
    const double inverse = 1 / std::sqrt(R(k, j) * R(k, j) + R(l, j) * R(l, j));
    const double scale = p[l] * R(k, j) - p[k] * R(l, j) < 0 ? -inverse : inverse;
    n[k] = -R(l, j) * scale;
    n[l] = R(k, j) * scale;
  }
  return n;
}

NamedSeparation largest_separation(const Box& a, const Box& b, const Pose& X_AB, const std::array<int, 3>& named) {
  const AxisSeparation best = largest_separation(a, b, X_AB);
  return {best, std::find(named.begin(), named.end(), best.axis) != named.end()};
}

bool surely_apart(const Box& a, const Box& b, const Pose& X_AB) {
  const Relative x(a, b, X_AB);
  const auto apart = (x.face_a > x.rounding) | (x.face_b > x.rounding);
  if (apart[0] | apart[1] | apart[2]) return true;
  auto by_edges = apart ^ apart;
  for (int i = 0; i < 3; ++i) {
    const EdgePairs edges(x, i);
    by_edges |= (edges.numerator > x.rounding) & (edges.squared_sine >= kParallelSine * kParallelSine);
  }
  return by_edges[0] | by_edges[1] | by_edges[2];
}

double separation(const Box& a, const Box& b, const Pose& X_AB) { return largest_separation(a, b, X_AB).gap; }

}  // namespace quayside::contact_nn
