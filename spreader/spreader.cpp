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

std::vector<Plate> plates(const Spreader& spreader) {
  const Eigen::Vector3d frame = spreader.frame_size();
  std::vector<Plate> all{{{0, 0, frame.z() / 2}, frame}};
  if (!spreader.flippers.down) return all;
  const Flippers& f = spreader.flippers;
  const double out = f.clearance + f.thickness / 2;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      all.push_back({{x * (frame.x() - f.width) / 2, y * (frame.y() / 2 + out), -f.reach / 2},
                     {f.width, f.thickness, f.reach}});
      all.push_back({{x * (frame.x() / 2 + out), y * (frame.y() - f.width) / 2, -f.reach / 2},
                     {f.thickness, f.width, f.reach}});
    }
  }
  return all;
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
