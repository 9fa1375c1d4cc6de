// A quayside (ship-to-shore) crane as its load sees it: a trolley that runs along the boom, four rope groups, and the
// spreader with headblock.
#pragma once

#include <optional>
#include <string>

#include "crane_models/scene.h"
#include "spreader/spreader.h"

namespace quayside::crane_models {

struct DriveLimits {
  double max_speed;         // [m/s]
  double max_acceleration;  // [m/s²]
};

// Defaults are typical of cranes in service, from makers' data sheets: trolleys run at 2.5 to 4 m/s with 0.6 to 0.8
// m/s², loads are hoisted at 1.0 to 1.33 m/s with 0.5 to 0.9 m/s².
struct QuaysideCrane {
  double trolley_position = 0;  // y of the trolley in the world [m]
  double trolley_height = 0;    // of the upper sheaves above the ground [m]
  double rope_length = 0;       // rest length of the hoist ropes [m]
  DriveLimits trolley{3.0, 0.7};
  DriveLimits hoist{1.2, 0.7};

  // The long side of both rectangles lies along the container, so along the quay.
  Eigen::Vector2d trolley_sheaves{5.78, 1.30};   // along x and y [m]
  Eigen::Vector2d spreader_sheaves{5.55, 0.80};  // [m]
  double rope_stiffness = 84e6;      // EA of one rope group: two falls of 42 MN each [N]
  double rope_damping_time = 0.01;   // damping over stiffness [s]: a tenth of critical when a full container heaves

  spreader::Spreader spreader;
  spreader::Twistlocks twistlocks;
  // Turns spreader, load and the upper sheaves alike about the vertical, as a skew device that shifts the rope anchors
  // does: the skewed pose is the equilibrium, and nothing turns back [rad].
  double skew = 0;

  struct Load {
    std::string name;
    double mass = 0;                                              // [kg]
    spreader::ContainerSize size = spreader::ContainerSize::iso40;
    Eigen::Vector3d centre_of_gravity = Eigen::Vector3d::Zero();  // from the centre of the box [m]
  };
  std::optional<Load> load;
};

// Appends to the scene, whose gravity must point down:
//   bodies   "trolley" on its driven slider, "spreader", and the load, locked by the lock "twistlocks"
//   drives   "trolley" (y of the trolley), "hoist" (rest length of the ropes; a positive speed lifts)
//   command  "twistlocks" (true: closed), where there is a load
//   switch   "landed": contacts push the spreader and its load up by more than half the weight of the load (of the
//            spreader, where there is none)
//   frames   "trolley" (middle of its sheaves), "spreader" (centre of its bottom face), the load's bottom
//
// The start is at rest in static equilibrium: the ropes are stretched by the weight and hang as steep as it pulls them,
// the twistlocks are stretched by the load, which so leaves a gap of just that stretch under the spreader, and no
// contact there. A load whose centre of gravity is off its middle starts level all the same, and so will tilt.
void add_quayside_crane(const QuaysideCrane& crane, Scene& scene);

// Distance between the sheave rectangles at that start [m].
double hanging_height(const QuaysideCrane& crane, const Scene& scene);

}  // namespace quayside::crane_models
