// modelDescription.xml and its neighbours, as the FMUs that this project exports have them.
#pragma once

#include <string>
#include <vector>

#include "cases/case.h"
#include "crane_models/scene.h"
#include "harness/unit.h"

namespace quayside::harness {

enum class FmiVersion { fmi2 = 2, fmi3 = 3 };

struct DescriptionContents {
  const cases::Case& description;
  const std::vector<Variable>& variables;  // of the CaseUnit
  std::string token;
};

// Throws std::logic_error for a unit of measure that is not known.
std::string model_description(FmiVersion version, const DescriptionContents& contents);

// terminalsAndIcons.xml of FMI 3.0: the operator's commands in one terminal, each reported frame's pose in one of its own.
std::string terminals(const std::vector<Variable>& variables);

// documentation/index.html.
std::string documentation(const DescriptionContents& contents);

// By the structured naming convention: parts that are no identifiers ("my-box") stand in single quotes.
std::string structured_name(const std::string& name);

}  // namespace quayside::harness
