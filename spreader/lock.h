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
  // It closes only where no pin is farther off than this, and refuses otherwise [m]; 0: closes anywhere.
  double reach = 0;
  bool elastic = false;  // a suspension: its give is what matters, so that nothing may take it for rigid
};

// What one pin of a closed lock does.
struct PinLoad {
  Eigen::Vector3d force;        // on body b; body a gets its opposite [N]
  double energy = 0;            // ½ k |offset|² [J]
  double dissipated_power = 0;  // c |velocity|², never negative [W]
};

// `offset`: from the pin's point on a to that on b [m]. `velocity`: of b against a, both as material velocities at the
// midpoint of the two points [m/s]. Frame of the result is that of the arguments.
//
// Both forces act at that midpoint. There a pair of opposite forces keeps linear and angular momentum exactly, however
// far apart the points are, and the spring still does the work of its energy: its line of action runs through both
// points, so their midpoint will do as well.
PinLoad pin_load(const Lock& lock, const Eigen::Vector3d& offset, const Eigen::Vector3d& velocity);

}  // namespace quayside::spreader
