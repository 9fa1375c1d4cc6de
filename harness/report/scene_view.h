// What a player needs of a Scene: boxes and ropes, each told by the reported frame it moves with.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "harness/report/curves.h"
#include "harness/run.h"

namespace quayside::harness::report {

// {"bodies": [{"name", "frame", "boxes": [{"name", "half", "p", "q", "kind"}]}], "ropes": [{"name", "upper", "lower"}],
//  "rails": [{"p", "axis", "from", "to"}], "focus": "load", "gravity": [...]}
//
// `p` [m] and `q` (w, x, y, z) place a box in its frame, or in the world where `frame` is null. Kinds: container, ground,
// body; machine for a body without collision boxes, drawn as the uniform box of its inertia; left_out for what the
// reduction took out of the scene. A body that is neither fixed nor reported under any frame is not drawn.
nlohmann::ordered_json scene_view(const RunResult& run);

// Where each contact's force acts: curves contact.<a>.<b>.point.{x,y,z} [m] and contact.<a>.<b>.direction.{x,y,z} [1], the
// latter of the force on `b`. A recording tells the magnitude alone; point and direction are those of the case's contact
// law at the recorded poses and velocities, at most every `kContactInterval`, while the contact lasts.
void add_contact_views(const RunResult& run, const EngineRun& engine, CurveTable& table);

}  // namespace quayside::harness::report
