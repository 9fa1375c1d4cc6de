#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include <fmt/format.h>

#include "harness/commands/case_options.h"
#include "harness/commands/commands.h"
#include "harness/terminal.h"

namespace quayside::harness {
namespace {

namespace fs = std::filesystem;

struct FramesCommand {
  std::vector<std::string> paths{"cases"};
  std::string table;
  CaseOptions options;
  double rate = 60;             // frames per second
  double share = 1.0 / 20;      // of a frame that it may take
  std::size_t least = 10'000;   // frames to be counted

  FramesCommand() { options.engines = {"simbody"}; }
  void execute() const;
};

// The value that this part of the sample does not exceed (nearest rank).
double quantile(const std::vector<double>& sorted, double part) {
  const auto rank = static_cast<std::size_t>(std::ceil(part * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

struct Row {
  std::string name;
  std::vector<double> times_s;  // CPU time of each frame
  double slowest_s = 0, slowest_at_s = 0;
  std::uint64_t steps = 0;      // of the integrator in the slowest
};

void FramesCommand::execute() const {
  const std::vector<fs::path> files = case_files(paths);
  RunOptions run_options = options.run_options();
  run_options.cpu_times = true;
  std::vector<Row> rows;
  for (const fs::path& file : files) rows.push_back({file.stem().string(), {}});
  Row total{"all", {}};
  {
    ProgressBar bar("frames");
    for (std::size_t i = 0; total.times_s.size() < least || i % files.size() != 0; ++i) {  // whole rounds
      cases::Case description = options.load(files[i % files.size()]);
      description.output_interval = 1 / rate;
      const RunResult result = run_case(description, run_options);
      for (const EngineRun& run : result.engines) {
        if (run.failure) throw std::runtime_error(fmt::format("{}: {}", files[i % files.size()].string(), *run.failure));
        for (Row* row : {&rows[i % files.size()], &total}) {
          row->times_s.insert(row->times_s.end(), run.step_cpu_s.begin(), run.step_cpu_s.end());
          const auto slowest = std::max_element(run.step_cpu_s.begin(), run.step_cpu_s.end());
          if (*slowest <= row->slowest_s) continue;
          const auto frame = static_cast<std::size_t>(slowest - run.step_cpu_s.begin());
          row->slowest_s = *slowest;
          row->slowest_at_s = run.trajectory.times[frame];
          row->steps = run.steps_taken[frame + 1] - run.steps_taken[frame];
        }
      }
      bar.update(std::min(1.0, static_cast<double>(total.times_s.size()) / static_cast<double>(least)));
    }
  }

  const double limit_s = share / rate;
  rows.push_back(std::move(total));
  using Align = Table::Align;
  Table text({Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right});
  text.add({"CPU time of a frame [ms]", "frames", "median", "99 %", "99.9 %", "max", fmt::format("over {:.3g} ms", 1e3 * limit_s), "slowest at [s]", "in steps"});
  std::string csv = "case,frames,median [s],p99 [s],p99.9 [s],max [s],over " + fmt::format("{:.3g} s", limit_s) +
                    ",slowest at [s],its steps\n";
  for (Row& row : rows) {
    std::sort(row.times_s.begin(), row.times_s.end());
    const auto over = std::distance(std::upper_bound(row.times_s.begin(), row.times_s.end(), limit_s), row.times_s.end());
    const double part = static_cast<double>(over) / static_cast<double>(row.times_s.size());
    std::vector<std::string> cells{row.name, std::to_string(row.times_s.size())};
    csv += fmt::format("{},{}", row.name, row.times_s.size());
    for (const double q : {0.5, 0.99, 0.999, 1.0}) {
      cells.push_back(fmt::format("{:.3f}", 1e3 * quantile(row.times_s, q)));
      csv += fmt::format(",{:.3g}", quantile(row.times_s, q));
    }
    cells.push_back(fmt::format("{:.2f} %", 100 * part));
    csv += fmt::format(",{:.3g},{:.3f},{}\n", part, row.slowest_at_s, row.steps);
    cells.push_back(fmt::format("{:.2f}", row.slowest_at_s));
    cells.push_back(std::to_string(row.steps));
    text.add(std::move(cells));
  }
  fmt::print("{}", text.text());
  if (table.empty()) return;
  std::ofstream stream(table);
  if (!(stream << csv).flush()) throw std::runtime_error("cannot write '" + table + "'");
}

}  // namespace

void add_frames_command(CLI::App& app) {
  auto frames = std::make_shared<FramesCommand>();
  CLI::App* command = app.add_subcommand("frames", "Whether cases keep up with a clock: CPU time of each frame, its quantiles");
  command->add_option("cases", frames->paths, "Case files, or directories of them (default: cases)")->type_name("CASE|DIR");
  frames->options.add_to(*command);
  command->add_option("--rate", frames->rate, "Frames per second")->check(CLI::Range(1.0, 1e4))->capture_default_str();
  command->add_option("--share", frames->share, "Part of a frame that it may take")->check(CLI::Range(1e-6, 1.0))->capture_default_str();
  command->add_option("--least", frames->least, "Frames to count; all cases run again until there are as many")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000'000}))->capture_default_str();
  command->add_option("--table", frames->table, "Also as CSV")->type_name("FILE");
  command->footer(
      "Time that the stepping thread spent on the processor, drives included, output not. The engine is simbody unless others are\n"
      "named.\n\n"
      "Example:\n"
      "  quayside frames cases --table tests/benchmarks/results/frames.csv");
  command->callback([frames] { frames->execute(); });
}

}  // namespace quayside::harness
