// A lock holds two bodies together at a few points: the four twistlocks between spreader and container.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace quayside::spreader {

// One law in every engine: at each pair of points a linear spring and damper, equal in all directions. Closed and
// opened as one, by a command; what the springs hold when they open is lost and booked as dissipation.
struct Lock {
  struct Pin {
    Eigen::Vector3d p_A, p_B;  // the two points that coincide when locked, in the frames of body a and b [m]
  };
  std::string name;
  int body_a = -1, body_b = -1;  // indices in the scene
  std::vector<Pin> pins;
  double stiffness = 0;  // per pin [N/m]
  double damping = 0;    // per pin [N s/m]
  bool closed = true;    // at the start
  int command = -1;      // the scene's command that closes and opens it; −1: stays as it starts
};

}  // namespace quayside::spreader
