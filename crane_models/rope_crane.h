// Cranes whose spreader hangs on four rope groups from a trolley, as their load sees them: quayside cranes and
// rubber-tyred gantries. They differ in their figures alone.
#pragma once

#include <optional>

#include "crane_models/drives.h"
#include "crane_models/load_side.h"

namespace quayside::crane_models {

struct RopeCrane {
  double trolley_position = 0;  // y of the trolley in the world [m]
  double trolley_height = 0;    // of the upper sheaves above the ground [m]
  double rope_length = 0;       // rest length of the hoist ropes [m]
  std::optional<double> gantry_position;  // x of the trolley in the world, where the crane travels [m]
  DriveLimits gantry, trolley, hoist;
  // Cylinders at the ropes' ends that make them of unequal length, where the crane has them: trim lowers the +x end
  // against the other, list the +y side, each by this difference; skew turns by lengthening one diagonal pair, +x+y and
  // −x−y, against the other [m].
  std::optional<double> trim_position, list_position, skew_position;
  DriveLimits trim, list, skew;

  // The long side of both rectangles lies along the container, so along the quay.
  Eigen::Vector2d trolley_sheaves;   // along x and y [m]
  Eigen::Vector2d spreader_sheaves;  // [m]
  double rope_stiffness;             // EA of one rope group [N]
  double rope_damping_time = 0.01;   // damping over stiffness [s]: a tenth of critical when a full container heaves

  LoadSide load_side;
  // Turns spreader, load and the upper sheaves alike about the vertical, as a skew device that shifts the rope anchors
  // does: the skewed pose is the equilibrium, and nothing turns back [rad].
  double anchor_skew = 0;
};

// A ship-to-shore crane. Typical of cranes in service, from makers' data sheets: trolleys run at 2.5 to 4 m/s with 0.6
// to 0.8 m/s², loads are hoisted at 1.0 to 1.33 m/s with 0.5 to 0.9 m/s², the gantry travels at 0.75 m/s; trim, list and
// skew turn the load by 3° to 5° either way at some 0.5°/s. A rope group is two falls of 42 MN each.
RopeCrane quayside_crane();

// A rubber-tyred gantry over six rows and a truck lane, one over five. Makers' data sheets: 40.6 t under the spreader,
// hoisted at 0.37 to 0.52 m/s, trolley 1.17 m/s with 0.35 m/s², gantry 2.25 m/s with 0.2 m/s². Its ropes spread widely
// from the trolley, which keeps the load from swaying; a group is two falls of 30 MN each.
RopeCrane rubber_tyred_gantry();

// Appends to the scene, whose gravity must point down, beside what `hang_loads` does:
//   bodies   "gantry" where it travels, "trolley", each on its driven slider, "spreader"
//   drives   "gantry" (x), "trolley" (y), "hoist" (rest length of the ropes; a positive speed lifts), "trim", "list",
//            "skew" (differences of rest length)
//   frames   "trolley" (middle of its sheaves), "spreader" (centre of its bottom face)
// Returns the index of the spreader.
//
// The start is at rest in static equilibrium: the ropes are stretched by the weight and hang as steep as it pulls them,
// the twistlocks are stretched by the load, and no contact there. A load whose centre of gravity is off its middle, or
// on ropes of unequal length, starts level all the same, and so will tilt.
int add_rope_crane(const RopeCrane& crane, Scene& scene);

// Distance between the sheave rectangles at that start [m].
double hanging_height(const RopeCrane& crane, const Scene& scene);

}  // namespace quayside::crane_models
