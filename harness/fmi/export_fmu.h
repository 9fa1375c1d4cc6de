// Writes a case as an FMU for Co-Simulation.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/fmi/write_description.h"

namespace quayside::harness {

// `library`: quayside_fmu.so, which goes into the FMU with all that it needs. Throws cases::CaseError for a case that
// cannot be built, std::runtime_error for files that are missing or cannot be written.
void export_fmu(const std::filesystem::path& case_file, const std::vector<std::string>& overrides, FmiVersion version,
                const std::filesystem::path& library, const std::filesystem::path& fmu);

}  // namespace quayside::harness
