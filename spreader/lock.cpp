#include "spreader/lock.h"

namespace quayside::spreader {

PinLoad pin_load(const Lock& lock, const Eigen::Vector3d& offset, const Eigen::Vector3d& velocity) {
  return {-lock.stiffness * offset - lock.damping * velocity, 0.5 * lock.stiffness * offset.squaredNorm(),
          lock.damping * velocity.squaredNorm()};
}

}  // namespace quayside::spreader
