#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>

#include <fmt/format.h>
#include <fmt/os.h>
#include <unistd.h>

#include "harness/commands/case_options.h"
#include "harness/commands/commands.h"
#include "harness/commands/interrupt.h"
#include "harness/plot.h"
#include "harness/report/sweep_report.h"
#include "harness/sweep.h"
#include "harness/sweep_table.h"
#include "harness/terminal.h"

namespace quayside::harness {
namespace {

namespace fs = std::filesystem;

struct SweepCommand {
  std::vector<std::string> paths;
  std::string out = "runs", table, command_line;
  CaseOptions options;
  std::vector<std::string> integrators{"bdf", "adams", "erk", "dirk", "merson", "cpodes", "rk4", "implicit", "euler"};
  std::vector<std::string> contacts{""};
  std::vector<double> tolerances{1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
  std::vector<double> steps{1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4};
  SweepOptions sweep;

  void execute();
  void sweep_case(const fs::path& file);
  void write_table() const;
};

std::string csv_text(const Sweep& sweep) {
  std::string text =
      "engine,integrator,contact,setting,wall [s],real_time_factor,error_rms [m],error_max [m],steps,rhs_evaluations,front,"
      "failure\n";
  const auto add = [&](const SweepPoint& p, const char* front) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},\"{}\"\n", p.contender.engine, p.contender.integrator,
                        p.contender.contact, p.contender.setting, p.median_wall_s(),
                        p.failure ? "" : fmt::to_string(sweep.simulated_s / p.median_wall_s()),
                        p.failure ? "" : fmt::to_string(p.rms), p.failure ? "" : fmt::to_string(p.max), p.steps,
                        p.rhs_evaluations, front, p.failure.value_or(""));
  };
  for (const SweepPoint& p : sweep.points) add(p, on_front(p, sweep.points) ? "yes" : "no");
  if (!sweep.second_reference.wall_s.empty()) add(sweep.second_reference, "reference");
  return text;
}

// A curve for each contender, failures counted in its label; points on the front are filled.
std::string chart(const Sweep& sweep, const std::string& title) {
  Panel panel{"wall time per simulated second [s]; filled: on the front", {}};
  for (std::size_t i = 0; i < sweep.points.size();) {
    const std::string label = sweep.points[i].contender.label();
    Curve curve{label, {}, {}, {}};
    int failed = 0;
    for (; i < sweep.points.size() && sweep.points[i].contender.label() == label; ++i) {
      const SweepPoint& p = sweep.points[i];
      failed += p.failure.has_value();
      if (p.failure) continue;
      curve.x.push_back(p.rms);
      curve.y.push_back(p.median_wall_s() / sweep.simulated_s);
      curve.emphasized.push_back(on_front(p, sweep.points));
    }
    if (failed > 0) curve.label += fmt::format(" ({} failed)", failed);
    panel.curves.push_back(std::move(curve));
  }
  if (panel.curves.empty()) panel.curves.push_back({"nothing was run", {}, {}, {}});
  return svg_plot(title, {"error: rms distance to the converged reference [m]", true, true, true}, {panel});
}

void print(const Sweep& sweep) {
  fmt::print("{:<32} {:>9} {:>10} {:>12} {:>12} {:>9} {:>12}\n", "engine", "setting", "wall [s]", "rms [m]", "max [m]",
             "steps", "evaluations");
  for (const SweepPoint& p : sweep.points) {
    fmt::print("{:<32} {:>9.3g} {:>10.3g} ", p.contender.label(), p.contender.setting, p.median_wall_s());
    if (p.failure) fmt::print("failed: {}\n", *p.failure);
    else
      fmt::print("{:>12.3g} {:>12.3g} {:>9} {:>12}{}\n", p.rms, p.max, p.steps, p.rhs_evaluations,
                 on_front(p, sweep.points) ? "  front" : "");
  }
  const SweepPoint& second = sweep.second_reference;
  if (second.failure) fmt::print("The second reference failed: {}\n", *second.failure);
  else if (!second.wall_s.empty())
    fmt::print("The two references, {} at {:g} and the first, are {:.3g} m apart (rms; at most {:.3g} m).\n",
               second.contender.label(), second.contender.setting, second.rms, second.max);
}

void SweepCommand::sweep_case(const fs::path& file) {
  const cases::Case description = options.load(file);
  Sweep result;
  {
    ProgressBar bar(description.name, true);
    sweep.progress = [&](std::size_t done, std::size_t all, const Contender&) {
      bar.update(static_cast<double>(done) / all);
      return Interrupt::signal() == 0;
    };
    result = harness::sweep(description, sweep);
  }
  const std::string stem = (fs::path(out) / (description.name + "_sweep")).string();
  for (const auto& [name, text] : {std::pair{stem + ".csv", csv_text(result)},
                                   std::pair{stem + ".svg", chart(result, "Speed against error: " + description.title)}}) {
    std::ofstream stream(name);
    if (!(stream << text).flush()) throw std::runtime_error("cannot write '" + name + "'");
  }
  print(result);
  report::write_sweep_report(stem + ".html", description, result, command_line);
  fmt::print("{0}.csv, {0}.svg, {0}.html\n", stem);
  std::fflush(stdout);
  if (result.interrupted) end_interrupted("what was measured up to then is in " + stem + ".csv");
}

// Of all sweeps in the folder, those of other days among them.
void SweepCommand::write_table() const {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(out)) {
    const std::string name = entry.path().filename().string(), end = "_sweep.csv";
    if (name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::ofstream stream(table);
  if (!(stream << "# Speed against error, all cases\n\nFrom the sweeps in this folder, by `quayside sweep --table`.\n\n" << sweep_table(files))
           .flush())
    throw std::runtime_error("cannot write '" + table + "'");
}

void SweepCommand::execute() {
  if (paths.empty() && table.empty()) throw CLI::RequiredError("CASE|DIR, or --table");
  fs::create_directories(out);
  sweep.full_scene = options.full_scene;
  sweep.contenders = contenders(options.engines, integrators, contacts, tolerances, steps);
  const Interrupt interrupt;
  std::size_t failed = 0;
  const std::vector<fs::path> files = case_files(paths);
  for (const fs::path& file : files) {
    try {
      sweep_case(file);
    } catch (const std::runtime_error& error) {
      if (files.size() == 1 || Interrupt::signal() != 0) throw;
      fmt::print(stderr, "quayside: {}: {}\n", file.string(), error.what());
      ++failed;
    }
  }
  if (!table.empty()) write_table();
  if (failed > 0) throw CLI::RuntimeError(not_completed);
}

}  // namespace

void add_sweep_command(CLI::App& app, const std::string& command_line) {
  auto sweep = std::make_shared<SweepCommand>();
  sweep->command_line = command_line;
  CLI::App* command = app.add_subcommand("sweep", "Speed against error over engines, integrators, contact models, tolerances and steps");
  command->add_option("paths", sweep->paths, "Case files, and directories of them")->type_name("CASE|DIR...");
  sweep->options.add_to(*command);
  command->add_option("--integrators", sweep->integrators, "Integrators: of Simbody bdf, adams (CVODES), erk, dirk (ARKODE), merson, "
                                                           "feldberg, rk3, cpodes (its own); of MuJoCo rk4, implicit, euler")
      ->delimiter(',')
      ->check(CLI::IsMember({"bdf", "adams", "erk", "dirk", "merson", "feldberg", "rk3", "cpodes", "rk4", "implicit", "euler"})
                  .description(""))
      ->type_name("NAME,...")
      ->capture_default_str();
  command->add_option("--contacts", sweep->contacts, "Contact models to vary: exact, committee, learned (default: the case's)")
      ->delimiter(',')
      ->check(CLI::IsMember({"exact", "committee", "learned"}).description(""))
      ->type_name("NAME,...");
  command->add_option("--time-limit", sweep->sweep.time_limit, "A contender that steps longer has failed [s]")
      ->check(CLI::PositiveNumber.description(""))->capture_default_str();
  command->add_option("--tolerances", sweep->tolerances, "Relative tolerances of Simbody")->delimiter(',')->capture_default_str();
  command->add_option("--steps", sweep->steps, "Steps of MuJoCo [s]")->delimiter(',')->capture_default_str();
  command->add_option("--repeat", sweep->sweep.repetitions, "Runs of each setting, interleaved; the median counts")
      ->check(CLI::Range(1, 100))->capture_default_str();
  command->add_option("--reference", sweep->sweep.reference.setting, "Relative tolerance of the reference (Simbody)")
      ->capture_default_str();
  command->add_option("--second-reference", sweep->sweep.second_reference.setting, "Step of the second reference (MuJoCo, same law) [s]")
      ->capture_default_str();
  command->add_option("--out", sweep->out, "Where <case>_sweep.csv, .svg and .html go")->capture_default_str()->type_name("DIR");
  command->add_option("--table", sweep->table, "Where a table of all sweeps in that folder goes (Markdown)")->type_name("FILE");
  command->footer(
      "The error is the rms distance of positions to a converged reference; the distance of a second, independent reference\n"
      "tells how far it can be trusted. Wall times are medians, of stepping alone.\n\n"
      "Examples:\n"
      "  quayside sweep cases/land_on_stack.yaml --engine simbody,mujoco_same_law --repeat 5\n"
      "  quayside sweep cases/land_on_stack.yaml --engine simbody --integrators bdf --contacts exact,committee,learned\n"
      "  quayside sweep cases --out tests/benchmarks/results --table tests/benchmarks/results/sweeps.md\n"
      "  quayside sweep --out tests/benchmarks/results --table sweeps.md    # the table alone");
  command->callback([sweep] { sweep->execute(); });
}

}  // namespace quayside::harness
