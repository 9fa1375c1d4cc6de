// report.html of a run: a player, plots, events and every judgement of the run in one file that opens without a server.
#pragma once

#include <filesystem>
#include <string>

#include "harness/summary.h"

namespace quayside::harness::report {

inline constexpr const char* kReportFile = "report.html";

// `summary`: as of summary.h. Of the run itself trajectories, events, case and scene are shown, and the integrator's steps and
// times where they are known.
std::string run_report(const RunResult& run, const nlohmann::ordered_json& summary);

// Writes `kReportFile` into the directory. Throws std::runtime_error where it cannot be written.
void write_run_report(const std::filesystem::path& directory, const RunResult& run, const nlohmann::ordered_json& summary);

}  // namespace quayside::harness::report
