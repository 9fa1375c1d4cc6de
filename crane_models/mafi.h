// A terminal tractor with its trailer (a MAFI): it follows a straight path, and its deck rests on four springs.
#pragma once

#include <array>
#include <optional>

#include "crane_models/drives.h"
#include "crane_models/load_side.h"

namespace quayside::crane_models {

// Defaults after data sheets of 40 ft terminal trailers for 60 t: 6 t tare, deck 1.2 m above the ground. Four springs of
// 1.4 MN/m let a full container bounce at about 2 Hz, as laden trailers on solid tyres do.
struct Mafi {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // of the middle of the deck at the start [m]
  double heading = 0;                                  // of the path against the world's x [rad]
  DriveLimits drive{6.0, 0.8, 0, 3.0};

  spreader::ContainerSize size = spreader::ContainerSize::iso40;  // for which the corner guides stand
  double deck_height = 1.2;             // of its top above the ground, at rest [m]
  double deck_mass = 6e3;               // [kg]
  double suspension_stiffness = 1.4e6;  // of one of the four springs, alike in all directions [N/m]
  double suspension_damping_ratio = 0.1;  // of the deck with its load, bouncing

  bool guides = true;           // at the corners of the deck
  double guide_height = 0.2;    // above the deck [m]
  double guide_clearance = 0.025;  // to each side of the container [m]

  // What stands on it at the start, and whether twistlocks hold it.
  std::optional<Load> load;
  bool twistlocks = false;
  std::array<bool, 4> stuck{};  // front left, rear left, rear right, front right: this one does not open
  spreader::Twistlocks twistlock;
};

// Appends to the scene, whose gravity must point down:
//   bodies   "mafi" (tractor and chassis, on its driven slider; the tractor collides), "deck" (with its guides), held by
//            the elastic lock "suspension"; the load, standing on the deck
//   drive    "mafi" (way along the path)
//   frames   "mafi" (on the ground under the middle of the deck), "deck" (middle of its top), the load's bottom
//   locks    with twistlocks "mafi_twistlocks" by the command of that name, and "stuck_twistlock" that nothing opens
// The start is in static equilibrium for a load with its centre of gravity in the middle.
void add_mafi(const Mafi& mafi, Scene& scene);

}  // namespace quayside::crane_models
