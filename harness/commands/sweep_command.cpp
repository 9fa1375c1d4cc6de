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
#include "harness/sweep.h"
#include "harness/terminal.h"

namespace quayside::harness {
namespace {

namespace fs = std::filesystem;

struct SweepCommand {
  std::string file, out;
  CaseOptions options;
  std::vector<double> tolerances{1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
  std::vector<double> steps{1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4};
  SweepOptions sweep;

  void execute();
};

std::string csv_text(const Sweep& sweep) {
  std::string text = "engine,setting,wall [s],real_time_factor,error_rms [m],error_max [m],steps,rhs_evaluations,front,failure\n";
  for (const SweepPoint& p : sweep.points)
    text += fmt::format("{},{},{},{},{},{},{},{},{},\"{}\"\n", p.contender.engine, p.contender.setting, p.median_wall_s(),
                        sweep.simulated_s / p.median_wall_s(), p.failure ? "" : fmt::to_string(p.rms),
                        p.failure ? "" : fmt::to_string(p.max), p.steps, p.rhs_evaluations,
                        on_front(p, sweep.points) ? "yes" : "no", p.failure.value_or(""));
  return text;
}

std::string chart(const Sweep& sweep, const std::string& title) {
  Panel panel{"wall time per simulated second [s]", {}};
  for (const SweepPoint& p : sweep.points) {
    if (p.failure) continue;
    if (panel.curves.empty() || panel.curves.back().label != p.contender.engine)
      panel.curves.push_back({p.contender.engine, {}, {}});
    panel.curves.back().x.push_back(p.rms);
    panel.curves.back().y.push_back(p.median_wall_s() / sweep.simulated_s);
  }
  if (panel.curves.empty()) panel.curves.push_back({"no run succeeded", {}, {}});
  return svg_plot(title, {"error: rms distance to the converged reference [m]", true, true, true}, {panel});
}

void print(const Sweep& sweep) {
  fmt::print("{:<16} {:>9} {:>10} {:>12} {:>12} {:>9} {:>12}\n", "engine", "setting", "wall [s]", "rms [m]", "max [m]",
             "steps", "evaluations");
  for (const SweepPoint& p : sweep.points) {
    fmt::print("{:<16} {:>9.3g} {:>10.3g} ", p.contender.engine, p.contender.setting, p.median_wall_s());
    if (p.failure) fmt::print("failed: {}\n", *p.failure);
    else
      fmt::print("{:>12.3g} {:>12.3g} {:>9} {:>12}{}\n", p.rms, p.max, p.steps, p.rhs_evaluations,
                 on_front(p, sweep.points) ? "  front" : "");
  }
  const SweepPoint& second = sweep.second_reference;
  if (second.failure) fmt::print("The second reference failed: {}\n", *second.failure);
  else if (!second.wall_s.empty())
    fmt::print("The two references, {} at {:g} and the first, are {:.3g} m apart (rms; at most {:.3g} m).\n",
               second.contender.engine, second.contender.setting, second.rms, second.max);
}

void SweepCommand::execute() {
  const cases::Case description = options.load(file);
  const fs::path directory = out.empty() ? fs::path("runs") / (description.name + "_sweep") : fs::path(out);
  fs::create_directories(directory);
  sweep.full_scene = options.full_scene;
  for (const std::string& engine : options.engines)
    for (const double setting : engine == "simbody" ? tolerances : steps) sweep.contenders.push_back({engine, setting});

  const Interrupt interrupt;
  Sweep result;
  {
    ProgressBar bar(description.name, true);
    sweep.progress = [&](std::size_t done, std::size_t all, const Contender&) {
      bar.update(static_cast<double>(done) / all);
      return Interrupt::signal() == 0;
    };
    result = harness::sweep(description, sweep);
  }
  for (const auto& [name, text] : {std::pair{"sweep.csv", csv_text(result)},
                                   std::pair{"sweep.svg", chart(result, "Speed against error: " + description.title)}}) {
    std::ofstream stream(directory / name);
    if (!(stream << text).flush()) throw std::runtime_error("cannot write '" + (directory / name).string() + "'");
  }
  print(result);
  fmt::print("{}: sweep.csv, sweep.svg\n", directory.string());
  if (result.interrupted) throw CLI::RuntimeError(stopped_by_signal + Interrupt::signal());
}

}  // namespace

void add_sweep_command(CLI::App& app) {
  auto sweep = std::make_shared<SweepCommand>();
  CLI::App* command = app.add_subcommand("sweep", "Speed against error over engines and their tolerances or steps");
  command->add_option("case", sweep->file, "Case file (YAML)")->required()->type_name("CASE");
  sweep->options.add_to(*command);
  command->add_option("--tolerances", sweep->tolerances, "Relative tolerances of Simbody")->delimiter(',')->capture_default_str();
  command->add_option("--steps", sweep->steps, "Steps of MuJoCo [s]")->delimiter(',')->capture_default_str();
  command->add_option("--repeat", sweep->sweep.repetitions, "Runs of each setting, interleaved; the median counts")
      ->check(CLI::Range(1, 100))->capture_default_str();
  command->add_option("--reference", sweep->sweep.reference.setting, "Relative tolerance of the reference (Simbody)")
      ->capture_default_str();
  command->add_option("--second-reference", sweep->sweep.second_reference.setting, "Step of the second reference (MuJoCo, same law) [s]")
      ->capture_default_str();
  command->add_option("--out", sweep->out, "Where results go (default: runs/<case>_sweep)")->type_name("DIR");
  command->footer(
      "The error is the rms distance of positions to a converged reference; the distance of a second, independent reference\n"
      "tells how far it can be trusted. Wall times are those of stepping alone.\n\n"
      "Example:\n"
      "  quayside sweep cases/land_on_stack.yaml --engine simbody,mujoco_same_law --repeat 5");
  command->callback([sweep] { sweep->execute(); });
}

}  // namespace quayside::harness
