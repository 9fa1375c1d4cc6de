#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include <fmt/format.h>

#include "harness/commands/case_options.h"
#include "harness/commands/commands.h"
#include "harness/commands/interrupt.h"
#include "harness/compare.h"
#include "harness/run.h"
#include "harness/terminal.h"

namespace quayside::harness {
namespace {

namespace fs = std::filesystem;

// What the table replaces in a file lies between these lines.
constexpr const char* kBegin = "<!-- table: made by `quayside table` -->";
constexpr const char* kEnd = "<!-- end of table -->";

struct TableCommand {
  std::string directory = "cases", into;
  void execute() const;
};

const EngineRun* engine_of(const RunResult& run, const std::string& name) {
  for (const EngineRun& engine : run.engines) {
    if (engine.engine == name) return &engine;
  }
  return nullptr;
}

// The rms distance of the position that differs most, of all that both recordings have.
std::string distance(const EngineRun& a, const EngineRun& b) {
  if (a.failure || b.failure) return "not completed";
  double largest = 0;
  for (const SignalDifference& signal : compare_trajectories(a.trajectory, b.trajectory).signals) {
    const std::string suffix = ".position";
    const bool is_position = signal.signal.size() > suffix.size() &&
                             signal.signal.compare(signal.signal.size() - suffix.size(), suffix.size(), suffix) == 0;
    if (is_position) largest = std::max(largest, signal.rms);
  }
  return fmt::format("{:.1e}", largest);
}

std::string counts(int full, int reduced) {
  return full == reduced ? fmt::format("{}", full) : fmt::format("{} → {}", full, reduced);
}

std::string row(const fs::path& file) {
  const cases::Case description = cases::load_case(file);
  RunOptions options;
  options.progress = [](double, const std::string&) { return Interrupt::signal() == 0; };
  const RunResult reduced = run_case(description, options);
  options.full_scene = true;
  options.engines = {"simbody"};
  std::string full_time = "refused", error = "–";
  const EngineRun& simbody = *engine_of(reduced, "simbody");
  try {
    const RunResult full = run_case(description, options);
    full_time = fmt::format("{:.2f}", full.engines.front().wall_s);
    error = distance(simbody, full.engines.front());
  } catch (const cases::CaseError&) {  // a yard: too large to be simulated in full
  }
  const auto& r = reduced.reduction;
  return fmt::format("| [`{}`]({}) | {} | {} | {} | {} | {} | {:.2f} | {} | {} | {} | {} |\n", description.name,
                     file.filename().string(), description.title, counts(r.bodies_before, r.bodies_after),
                     counts(r.degrees_of_freedom_before, r.degrees_of_freedom_after),
                     counts(r.pairs_before, r.pairs_after), simbody.simulated_s, simbody.wall_s, full_time, error,
                     distance(simbody, *engine_of(reduced, "mujoco_same_law")),
                     distance(simbody, *engine_of(reduced, "mujoco")));
}

void TableCommand::execute() const {
  const std::vector<fs::path> files = case_files({directory});
  std::string table =
      "| case | what it shows | bodies | degrees of freedom | contact pairs | simulated [s] | took [s] | full [s] | "
      "full scene apart [m] | same law apart [m] | MuJoCo apart [m] |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  const Interrupt interrupt;
  ProgressBar bar(fmt::format("{} cases", files.size()));
  for (std::size_t i = 0; i < files.size(); ++i) {
    bar.update(static_cast<double>(i) / static_cast<double>(files.size()));
    table += row(files[i]);
    if (Interrupt::signal() == 0) continue;
    bar.clear();
    end_interrupted(into.empty() ? "nothing is kept" : into + " is as it was");
  }
  bar.clear();
  if (into.empty()) {
    fmt::print("{}", table);
    return;
  }
  std::ostringstream text;
  text << std::ifstream(into).rdbuf();
  std::string whole = text.str();
  const std::size_t begin = whole.find(kBegin), end = whole.find(kEnd);
  if (begin == std::string::npos || end == std::string::npos || end < begin) {
    throw std::invalid_argument(
        fmt::format("{}: no place for the table, expected the lines '{}' and '{}'", into, kBegin, kEnd));
  }
  whole.replace(begin, end - begin, std::string(kBegin) + "\n\n" + table + "\n");
  std::ofstream file(into);
  if (!(file << whole).flush()) throw std::runtime_error("cannot write '" + into + "'");
}

}  // namespace

void add_table_command(CLI::App& app) {
  auto table = std::make_shared<TableCommand>();
  CLI::App* command = app.add_subcommand("table", "A table of all cases: their size, time, and distances between engines");
  command->add_option("directory", table->directory, "Of case files (default: cases)")->type_name("DIR");
  command->add_option("--into", table->into, "Markdown file whose table is replaced")->type_name("FILE");
  command->footer(
      "Each case runs reduced in all engines, and in full in Simbody. Distances are the largest rms of a position.\n\n"
      "Example:\n"
      "  quayside table cases --into cases/README.md");
  command->callback([table] { table->execute(); });
}

}  // namespace quayside::harness
