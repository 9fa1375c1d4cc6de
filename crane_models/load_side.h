// What hangs under a machine: the spreader and what its twistlocks hold.
#pragma once

#include <string>
#include <vector>

#include "crane_models/scene.h"
#include "spreader/spreader.h"

namespace quayside::crane_models {

struct Load {
  std::string name;
  double mass = 0;                                              // [kg]
  spreader::ContainerSize size = spreader::ContainerSize::iso40;
  Eigen::Vector3d centre_of_gravity = Eigen::Vector3d::Zero();  // from the centre of the box [m]
};

struct LoadSide {
  spreader::Spreader spreader;
  spreader::Twistlocks twistlocks;
  // Held at the start; under a twin-lift spreader two, the first at −x.
  std::vector<Load> loads;

  double mass() const;  // of all of it [kg]
};

// Frame S on the middle of its bottom face; joint and start are for the caller.
Body spreader_body(const LoadSide& side);

// Appends the loads under the spreader, which is in its place:
//   bodies   the loads, locked by "twistlocks" (twin lift: "twistlocks_left", "twistlocks_right")
//   command  "twistlocks" (true: closed), where there is a load
//   switch   "landed": contacts push the spreader and its loads up by more than half the weight of the loads (of the
//            spreader, where there are none)
//   frames   "spreader" (centre of its bottom face), the loads' bottoms
// The twistlocks are stretched by the loads, which so leave a gap of just that stretch under the spreader.
void hang_loads(const LoadSide& side, int spreader_body, Scene& scene);

// Twistlocks that stand open under the spreader and can close on a container that is in the scene already. `place`: 0,
// under a twin-lift spreader 0 (−x) or 1.
void aim_at(const LoadSide& side, int spreader_body, int container_body, const Load& container, int place,
            Scene& scene);

}  // namespace quayside::crane_models
