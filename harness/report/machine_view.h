// Where the parts of machines are of which no frame is reported: booms, rotators, gantries.
//
// The reported frames and the drives' values tell it: from a body whose place is known one goes on over fixed and driven
// joints, to children and to parents, and the cross of a joint of two passive hinges is where both axes say.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "crane_models/scene.h"
#include "harness/recording.h"
#include "harness/report/curves.h"

namespace quayside::harness::report {

using Poses = std::vector<std::optional<crane_models::Pose>>;  // X_WB by body, where it is known

// Adds all that follows from what is known. `drive_values`: in the order of the scene's drives.
void complete(const crane_models::Scene& scene, const std::vector<double>& drive_values, Poses& poses);

// Bodies without collision boxes that move, that no frame is reported of and whose place follows all the same.
std::vector<int> machine_parts(const crane_models::Scene& scene);

// The name under which such a part's pose is told.
std::string part_frame(const crane_models::Body& part);

// Curves <part frame>.position.{x,y,z} [m] and <part frame>.orientation.{w,x,y,z} [1] of every machine part. `scene`: not
// reduced, so that every part is a body of its own.
void add_machine_views(const crane_models::Scene& scene, const Recording& recording, CurveTable& table);

}  // namespace quayside::harness::report
