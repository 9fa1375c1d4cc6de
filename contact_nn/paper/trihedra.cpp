#include "contact_nn/paper/trihedra.h"

#include <cmath>

#include <fmt/format.h>

#include "contact_nn/separating_axes.h"

namespace quayside::contact_nn::paper {

namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double half = kEdge / 2;
constexpr double right_angle = M_PI / 2;

Vector3d point_on_edge(const EdgeLine& edge, Random& random) {
  Vector3d p = edge.middle;
  p[edge.axis] = random.uniform(-half, half);
  return p;
}

std::string vertex_name(int vertex) {
  const Vector3d v = vertex_of_b(vertex);
  return fmt::format("({:+.0f}, {:+.0f}, {:+.0f})", v[0], v[1], v[2]);
}

std::string edge_name(int edge, double sign) {
  const EdgeLine line = edge_of_trihedron(edge, sign);
  const int u = (line.axis + 1) % 3, v = (line.axis + 2) % 3;
  const char* axes = "xyz";
  return fmt::format("{} = {:+.0f}, {} = {:+.0f}", axes[u], line.middle[u], axes[v], line.middle[v]);
}

}  // namespace

Vector3d vertex_of_b(int vertex) {
  const auto sign = [&](int bit) { return vertex >> bit & 1 ? half : -half; };
  return {sign(0), sign(1), sign(2)};
}

EdgeLine edge_of_trihedron(int edge, double sign) {
  EdgeLine line{edge / 3, Vector3d::Zero()};
  const int m = edge % 3;
  line.middle[(line.axis + 1) % 3] = (m == 2 ? -half : half) * sign;
  line.middle[(line.axis + 2) % 3] = (m == 1 ? -half : half) * sign;
  return line;
}

std::string describe(const Subset& subset) {
  switch (subset.kind) {
    case Subset::Kind::everything: return "all features";
    case Subset::Kind::octant: return "Euler angles in [0, pi/2]";
    case Subset::Kind::pair: break;
  }
  if (subset.touch == Touch::vertex_on_face) {
    return fmt::format("B's vertex {} on A's face {} = +1", vertex_name(subset.of_b), "xyz"[subset.of_a]);
  }
  return fmt::format("B's edge ({}) on A's edge ({})", edge_name(subset.of_b, -1), edge_name(subset.of_a, 1));
}

std::uint64_t DrawCounts::vertices() const {
  std::uint64_t sum = 0;
  for (const auto& row : vertex_on_face) {
    for (auto n : row) sum += n;
  }
  return sum;
}

std::uint64_t DrawCounts::edges() const {
  std::uint64_t sum = 0;
  for (const auto& row : edge_on_edge) {
    for (auto n : row) sum += n;
  }
  return sum;
}

TouchingPose draw_pose(const Subset& subset, Random& random) {
  const bool pair = subset.kind == Subset::Kind::pair;
  TouchingPose pose;
  pose.touch = pair ? subset.touch : random.below(2) == 0 ? Touch::vertex_on_face : Touch::edge_on_edge;
  const double low = subset.kind == Subset::Kind::octant ? 0 : -right_angle;
  for (double& angle : pose.euler) angle = random.uniform(low, right_angle);
  const Matrix3d R = (AngleAxisd(pose.euler[2], Vector3d::UnitZ()) * AngleAxisd(pose.euler[1], Vector3d::UnitY()) *
                      AngleAxisd(pose.euler[0], Vector3d::UnitX())).toRotationMatrix();
  const auto feature = [&](int named, int of) { return pair ? named : static_cast<int>(random.below(of)); };
  Vector3d p_B;  // the same point in B's frame
  if (pose.touch == Touch::vertex_on_face) {
    pose.of_a = feature(subset.of_a, kFaces);
    pose.of_b = feature(subset.of_b, kVertices);
    for (double& x : pose.impact_A) x = random.uniform(-half, half);
    pose.impact_A[pose.of_a] = half;
    pose.n_A = Vector3d::Unit(pose.of_a);
    p_B = vertex_of_b(pose.of_b);
  } else {
    pose.of_a = feature(subset.of_a, kEdges);
    pose.of_b = feature(subset.of_b, kEdges);
    const EdgeLine edge_a = edge_of_trihedron(pose.of_a, 1), edge_b = edge_of_trihedron(pose.of_b, -1);
    pose.impact_A = point_on_edge(edge_a, random);
    p_B = point_on_edge(edge_b, random);
    pose.n_A = Vector3d::Unit(edge_a.axis).cross(R.col(edge_b.axis)).normalized();
    if (pose.n_A.dot(pose.impact_A) < 0) pose.n_A = -pose.n_A;  // A's centre lies behind the plane of contact
  }
  pose.X_AB.linear() = R;
  pose.X_AB.translation() = pose.impact_A - R * p_B;
  pose.X_AB.makeAffine();
  return pose;
}

bool overlaps(const TouchingPose& pose) {
  return largest_separation(cube(), cube(), pose.X_AB).gap < -kTouchingTolerance;
}

std::vector<TouchingPose> draw_poses(std::size_t count, Reading reading, const Subset& subset, Random& random,
                                     DrawCounts& counts) {
  std::vector<TouchingPose> poses;
  poses.reserve(count);
  while (poses.size() < count) {
    const TouchingPose pose = draw_pose(subset, random);
    ++counts.draws;
    const bool overlap = overlaps(pose);
    counts.overlapping += overlap;
    if (overlap && reading == Reading::valid) continue;
    if (pose.touch == Touch::vertex_on_face) {
      ++counts.vertex_on_face[pose.of_a][pose.of_b];
    } else {
      ++counts.edge_on_edge[pose.of_a][pose.of_b];
    }
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace quayside::contact_nn::paper
