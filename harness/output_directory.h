// The files of a run: trajectory_<engine>.csv, events.csv, summary.json.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "harness/events_csv.h"
#include "harness/recording.h"
#include "harness/summary.h"

namespace quayside::harness {

// Makes the directory where it is missing, takes away what an earlier run left there (these files only) and makes sure that it
// can be written to: before the simulation, not after it. Throws std::runtime_error, naming the directory.
void prepare_output_directory(const std::filesystem::path& directory);

// Returns the names of the files written. Throws std::runtime_error, naming the file.
std::vector<std::string> write_output(const std::filesystem::path& directory, const EvaluatedRun& evaluated,
                                      const std::string& command);

// What a run left in its directory, by engine.
struct StoredRun {
  std::map<std::string, Recording> trajectories;
  std::map<std::string, EventRecord> events;  // empty where there is no events.csv
};

// Reads a directory of a run, or any CSV with a first column of time (under the engine name ""). Throws
// std::runtime_error for what is neither.
StoredRun read_run(const std::filesystem::path& path);

// A run as its directory tells it: everything but the wall time and the integrator's steps of every output interval; of
// energies and statistics only what stands in `summary`.
struct StoredResult {
  RunResult run;
  nlohmann::ordered_json summary;
};

// Throws std::runtime_error for a directory that is none that a run wrote, and for files in it that do not fit together.
StoredResult read_result(const std::filesystem::path& directory);

}  // namespace quayside::harness
