#include <algorithm>
#include <fstream>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "harness/commands/commands.h"
#include "harness/compare.h"
#include "harness/names.h"
#include "harness/output_directory.h"
#include "harness/run_text.h"
#include "harness/validation.h"

namespace quayside::harness {

namespace {

struct CompareCommand {
  std::string first, second;
  std::vector<std::string> engines, signals;
  std::string table;
  bool json = false;

  void execute() const;
};

std::vector<std::string> engines_of(const StoredRun& run) {
  std::vector<std::string> names;
  for (const auto& [engine, trajectory] : run.trajectories) names.push_back(engine);
  return names;
}

// Which trajectory of the first run is held against which of the second: equal engines; a file against every engine.
std::vector<std::pair<std::string, std::string>> matched_engines(const StoredRun& a, const StoredRun& b,
                                                                 const std::vector<std::string>& wanted) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const std::string& engine_a : engines_of(a))
    for (const std::string& engine_b : engines_of(b))
      if (engine_a == engine_b || engine_a.empty() || engine_b.empty()) pairs.emplace_back(engine_a, engine_b);
  if (wanted.empty()) return pairs;
  std::vector<std::pair<std::string, std::string>> chosen;
  for (const auto& pair : pairs)
    for (const std::string& engine : wanted)
      if (engine == pair.first || engine == pair.second) chosen.push_back(pair);
  return chosen;
}

std::vector<Event> events_of(const StoredRun& run, const std::string& engine) {
  const auto found = run.events.find(engine);
  if (found == run.events.end()) return {};
  std::vector<Event> events = found->second.events;
  events.insert(events.end(), found->second.open_contacts.begin(), found->second.open_contacts.end());
  return events;
}

TrajectoryComparison only(TrajectoryComparison comparison, const std::vector<std::string>& wanted) {
  if (wanted.empty()) return comparison;
  std::vector<std::string> names;
  std::vector<SignalDifference> chosen;
  for (const SignalDifference& signal : comparison.signals) names.push_back(signal.signal);
  for (const std::string& name : wanted) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
      throw std::runtime_error(fmt::format("--signal {}: the two have no such signal in common; {}", name, nearest_names(name, names)));
    chosen.push_back(comparison.signals[static_cast<std::size_t>(found - names.begin())]);
  }
  comparison.signals = chosen;
  return comparison;
}

void CompareCommand::execute() const {
  const StoredRun a = read_run(first), b = read_run(second);
  const auto pairs = matched_engines(a, b, engines);
  if (pairs.empty())
    throw std::runtime_error(fmt::format("{} has the engines {}, {} has {}: nothing to compare; give two trajectory files to "
                                         "compare one engine with another",
                                         first, fmt::join(engines_of(a), ", "), second, fmt::join(engines_of(b), ", ")));
  const Style style = style_for(STDOUT_FILENO);
  auto all = nlohmann::ordered_json::object();
  std::string table_text = kValidationHeader;
  for (const auto& [engine_a, engine_b] : pairs) {
    const std::string name = !engine_a.empty() ? engine_a : !engine_b.empty() ? engine_b : "trajectory";
    const TrajectoryComparison whole = compare_trajectories(a.trajectories.at(engine_a), b.trajectories.at(engine_b));
    if (whole.samples == 0) throw std::runtime_error(fmt::format("{} and {} have no time in common ({})", first, second, name));
    if (whole.signals.empty())
      throw std::runtime_error(fmt::format("{} and {} have no signal in common ({}); columns are matched by name, such as "
                                           "\"load.position.z [m]\"", first, second, name));
    const TrajectoryComparison trajectory = only(whole, signals);
    const bool both_have_events = a.events.count(engine_a) > 0 && b.events.count(engine_b) > 0;
    const EventComparison events =
        both_have_events ? compare_events(events_of(a, engine_a), events_of(b, engine_b)) : EventComparison{};
    // A file is a measurement, held against a run.
    const bool alike = engine_a == engine_b && !engine_a.empty();
    const auto rows = validation_rows(alike ? Likeness::same_law : Likeness::native, trajectory, events);
    table_text += csv_text(second, first, name, rows);
    if (json) {
      all[name] = to_json(trajectory);
      if (both_have_events) all[name]["events"] = to_json(events);
      continue;
    }
    fmt::print("{}\n", style.strong(fmt::format("{}: {} and {} apart, from {} to {} s at {} times", name, first, second,
                                                format_number(trajectory.from), format_number(trajectory.to),
                                                trajectory.samples)));
    fmt::print("{}", differences_text(trajectory.signals, style));
    if (both_have_events) fmt::print("\n{}", event_differences_text(events, first, second, style));
    fmt::print("\n{}\n\n", validation_text(rows));
  }
  if (!table.empty()) {
    std::ofstream stream(table);
    if (!(stream << table_text).flush()) throw std::runtime_error("cannot write '" + table + "'");
  }
  if (json) fmt::print("{}\n", all.dump(2));
}

}  // namespace

void add_compare_command(CLI::App& app) {
  auto compare = std::make_shared<CompareCommand>();
  CLI::App* command = app.add_subcommand("compare", "How far two runs, or a run and measured data, are apart");
  command->add_option("first", compare->first, "Directory of a run, or a CSV file")->required()->type_name("RUN");
  command->add_option("second", compare->second, "Directory of a run, or a CSV file with a first column time [s] and any of the "
                                                 "run's signals")
      ->required()
      ->type_name("RUN|CSV");
  command->add_option("--engine", compare->engines, "Only these engines, separated by commas")->delimiter(',')->type_name("NAME,...");
  command->add_option("--signal", compare->signals, "Only these signals, separated by commas")->delimiter(',')->type_name("NAME,...");
  command->add_option("--table", compare->table, "Write all differences with their tolerances as CSV")->type_name("FILE");
  command->add_flag("--json", compare->json, "Print JSON");
  command->footer(
      "Signals are matched by name and compared at the times of the coarser one; vectors by the length of their difference,\n"
      "orientations by the angle between them [rad]. Events are matched by kind, subject and nearest time.\n\n"
      "Examples:\n"
      "  quayside compare runs/before runs/after\n"
      "  quayside compare runs/land_on_stack measured.csv --engine simbody\n"
      "  quayside compare runs/a/trajectory_simbody.csv runs/a/trajectory_mujoco.csv --signal load.position,load.tilt");
  command->callback([compare] { compare->execute(); });
}

}  // namespace quayside::harness
