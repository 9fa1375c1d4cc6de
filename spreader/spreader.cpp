#include "spreader/spreader.h"

#include <cmath>

namespace quayside::spreader {

MassProperties mass_properties(const Spreader& spreader) {
  const double headblock_mass = spreader.headblock_share * spreader.mass;
  MassProperties frame = uniform_box(spreader.mass - headblock_mass, spreader.frame_size());
  MassProperties headblock = uniform_box(headblock_mass, spreader.headblock_size);
  frame.p_BBcm.z() = spreader.frame_height / 2;
  headblock.p_BBcm.z() = spreader.frame_height + spreader.headblock_size.z() / 2;
  return combined(frame, headblock);
}

Lock twistlock_lock(const Twistlocks& twistlocks, ContainerSize container, double load_mass,
                    const Eigen::Vector3d& p_BT) {
  Lock lock;
  lock.name = "twistlocks";
  for (const Eigen::Vector3d& p : aperture_centres(container)) lock.pins.push_back({p, p_BT + p});
  lock.stiffness = twistlocks.stiffness;
  // Each pin carries its share of the mass: c = 2 ζ √(k m/4).
  lock.damping = 2 * twistlocks.damping_ratio * std::sqrt(twistlocks.stiffness * load_mass / lock.pins.size());
  return lock;
}

double hanging_stretch(const Lock& lock, double weight) { return weight / (lock.stiffness * lock.pins.size()); }

}  // namespace quayside::spreader
