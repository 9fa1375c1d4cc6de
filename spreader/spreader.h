// The spreader with its headblock, as one body, and the twistlocks under it.
//
// Frame S: centre of the bottom face of the frame, x along its length, z up.
#pragma once

#include <vector>

#include "spreader/container.h"
#include "spreader/lock.h"
#include "spreader/mass_properties.h"

namespace quayside::spreader {

// Between two 20 ft containers under a twin-lift spreader: three inches, with which they fill the place of a 40 ft one [m].
inline constexpr double kTwinGap = 0.076;

// Gathering guides ("flippers"): plates at the corners that reach below the frame and lead it onto a container. Makers
// let them reach down by about 0.3 m and leave a centimetre or two to the box; they are the spreader's guides, whose
// inner faces flare, taken here as upright plates. Raised, they are out of the way and do not exist.
struct Flippers {
  bool down = false;
  double reach = 0.3;        // below the bottom of the frame [m]
  double clearance = 0.015;  // to the sides of the container [m]
  double width = 0.4;        // along the edge [m]
  double thickness = 0.05;   // [m]
};

// A telescopic spreader set to one container size. Single-lift spreaders weigh 8 to 10 t and their headblocks 2.5 to 4
// t; the outlines are typical proportions of such machines. The frame has the outline of the container, and collides;
// the headblock stays within it and does not.
struct Spreader {
  ContainerSize container = ContainerSize::iso40;
  bool twin = false;                             // two 20 ft containers side by side; `container` is then iso40
  double mass = 12e3;                            // both together [kg]
  double headblock_share = 0.25;                 // of the mass
  double frame_height = 0.6;                     // [m]
  Eigen::Vector3d headblock_size{6.2, 1.4, 0.5};  // on top of the frame [m]
  double sheave_height = 1.1;                    // sheave axes above the bottom of the frame [m]

  Flippers flippers;

  Eigen::Vector3d frame_size() const {
    const Eigen::Vector3d& box = container_data(container).size;
    return {box.x(), box.y(), frame_height};
  }
  // Where along S's x the middle of a container is: the only one, or of a twin lift the first or second [m].
  double place(int index) const {
    if (!twin) return 0;
    return (index == 0 ? -0.5 : 0.5) * (container_data(ContainerSize::iso20).size.x() + kTwinGap);
  }
};

// Frame and headblock as uniform boxes, in S.
MassProperties mass_properties(const Spreader& spreader);

// What collides, in S: the frame, then the flippers where they are down.
struct Plate {
  Eigen::Vector3d centre, size;  // full edges [m]
};
std::vector<Plate> plates(const Spreader& spreader);

// Four twistlocks: stiffness of one [N/m] and damping ratio of the load that bounces on all four. A twistlock with its
// corner casting and the frame above it gives by somewhat less than a millimetre under a full container.
struct Twistlocks {
  double stiffness = 1e8;
  double damping_ratio = 0.05;
};

// The lock of `load_mass` [kg] under a spreader: pins at the apertures, in S and in the load's frame B, of which p_BT
// is the centre of the top face, axes as in S. Bodies and command are for the caller to fill in.
Lock twistlock_lock(const Twistlocks& twistlocks, ContainerSize container, double load_mass,
                    const Eigen::Vector3d& p_BT);

// How far a load's weight [N] stretches closed twistlocks when it hangs level [m].
double hanging_stretch(const Lock& lock, double weight);

}  // namespace quayside::spreader
