// report.html of a run: a player, plots, events and every judgement of the run in one file that opens without a server.
#pragma once

#include <filesystem>
#include <string>

#include "harness/summary.h"

namespace quayside::harness::report {

inline constexpr const char* kReportFile = "report.html";

// `command`: as the user gave it.
std::string run_report(const EvaluatedRun& evaluated, const std::string& command);

// Writes `kReportFile` into the directory. Throws std::runtime_error where it cannot be written.
void write_run_report(const std::filesystem::path& directory, const EvaluatedRun& evaluated, const std::string& command);

}  // namespace quayside::harness::report
