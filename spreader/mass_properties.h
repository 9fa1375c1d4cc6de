// Mass, centre of mass and inertia of rigid bodies, and how they add up.
#pragma once

#include <Eigen/Geometry>

namespace quayside::spreader {

// Of a body in a frame B fixed on it.
struct MassProperties {
  double mass = 0;                                        // [kg]
  Eigen::Vector3d p_BBcm = Eigen::Vector3d::Zero();       // [m]
  Eigen::Matrix3d I_BBcm_B = Eigen::Matrix3d::Zero();     // about the centre of mass [kg m²]
};

// A box of uniform density about its centre, axes along its edges; `size`: full edges [m].
MassProperties uniform_box(double mass, const Eigen::Vector3d& size);

// The same body seen from frame A.
MassProperties moved(const MassProperties& in_B, const Eigen::Isometry3d& X_AB);

// Both together, in the frame they share: the parallel axis theorem about the common centre of mass.
MassProperties combined(const MassProperties& a, const MassProperties& b);

}  // namespace quayside::spreader
