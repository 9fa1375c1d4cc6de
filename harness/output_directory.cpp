#include "harness/output_directory.h"

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

namespace quayside::harness {

namespace {

namespace fs = std::filesystem;

const char* const kSummary = "summary.json";
const char* const kEvents = "events.csv";
const std::string kTrajectoryPrefix = "trajectory_";
const std::string kTrajectorySuffix = ".csv";

// The engine that a file is the trajectory of; empty for other files.
std::string engine_of(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::size_t frame = kTrajectoryPrefix.size() + kTrajectorySuffix.size();
  const bool fits = name.size() > frame && name.compare(0, kTrajectoryPrefix.size(), kTrajectoryPrefix) == 0 &&
                    name.compare(name.size() - kTrajectorySuffix.size(), std::string::npos, kTrajectorySuffix) == 0;
  return fits ? name.substr(kTrajectoryPrefix.size(), name.size() - frame) : "";
}

[[noreturn]] void fail(const fs::path& path, const std::string& problem) {
  throw std::runtime_error(fmt::format("{}: {}", path.string(), problem));
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) fail(file, "cannot be written");
}

nlohmann::ordered_json read_summary(const fs::path& directory) {
  std::error_code error;
  if (!fs::exists(directory, error)) fail(directory, "does not exist, expected the directory of a run");
  if (!fs::is_directory(directory, error)) fail(directory, "is a file, expected the directory of a run");
  const fs::path file = directory / kSummary;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(directory, "holds no summary.json that can be read, expected the directory of a run");
  const auto summary = nlohmann::ordered_json::parse(stream, nullptr, false);
  if (!summary.is_object() || !summary.contains("case") || !summary["case"].is_object() || !summary.contains("engines") ||
      !summary["engines"].is_object() || !summary.contains("scene") || !summary["scene"].contains("left_out"))
    fail(file, "is not the summary of a run");
  if (!summary["case"].contains("text") || !summary["case"]["text"].is_string())
    fail(file, "does not tell the text of the case, as an earlier version wrote it; please run the case again");
  return summary;
}

}  // namespace

void prepare_output_directory(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) fail(directory, fmt::format("cannot be made ({}); name another directory with --out", error.message()));
  std::vector<fs::path> old{directory / kSummary, directory / kEvents, directory / "report.html"};
  for (const auto& entry : fs::directory_iterator(directory, error))
    if (!engine_of(entry.path()).empty()) old.push_back(entry.path());
  for (const fs::path& file : old) {
    if (!error) fs::remove(file, error);
  }
  if (error) fail(directory, fmt::format("cannot be used ({}); name another directory with --out", error.message()));

  const fs::path probe = directory / kSummary;
  if (!std::ofstream(probe)) fail(directory, "cannot be written to; name another directory with --out");
  fs::remove(probe, error);
}

std::vector<std::string> write_output(const fs::path& directory, const EvaluatedRun& evaluated, const std::string& command) {
  std::vector<std::string> written;
  std::vector<EngineEvents> events;
  for (const EngineRun& engine : evaluated.run.engines) {
    written.push_back(kTrajectoryPrefix + engine.engine + kTrajectorySuffix);
    write_csv(engine.trajectory, directory / written.back());
    events.push_back({engine.engine, {engine.events, engine.open_contacts}});
  }
  write_events_csv(events, directory / kEvents);
  written.emplace_back(kEvents);
  write_text(directory / kSummary, summary(evaluated, command).dump(2) + "\n");
  written.emplace_back(kSummary);
  return written;
}

StoredRun read_run(const fs::path& path) {
  StoredRun run;
  std::error_code error;
  if (!fs::exists(path, error)) fail(path, "does not exist, expected the directory of a run or a CSV file");
  if (!fs::is_directory(path)) {
    run.trajectories[""] = read_csv(path);
    return run;
  }
  for (const auto& entry : fs::directory_iterator(path)) {
    const std::string engine = engine_of(entry.path());
    if (!engine.empty()) run.trajectories[engine] = read_csv(entry.path());
  }
  if (run.trajectories.empty()) fail(path, "holds no trajectory_<engine>.csv, expected the directory of a run");
  if (fs::exists(path / kEvents)) {
    for (const auto& [engine, trajectory] : run.trajectories) run.events[engine];  // an engine without events has no rows
    for (EngineEvents& engine : read_events_csv(path / kEvents)) run.events[engine.engine] = std::move(engine.record);
  }
  return run;
}

StoredResult read_result(const fs::path& directory) {
  StoredResult result;
  result.summary = read_summary(directory);
  const auto& about = result.summary["case"];
  RunResult& run = result.run;
  run.description = cases::parse_case(about["text"], about.value("file", ""));
  // A scene in full has nothing left out, and one of which nothing could be left out is the same in full.
  const bool full_scene = result.summary["scene"]["left_out"].empty();
  run.scene = simulated_scene(run.description, full_scene, run.reduction);

  StoredRun stored = read_run(directory);
  for (const auto& [name, about_engine] : result.summary["engines"].items()) {
    const auto trajectory = stored.trajectories.find(name);
    if (trajectory == stored.trajectories.end()) fail(directory, fmt::format("{}{}{} is missing", kTrajectoryPrefix, name, kTrajectorySuffix));
    EngineRun engine;
    engine.engine = name;
    engine.trajectory = std::move(trajectory->second);
    const auto demand = [&, &names = engine.trajectory.names](const std::string& signal) {
      if (std::find(names.begin(), names.end(), signal) == names.end())
        fail(directory / (kTrajectoryPrefix + name + kTrajectorySuffix), fmt::format("lacks '{}', which the case has", signal));
    };
    for (const Variable& variable : engine_variables(run.scene))
      if (variable.causality == Causality::output) demand(variable.name);
    for (const crane_models::Drive& drive : run.scene.drives) demand(drive.name + ".value");
    engine.events = std::move(stored.events[name].events);
    engine.open_contacts = std::move(stored.events[name].open_contacts);
    run.engines.push_back(std::move(engine));
  }
  return result;
}

}  // namespace quayside::harness
