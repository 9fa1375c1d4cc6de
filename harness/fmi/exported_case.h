// What an exported FMU and its archive agree on.
#pragma once

#include <filesystem>
#include <string>

#include "cases/case.h"
#include "harness/unit.h"

namespace quayside::harness {

constexpr const char* kModelIdentifier = "quayside_fmu";  // name of the shared library, and of all its FMUs
constexpr const char* kCaseResource = "case.yaml";
constexpr const char* kNetworkResource = "network.onnx";  // there if the case names one

// Value references of the FMU: 0 is time, then the variables of the CaseUnit.
constexpr ValueReference kTimeReference = 0;
constexpr ValueReference kFirstReference = 1;

// Tells FMUs apart whose variables or states might differ: by the text of the case and the version of the program.
std::string instantiation_token(const std::string& case_text);

// From a folder of resources. Throws cases::CaseError.
cases::Case load_exported_case(const std::filesystem::path& resources);
std::string exported_case_text(const std::filesystem::path& resources);

}  // namespace quayside::harness
