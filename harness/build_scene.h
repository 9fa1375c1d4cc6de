// From a case to the Scene that the engines build.
#pragma once

#include "cases/case.h"
#include "contact_nn/contact.h"
#include "crane_models/scene.h"
#include "harness/engine_unit.h"

namespace quayside::harness {

// Throws cases::CaseError for what only shows when everything is placed: bodies that overlap without `allow_overlap`, a
// load that starts in the ground, ropes too short for the trolley's height.
crane_models::Scene build_scene(const cases::Case& description);

contact_nn::ContactSettings contact_settings(const cases::ContactSpec& spec);
SolverSettings solver_settings(const cases::Case& description);

}  // namespace quayside::harness
