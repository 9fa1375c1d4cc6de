// The report of a sweep: speed against error with every point named, and a table with failures first.
#pragma once

#include <filesystem>
#include <string>

#include "cases/case.h"
#include "harness/sweep.h"

namespace quayside::harness::report {

// `command`: as the user gave it. Throws std::runtime_error where the file cannot be written.
void write_sweep_report(const std::filesystem::path& file, const cases::Case& description, const Sweep& sweep,
                        const std::string& command);

}  // namespace quayside::harness::report
