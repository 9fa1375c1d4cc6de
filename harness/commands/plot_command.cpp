#include <fstream>
#include <memory>

#include "harness/commands/commands.h"
#include "harness/output_directory.h"
#include "harness/plot.h"

namespace quayside::harness {
namespace {

struct PlotOptions {
  std::string run, title;
  std::vector<std::string> signals{"load.position.z"};
  std::string out;
};

Curve curve_of(const std::string& label, const Recording& recording, std::size_t signal) {
  return {label.empty() ? "measured" : label, recording.times, recording.columns[signal]};
}

void plot(const PlotOptions& options) {
  const StoredRun run = read_run(options.run);
  std::vector<Panel> panels;
  for (const std::string& name : options.signals) {
    Panel panel;
    for (const auto& [engine, recording] : run.trajectories) {
      const std::size_t signal = recording.index(name);
      panel.title = name + " [" + recording.units[signal] + "]";
      panel.curves.push_back(curve_of(engine, recording, signal));
    }
    panels.push_back(std::move(panel));
  }
  const std::string svg = svg_plot(options.title.empty() ? options.run : options.title, {"time [s]"}, panels);
  std::ofstream file(options.out);
  if (!(file << svg).flush()) throw std::runtime_error("cannot write '" + options.out + "'");
}

}  // namespace

void add_plot_command(CLI::App& app) {
  auto options = std::make_shared<PlotOptions>();
  CLI::App* command = app.add_subcommand("plot", "Plots signals of a run, all its engines together, as SVG");
  command->footer(
      "Example:\n"
      "  quayside plot runs/land_on_stack --signal load.position.z --signal load.velocity.z -o landing.svg");
  command->add_option("RUN", options->run, "Directory of a run, or a CSV with a first column of time")->required();
  command->add_option("--signal", options->signals, "Signal to plot, a panel each (see 'quayside signals')")
      ->allow_extra_args(false)->capture_default_str();
  command->add_option("--title", options->title, "Title of the sheet (default: the run's path)");
  command->add_option("-o,--out", options->out, "SVG file to write")->required();
  command->callback([options] { plot(*options); });
}

}  // namespace quayside::harness
