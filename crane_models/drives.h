// What a machine says about its motors, and how they come into a Scene.
#pragma once

#include <string>

#include "crane_models/scene.h"

namespace quayside::crane_models {

struct DriveLimits {
  double max_speed;          // [m/s or rad/s]
  double max_acceleration;   // [m/s² or rad/s²]
  double max_jerk = 0;       // [m/s³ or rad/s³]; 0: the acceleration may jump
  double emergency_stop = 0;  // deceleration of an emergency stop [m/s² or rad/s²]; 0: max_acceleration
  // Limit switches [m or rad].
  double lowest = -std::numeric_limits<double>::infinity(), highest = std::numeric_limits<double>::infinity();
};

// Appends the drive and returns its index. `unit`: "m" or "rad".
int add_drive(Scene& scene, const std::string& name, const std::string& unit, const std::string& meaning, double start,
              double sign, const DriveLimits& limits);

// Joints of machines whose bodies all have their axes along the world's when every coordinate is zero: along or about
// the parent's x, y or z (0, 1, 2), at p_PB in the parent's frame, the body's origin on the axis.
Joint slider_along(int axis, int parent, const Eigen::Vector3d& p_PB, int drive);
Joint hinge_about(int axis, int parent, const Eigen::Vector3d& p_PB, int drive);

}  // namespace quayside::crane_models
