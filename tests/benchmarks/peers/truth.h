// What is true of two boxes, found without the contact module: by their corners alone, slowly.
#pragma once

#include <vector>

#include "tests/benchmarks/peers/contender.h"

namespace quayside::peers {

struct Truth {
  // Largest separation over the 15 axes, each from the 16 corners' projections [m]; negative when overlapping.
  double gap;
  // Unit normals from A to B: that of the gap, then all whose separation is within `kTie` of it. Any of them is right.
  std::vector<Eigen::Vector3d> normals_W;
  // Centroid of the overlapping volume, where an elastic foundation would press; NaN when apart [m].
  Eigen::Vector3d centre_W;
};

contact_nn::Pose relative_pose(const Placed& pair);  // X_AB

inline constexpr double kTie = 0.01;  // share of the depth

Truth truth_of(const Placed& pair);

// The least distance that B must be moved to part from A, or 0 [m]: the least over the directions of all planes through three
// points of the Minkowski difference, of how far the difference reaches in that direction. Every direction gives an upper
// bound and the nearest facet of the difference is among them. Knows nothing of faces, edges and axes.
double brute_force_depth(const Placed& pair);

}  // namespace quayside::peers
