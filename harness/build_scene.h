// From a case to the Scene that the engines build.
#pragma once

#include "cases/case.h"
#include "contact_nn/contact.h"
#include "crane_models/reduction.h"
#include "crane_models/scene.h"
#include "harness/engine_unit.h"

namespace quayside::harness {

// Throws cases::CaseError for what only shows when everything is placed: bodies that overlap without `allow_overlap`, a
// load that starts in the ground, ropes too short for the trolley's height.
crane_models::Scene build_scene(const cases::Case& description);

// What was not even built, since nothing that the script moves can touch it.
struct LeftOut {
  int containers = 0;
  std::string reason;

  void add_to(crane_models::ReductionReport& report) const;
};

// The same without stacks that nothing can touch: a yard of ten thousand containers costs what stands around the one that
// moves. Conservative: where no bound is known of what moves, everything is built.
crane_models::Scene build_scene(const cases::Case& description, LeftOut& left_out);

contact_nn::ContactSettings contact_settings(const cases::ContactSpec& spec);
SolverSettings solver_settings(const cases::Case& description);

}  // namespace quayside::harness
