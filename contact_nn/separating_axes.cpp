#include "contact_nn/separating_axes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace quayside::contact_nn {
namespace {

// Below this sine two edges count as parallel and their common normal is not tried [1]. Skipping an axis of sine w/L
// under-reports a penetration d by at most w²/2d (the two neighbouring faces of the Minkowski difference share an
// edge with the skipped sliver of width w): 1e-9 m at 1 mm for 12 m edges. Trying it would cost ε L / sine, 2e-8 m.
constexpr double kParallelSine = 1e-7;

// Rounding of one axis' numerator, in units of ε times the size of the pair [1]: some ten operations.
constexpr double kRounding = 16;

// Everything the axes share: q is B's centre seen along B's own axes.
struct Relative {
  Relative(const Box& box_a, const Box& box_b, const Pose& X_AB)
      : a(box_a.half), b(box_b.half), R(X_AB.linear()), R_abs(R.cwiseAbs()), p(X_AB.translation()),
        q(R.transpose() * p),
        rounding(kRounding * std::numeric_limits<double>::epsilon() * (a.sum() + b.sum() + p.lpNorm<1>())) {}

  double face_a(int i) const { return std::abs(p[i]) - a[i] - R_abs.row(i).dot(b); }
  double face_b(int j) const { return std::abs(q[j]) - b[j] - R_abs.col(j).dot(a); }

  // Projection of p on e_i × f_j, not normalised.
  double along_edges(int i, int j) const {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    return p[l] * R(k, j) - p[k] * R(l, j);
  }
  // Separation times sine.
  double edge_numerator(int i, int j) const {
    const int k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
    return std::abs(along_edges(i, j)) - (a[k] * R_abs(l, j) + a[l] * R_abs(k, j)) -
           (b[m] * R_abs(i, n) + b[n] * R_abs(i, m));
  }
  // From the components and not from 1 − R_ij², which cancels for small angles.
  double squared_sine(int i, int j) const {
    const double x = R((i + 1) % 3, j), y = R((i + 2) % 3, j);
    return x * x + y * y;
  }

  Eigen::Vector3d normal(int axis) const {
    Eigen::Vector3d n = Eigen::Vector3d::Zero();
    if (axis < 3) {
      n[axis] = p[axis] < 0 ? -1 : 1;
    } else if (axis < 6) {
      n = R.col(axis - 3);
      if (q[axis - 3] < 0) n = -n;
    } else {
      const int i = (axis - 6) / 3, j = (axis - 6) % 3, k = (i + 1) % 3, l = (i + 2) % 3;
      n[k] = -R(l, j);
      n[l] = R(k, j);
      n /= std::sqrt(squared_sine(i, j));
      if (along_edges(i, j) < 0) n = -n;
    }
    return n;
  }

  Eigen::Vector3d a, b;
  Eigen::Matrix3d R, R_abs;
  Eigen::Vector3d p, q;
  double rounding;
};

// Does the edge pair beat `gap`, by more than `slack` over its sine? Compares gap · sine with the numerator, by squares.
bool edge_beats(const Relative& x, int i, int j, double gap, double slack) {
  const double squared = x.squared_sine(i, j);
  if (squared < kParallelSine * kParallelSine) return false;
  const double numerator = x.edge_numerator(i, j) - slack;
  if (numerator >= 0) return gap < 0 || numerator * numerator > gap * gap * squared;
  return gap < 0 && numerator * numerator < gap * gap * squared;
}

// Replaces the best by this axis if it is better. An edge must win by more than the rounding of its own evaluation,
// which grows as its sine falls: otherwise noise would turn the flat contact of nearly aligned boxes into an edge contact.
void keep_better(const Relative& x, int axis, double& gap, int& best) {
  if (axis < 6) {
    const double s = axis < 3 ? x.face_a(axis) : x.face_b(axis - 3);
    if (s > gap) gap = s, best = axis;
    return;
  }
  const int i = (axis - 6) / 3, j = (axis - 6) % 3;
  if (!edge_beats(x, i, j, gap, x.rounding)) return;
  gap = x.edge_numerator(i, j) / std::sqrt(x.squared_sine(i, j));
  best = axis;
}

}  // namespace

AxisSeparation largest_separation(const Box& a, const Box& b, const Pose& X_AB) {
  const Relative x(a, b, X_AB);
  double gap = -std::numeric_limits<double>::infinity();
  int best = 0;
  for (int axis = 0; axis < kAxisCount; ++axis) keep_better(x, axis, gap, best);
  return {gap, best, x.normal(best)};
}

NamedSeparation largest_separation(const Box& a, const Box& b, const Pose& X_AB, const std::array<int, 3>& named) {
  const Relative x(a, b, X_AB);
  double gap = -std::numeric_limits<double>::infinity();
  int best = -1;
  std::array<int, 3> order = named;  // as the whole test does it: faces first, which an edge must beat
  std::sort(order.begin(), order.end());
  for (const int axis : order) {
    assert(axis >= 0 && axis < kAxisCount);
    keep_better(x, axis, gap, best);
  }
  if (best < 0) return {largest_separation(a, b, X_AB), false};  // only parallel edges were named

  const double edge_slack =
      best < 6 ? 0 : x.rounding / std::sqrt(x.squared_sine((best - 6) / 3, (best - 6) % 3));
  bool certified = true;
  for (int i = 0; i < 3; ++i) {
    certified &= best == i || x.face_a(i) < gap - edge_slack || (i > best && x.face_a(i) == gap);
    certified &= best == 3 + i || x.face_b(i) < gap - edge_slack || (3 + i > best && x.face_b(i) == gap);
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      certified &= best == 6 + 3 * i + j || !edge_beats(x, i, j, gap, x.rounding);
  return {{gap, best, x.normal(best)}, certified};
}

bool surely_apart(const Box& a, const Box& b, const Pose& X_AB) {
  const Relative x(a, b, X_AB);
  for (int i = 0; i < 3; ++i)
    if (x.face_a(i) > x.rounding || x.face_b(i) > x.rounding) return true;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (x.squared_sine(i, j) >= kParallelSine * kParallelSine && x.edge_numerator(i, j) > x.rounding) return true;
  return false;
}

double separation(const Box& a, const Box& b, const Pose& X_AB) { return largest_separation(a, b, X_AB).gap; }

}  // namespace quayside::contact_nn
