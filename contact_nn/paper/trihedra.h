// The paper's data: two cubes of edge 2, each split into two trihedra, touching at a known point.
//
// Cube A is centred at the origin of its frame; its trihedron is the faces x = 1, y = 1, z = 1. The trihedron of cube B
// is its faces x = −1, y = −1, z = −1, so that with no rotation the two trihedra face each other. A trihedron has 7 of
// the cube's 8 vertices and 9 of its 12 edges.
//
// One draw: an impact point, uniform on A's trihedron, and one of B's 7 vertices placed on it (vertex on face), or a
// point of one of A's 9 edges and one of B's 9 edges placed on it (edge on edge); then B is turned about that point by
// R_AB = R_z(γ) R_y(β) R_x(α), each angle uniform in [−π/2, π/2]. The paper leaves open whether poses in which the
// cubes then overlap were kept. Both readings are here: `valid` keeps the poses in which the solid cubes touch without
// overlapping, `unfiltered` keeps all, and then the same pose may come with several answers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "contact_nn/contact.h"
#include "contact_nn/random.h"

namespace quayside::contact_nn::paper {

inline constexpr double kEdge = 2;  // of both cubes [m]
inline Box cube() { return {Eigen::Vector3d::Constant(kEdge / 2)}; }

inline constexpr int kFaces = 3;     // x, y, z
inline constexpr int kVertices = 7;  // of a trihedron
inline constexpr int kEdges = 9;

// B's vertex 0 is (−1, −1, −1); bits 0, 1, 2 of the number mean +x, +y, +z. 7 = (1, 1, 1) is not of the trihedron.
Eigen::Vector3d vertex_of_b(int vertex);

// Edge 3 k + m runs along axis k; m tells the other two coordinates, on axes k + 1 and k + 2 (cyclic), in multiples of
// the trihedron's sign (A: +1, B: −1): 0 is (+, +), the edge at the corner, 1 is (+, −), 2 is (−, +).
struct EdgeLine {
  int axis;
  Eigen::Vector3d middle;
};
EdgeLine edge_of_trihedron(int edge, double sign);

enum class Touch { vertex_on_face, edge_on_edge };
enum class Reading { valid, unfiltered };

struct TouchingPose {
  Touch touch;
  int of_a, of_b;              // face and vertex, or edge and edge
  Eigen::Vector3d euler;       // α, β, γ [rad]
  Pose X_AB;
  Eigen::Vector3d impact_A;    // impact point [m]
  Eigen::Vector3d n_A;         // direction of the force on B, unit: out of A's face, or normal to both edges, out of A
};

// Which draws are kept. Impact point and force direction jump where the touching features change; a subset with one
// pair of features has no such jump:
//   everything  all draws
//   octant      Euler angles in [0, π/2], after the paper's "a change in the sign of one of the Euler angles": on the
//               face z = 1 it fixes the touching vertex, on the others it does not, so jumps remain
//   pair        one pair of features: one of B's vertices on one of A's faces (21 subsets), or one of B's edges on one
//               of A's edges (81). The force of a vertex on a face is then constant and the impact point is
//               p_AB + R_AB v; of two edges both are smooth but where the edges are parallel
struct Subset {
  enum class Kind { everything, octant, pair } kind = Kind::everything;
  Touch touch = Touch::vertex_on_face;
  int of_a = 0, of_b = 0;

  static Subset pair(Touch touch, int of_a, int of_b) { return {Kind::pair, touch, of_a, of_b}; }
};
std::string describe(const Subset& subset);

// How the draws went.
struct DrawCounts {
  std::uint64_t draws = 0;
  std::uint64_t overlapping = 0;                                     // of the draws
  std::array<std::array<std::uint64_t, kVertices>, kFaces> vertex_on_face{};  // kept, by face and vertex
  std::array<std::array<std::uint64_t, kEdges>, kEdges> edge_on_edge{};       // kept, by A's and B's edge

  std::uint64_t vertices() const;
  std::uint64_t edges() const;
};

// Deeper than this is an overlap [m]: the touching point is placed to rounding, 1e-16 of the cubes' size.
inline constexpr double kTouchingTolerance = 1e-9;

// One draw; vertex on face and edge on edge are equally likely unless the subset names a pair.
TouchingPose draw_pose(const Subset& subset, Random& random);
bool overlaps(const TouchingPose& pose);

// `count` poses. The same arguments give the same poses.
std::vector<TouchingPose> draw_poses(std::size_t count, Reading reading, const Subset& subset, Random& random,
                                     DrawCounts& counts);

}  // namespace quayside::contact_nn::paper
