#include "crane_models/drives.h"

namespace quayside::crane_models {
namespace {

// A frame whose x axis (column `first` = 0) or z axis (2) is the given axis, the others following in their order.
Pose frame_with(int column, int axis) {
  Pose X = Pose::Identity();
  X.linear().setZero();
  for (int i = 0; i < 3; ++i) X.linear()((axis + i) % 3, (column + i) % 3) = 1;
  return X;
}

Joint joint_with(JointType type, const Pose& axes, int parent, const Eigen::Vector3d& p_PB, int drive) {
  Joint joint;
  joint.type = type;
  joint.parent = parent;
  joint.X_PF = Eigen::Translation3d(p_PB) * axes;
  joint.X_BM = axes;
  joint.drive = drive;
  return joint;
}

}  // namespace

int add_drive(Scene& scene, const std::string& name, const std::string& unit, const std::string& meaning, double start,
              double sign, const DriveLimits& limits) {
  Drive drive{name, unit, meaning, start, sign, limits.max_speed, limits.max_acceleration};
  drive.max_jerk = limits.max_jerk;
  drive.emergency_stop = limits.emergency_stop > 0 ? limits.emergency_stop : limits.max_acceleration;
  drive.lowest = limits.lowest;
  drive.highest = limits.highest;
  scene.drives.push_back(drive);
  return static_cast<int>(scene.drives.size()) - 1;
}

Joint slider_along(int axis, int parent, const Eigen::Vector3d& p_PB, int drive) {
  return joint_with(JointType::slider, frame_with(0, axis), parent, p_PB, drive);
}

Joint hinge_about(int axis, int parent, const Eigen::Vector3d& p_PB, int drive) {
  return joint_with(JointType::hinge, frame_with(2, axis), parent, p_PB, drive);
}

}  // namespace quayside::crane_models
