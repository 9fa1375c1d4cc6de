// The machines of a case: crane and trailer with what they carry, by the words of the case file.
#pragma once

#include <string>

#include "cases/case.h"
#include "crane_models/scene.h"
#include "spreader/container.h"

namespace quayside::harness {

// Throws the cases::CaseError for what only shows when a case is built: its file, the key, what is wrong.
[[noreturn]] void refuse(const cases::Case& description, const std::string& key, const std::string& message);

spreader::ContainerSize container_size(cases::ContainerType type);

// Appends the crane, if the case has one, with the containers on its spreader. Throws cases::CaseError where there is no
// room for it to hang.
void add_crane(const cases::Case& description, crane_models::Scene& scene);

// Appends the trailer, if the case has one, with the container that stands on it.
void add_mafi(const cases::Case& description, crane_models::Scene& scene);

// The open twistlocks over containers to pick up, which are in the scene by now.
void add_pick_ups(const cases::Case& description, crane_models::Scene& scene);

}  // namespace quayside::harness
