// What a player needs of a Scene: boxes and ropes, each told by the reported frame it moves with.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "harness/report/curves.h"
#include "harness/run.h"

namespace quayside::harness::report {

// {"bodies": [{"name", "frame", "boxes": [{"name", "half", "p", "q", "kind"}], "struts": [{"from", "to"}]}],
//  "ropes": [{"name", "upper", "lower"}],
//  "rails": [{"body", "frame", "p", "axis", "from", "to", "legs": [.., ..], "boom"}], "focus": "load", "gravity": [...]}
//
// `p` [m] and `q` (w, x, y, z) place a box in its frame, or in the world where `frame` is null. Kinds: container, ground,
// body; machine for a part without collision boxes, drawn as the uniform box of its inertia, in a frame of machine_view.h
// where none is reported, with struts to joints that lie off it; left_out for what the reduction took out of the scene. Rails: from `p` along `axis`; `legs` says
// where on them, and a `boom` reaches out beyond the legs.
//
// `full`: the scene before its reduction.
nlohmann::ordered_json scene_view(const RunResult& run, const crane_models::Scene& full);

// Where each contact's force acts: curves contact.<a>.<b>.point.{x,y,z} [m] and contact.<a>.<b>.direction.{x,y,z} [1], the
// latter of the force on `b`. A recording tells the magnitude alone; point and direction are those of the case's contact
// law at the recorded poses and velocities, at most every `kContactInterval`, while the contact lasts.
void add_contact_views(const RunResult& run, const EngineRun& engine, CurveTable& table);

}  // namespace quayside::harness::report
