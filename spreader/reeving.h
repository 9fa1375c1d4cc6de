// Four rope groups between two rectangles of sheaves, one on the trolley and one on the headblock.
//
// "front" is the water side (+y), "left" is −x, as the operator looks along the boom.
#pragma once

#include <array>

#include "spreader/rope.h"

namespace quayside::spreader {

// Sheaves at the corners of a rectangle on a body.
struct SheaveRectangle {
  int body = -1;
  Eigen::Vector3d p_BR = Eigen::Vector3d::Zero();  // centre, in the body's frame [m]
  double turn = 0;                                 // about the body's z axis [rad]
  Eigen::Vector2d size = Eigen::Vector2d::Zero();  // along its x and y [m]
};

// Four ropes "rope.front_left", "rope.front_right", "rope.rear_left", "rope.rear_right" between corresponding corners,
// with stiffness and the rest from `like`.
std::array<Rope, 4> reeve(const SheaveRectangle& upper, const SheaveRectangle& lower, const Rope& like);

// How far below the upper rectangle a load of `weight` [N] hangs in static equilibrium when both rectangles are level,
// concentric and turned alike [m]. `axial_stiffness`: EA of one rope group [N]; all lengths in [m].
double hanging_height(const Eigen::Vector2d& upper, const Eigen::Vector2d& lower, double axial_stiffness,
                      double rest_length, double weight);

}  // namespace quayside::spreader
