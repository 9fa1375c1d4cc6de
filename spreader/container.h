// ISO freight containers.
#pragma once

#include <array>

#include <Eigen/Core>

namespace quayside::spreader {

enum class ContainerSize { iso20, iso40, iso40_high_cube, iso45 };

// External dimensions after ISO 668, tare of common steel boxes.
struct ContainerData {
  Eigen::Vector3d size;          // length, width, height [m]
  Eigen::Vector2d apertures;     // between the centres of the corner castings' apertures, along and across [m]
  double tare;                   // [kg]
};

const ContainerData& container_data(ContainerSize size);

// The centres of the four top (or bottom) apertures, from the middle of that face: where twistlocks engage. In the
// order +x+y, −x+y, −x−y, +x−y [m].
std::array<Eigen::Vector3d, 4> aperture_centres(ContainerSize size);

}  // namespace quayside::spreader
