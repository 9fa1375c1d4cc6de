#include "tests/benchmarks/peers/truth.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace quayside::peers {
namespace {

using contact_nn::Pose;
using Eigen::Vector3d;
using Corners = std::array<Vector3d, 8>;
using Polygon = std::vector<Vector3d>;

// Below this sine two edges give no axis: their common normal would be noise [1].
constexpr double kParallelSine = 1e-7;

// Everything in A's frame, where it is most accurate.
Corners corners(const Box& box, const Pose& X) {
  Corners out;
  for (int i = 0; i < 8; ++i) {
    out[static_cast<std::size_t>(i)] = X * box.half.cwiseProduct(Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  }
  return out;
}

double lowest(const Corners& c, const Vector3d& n) {
  double low = n.dot(c[0]);
  for (const Vector3d& p : c) low = std::min(low, n.dot(p));
  return low;
}
double highest(const Corners& c, const Vector3d& n) { return -lowest(c, -n); }

struct Face {
  Vector3d n;  // outward
  Polygon polygon;
};

std::vector<Face> faces(const Box& box, const Pose& X) {
  std::vector<Face> out;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      Face face;
      face.n = side * X.linear().col(axis);
      for (const auto& [s, t] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        Vector3d p;
        p[axis] = side * box.half[axis];
        p[(axis + 1) % 3] = s * box.half[(axis + 1) % 3];
        p[(axis + 2) % 3] = t * box.half[(axis + 2) % 3];
        face.polygon.push_back(X * p);
      }
      out.push_back(std::move(face));
    }
  }
  return out;
}

// The part of a polygon within the half-space n · x ≤ c.
Polygon clipped(const Polygon& in, const Vector3d& n, double c) {
  Polygon out;
  for (std::size_t k = 0; k < in.size(); ++k) {
    const Vector3d &p = in[k], &q = in[(k + 1) % in.size()];
    const double f = c - n.dot(p), g = c - n.dot(q);
    if (f >= 0) out.push_back(p);
    if ((f >= 0) != (g >= 0)) out.push_back(p + f / (f - g) * (q - p));
  }
  return out;
}

// The surface of the overlap is the part of either surface inside the other box; its volume is a sum of tetrahedra from a
// point inside.
Vector3d overlap_centroid(const std::vector<Face>& a, const std::vector<Face>& b) {
  std::vector<Polygon> surface;
  for (const auto* pair : {&a, &b}) {
    const std::vector<Face>& other = pair == &a ? b : a;
    for (const Face& face : *pair) {
      Polygon polygon = face.polygon;
      for (const Face& side : other) polygon = clipped(polygon, side.n, side.n.dot(side.polygon.front()));
      if (polygon.size() >= 3) surface.push_back(polygon);
    }
  }
  Vector3d inside = Vector3d::Zero();
  double count = 0;
  for (const Polygon& polygon : surface) {
    for (const Vector3d& p : polygon) inside += p, ++count;
  }
  inside /= count;
  Vector3d first_moment = Vector3d::Zero();
  double volume = 0;
  for (const Polygon& polygon : surface) {
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      const Vector3d u = polygon[0] - inside, v = polygon[k - 1] - inside, w = polygon[k] - inside;
      const double six_volumes = std::abs(u.dot(v.cross(w)));
      volume += six_volumes;
      first_moment += six_volumes * (u + v + w) / 4;
    }
  }
  return inside + first_moment / volume;
}

}  // namespace

Pose relative_pose(const Placed& pair) { return pair.X_WA.pose().inverse(Eigen::Isometry) * pair.X_WB.pose(); }

Truth truth_of(const Placed& pair) {
  const Pose X_AB = relative_pose(pair);
  const Corners a = corners(pair.a, Pose::Identity()), b = corners(pair.b, X_AB);
  std::vector<Vector3d> axes;
  for (int i = 0; i < 3; ++i) {
    axes.push_back(Vector3d::Unit(i));
    axes.push_back(X_AB.linear().col(i));
    for (int j = 0; j < 3; ++j) {
      const Vector3d n = Vector3d::Unit(i).cross(X_AB.linear().col(j));
      if (n.norm() > kParallelSine) axes.push_back(n.normalized());
    }
  }
  Truth truth;
  truth.gap = -std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, Vector3d>> separations;
  for (const Vector3d& axis : axes) {
    for (const Vector3d& n : {axis, Vector3d(-axis)}) {
      separations.emplace_back(lowest(b, n) - highest(a, n), n);
      truth.gap = std::max(truth.gap, separations.back().first);
    }
  }
  std::sort(separations.begin(), separations.end(), [](const auto& x, const auto& y) { return x.first > y.first; });
  for (const auto& [gap, n_A] : separations) {
    if (gap >= truth.gap - kTie * std::abs(truth.gap)) truth.normals_W.push_back(pair.X_WA.R * n_A);
  }
  truth.centre_W = truth.gap < 0 ? Vector3d(pair.X_WA.pose() * overlap_centroid(faces(pair.a, Pose::Identity()), faces(pair.b, X_AB)))
                                 : Vector3d(Vector3d::Constant(Answer::kNone));
  return truth;
}

double brute_force_depth(const Placed& pair) {
  const Pose X_AB = relative_pose(pair);
  const Corners a = corners(pair.a, Pose::Identity()), b = corners(pair.b, X_AB);
  Eigen::Matrix<double, 3, 64> difference;
  int count = 0;
  for (const Vector3d& p : a) {
    for (const Vector3d& q : b) difference.col(count++) = p - q;
  }
  const double size = difference.colwise().norm().maxCoeff();
  double depth = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 64; ++i) {
    for (int j = i + 1; j < 64; ++j) {
      const Vector3d edge = difference.col(j) - difference.col(i);
      for (int k = j + 1; k < 64; ++k) {
        const Vector3d n = edge.cross(Vector3d(difference.col(k) - difference.col(i)));
        const double length = n.norm();
        if (length < 1e-12 * size * size) continue;  // three points in a line
        const Eigen::Matrix<double, 1, 64> reach = n.transpose() * difference;
        depth = std::min(depth, std::min(reach.maxCoeff(), -reach.minCoeff()) / length);
      }
    }
  }
  return std::max(depth, 0.0);
}

}  // namespace quayside::peers
