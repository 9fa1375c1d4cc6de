// A reach stacker: a truck with a telescopic boom, and a spreader that hangs on damped pivots from its tip.
//
// It stands at x = 0 and faces +y. All of it is rigid but the two pivots; wheels, tipping and the hydraulics' give are
// not modelled.
#pragma once

#include "crane_models/drives.h"
#include "crane_models/load_side.h"

namespace quayside::crane_models {

// Defaults after makers' data sheets of 45 t machines with 6 m of wheel base: 45 t in the first row, 31 t in the second,
// 16 t in the third; lifting height 15.1 m, boom from 0° to 60°, lifting at 0.25 to 0.4 m/s, spreader turned by −95° to
// +185°, shifted by 0.8 m either way.
struct ReachStacker {
  double travel_position = 0;      // y of the front axle in the world [m]
  double boom_angle = 0.6;         // above the horizontal [rad]
  double telescope_length = 0;     // pushed out [m]
  double rotation_angle = 0;       // of the spreader about the vertical [rad]
  double side_shift_position = 0;  // of the spreader along its length [m]
  DriveLimits travel{2.5, 0.4, 0, 1.5};
  DriveLimits boom{0.045, 0.03, 0, 0.1, 0, 1.0472};
  DriveLimits telescope{0.35, 0.25, 0, 0.6, 0, 6.5};
  DriveLimits rotation{0.12, 0.06, 0, 0.2, -1.6581, 3.2289};
  DriveLimits side_shift{0.15, 0.15, 0, 0.3, -0.8, 0.8};

  Eigen::Vector2d boom_hinge{-4.6, 4.3};  // behind the front axle (y) and above the ground (z) [m]
  double boom_length = 8.4;               // from the hinge to the tip, pulled in [m]
  double boom_mass = 9e3;                 // outer boom, its middle at half length [kg]
  double inner_boom_mass = 4e3;           // slides in it; its middle 3 m behind the tip [kg]
  double head_mass = 2.5e3;               // pivots, rotator and side shift together [kg]
  double pivot_drop = 0.5;                // from the tip to the lower pivot [m]
  double spreader_drop = 1.4;             // from the lower pivot to the bottom of the spreader [m]
  double pivot_damping = 1.5e5;           // of each: about a tenth of critical with a full container [N m s/rad]

  LoadSide load_side;

  Eigen::Vector3d tip() const;  // in the world [m]
};

// Appends to the scene, whose gravity must point down, beside what `hang_loads` does:
//   bodies   "truck", "boom", "inner_boom", "link" and "head" on the pivots, "rotator", "spreader"
//   drives   "travel" (y), "boom" (angle), "telescope" (length), "rotation" (angle), "side_shift" (position)
//   frames   "boom_tip", "spreader"
// Returns the index of the spreader. The start is at rest; a load whose centre of gravity is off its middle will tilt.
int add_reach_stacker(const ReachStacker& machine, Scene& scene);

}  // namespace quayside::crane_models
