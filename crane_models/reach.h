// How far what moves may get during a script, seen from above: who stands beyond is never touched.
#pragma once

#include <optional>
#include <vector>

#include "crane_models/reduction.h"
#include "crane_models/scene.h"

namespace quayside::crane_models {

using GroundPlan = Eigen::AlignedBox2d;  // a rectangle on the ground, along the world's x and y [m]

// Rectangles that nothing of the scene leaves: the places of all bodies that are not static, wider by what every drive in
// use can travel, by the sway that its changes of speed can excite, and by a margin for bounces and turns. Nothing, where
// no such bound is known: with bodies that start with a velocity, booms that turn, wind.
std::optional<std::vector<GroundPlan>> reach(const Scene& scene, const ScriptUse& use);

// Stacks stand on these places, `height` high: which of them may be touched by what moves within `reach`, or by stacks that
// fall on them. Only what a drive moves sideways can make a stack fall.
std::vector<bool> touched(const std::vector<GroundPlan>& stacks, double height, const std::vector<GroundPlan>& reach,
                          bool sideways);

// Whether the script moves anything along the ground.
bool moves_sideways(const Scene& scene, const ScriptUse& use);

}  // namespace quayside::crane_models
