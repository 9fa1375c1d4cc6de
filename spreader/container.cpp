#include "spreader/container.h"

namespace quayside::spreader {

const ContainerData& container_data(ContainerSize size) {
  static const ContainerData iso20{{6.058, 2.438, 2.591}, {5.853, 2.259}, 2300};
  static const ContainerData iso40{{12.192, 2.438, 2.591}, {11.985, 2.259}, 3940};
  static const ContainerData iso40_high_cube{{12.192, 2.438, 2.896}, {11.985, 2.259}, 4120};
  static const ContainerData iso45{{13.716, 2.438, 2.896}, {13.509, 2.259}, 4800};
  switch (size) {
    case ContainerSize::iso20: return iso20;
    case ContainerSize::iso40: return iso40;
    case ContainerSize::iso40_high_cube: return iso40_high_cube;
    case ContainerSize::iso45: break;
  }
  return iso45;
}

std::array<Eigen::Vector3d, 4> aperture_centres(ContainerSize size) {
  const double x = container_data(size).apertures.x() / 2, y = container_data(size).apertures.y() / 2;
  return {{{x, y, 0}, {-x, y, 0}, {-x, -y, 0}, {x, -y, 0}}};
}

}  // namespace quayside::spreader
