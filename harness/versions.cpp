#include "harness/versions.h"

#include <Eigen/Core>
#include <fmt/format.h>

namespace quayside::harness {

// Engine headers stay in the engines' folders: the build says which versions it found.
std::vector<std::pair<std::string, std::string>> versions() {
  return {{"quayside", QUAYSIDE_VERSION},
          {"simbody", QUAYSIDE_SIMBODY_VERSION},
          {"sundials", QUAYSIDE_SUNDIALS_VERSION},
          {"mujoco", QUAYSIDE_MUJOCO_VERSION},
          {"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"compiler", QUAYSIDE_COMPILER}};
}

}  // namespace quayside::harness
