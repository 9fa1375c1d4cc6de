#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "harness/commands/commands.h"
#include "harness/commands/interrupt.h"
#include "harness/fmi/exported_case.h"
#include "harness/fmi/interface_cost.h"
#include "harness/terminal.h"

namespace quayside::harness {

void add_interface_command(CLI::App& app) {
  struct Arguments {
    std::string file;
    std::vector<std::string> overrides;
    double step = 1e-3;
    int repetitions = 5;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("interface", "What the interface costs: a case as a unit and as an FMU against its engine");
  command->add_option("case", arguments->file, "Case file (YAML)")->required()->type_name("CASE");
  command->add_option("--step", arguments->step, "Communication step [s]")->capture_default_str();
  command->add_option("--repeat", arguments->repetitions, "Runs of each, interleaved; the median counts")
      ->check(CLI::Range(1, 100))->capture_default_str();
  command->add_option("--set", arguments->overrides, "Changes one value of the case; may be repeated")
      ->allow_extra_args(false)->type_name("KEY.PATH=VALUE");
  command->footer("Example:\n  quayside interface cases/land_on_stack.yaml --repeat 11");
  command->callback([arguments] {
    namespace fs = std::filesystem;
    const fs::path library = fs::canonical("/proc/self/exe").parent_path() / (std::string(kModelIdentifier) + ".so");
    const Interrupt interrupt;
    InterfaceCosts costs;
    {
      ProgressBar bar("interface");
      costs = measure_interface(arguments->file, arguments->overrides, library, arguments->step, arguments->repetitions, [&](double done) {
        bar.update(done);
        return Interrupt::signal() == 0;
      });
    }
    if (Interrupt::signal() != 0) end_interrupted("nothing is kept");
    using Align = Table::Align;
    Table runs({Align::left, Align::right, Align::right});
    runs.add({"", "wall [s]", "over the engine in the same steps"});
    const double engine = costs.runs[1].median_wall_s();
    for (const InterfaceRun& run : costs.runs) {
      const double wall = run.median_wall_s();
      runs.add({run.what, format_number(wall, 3), fmt::format("{:+.1f} %", 100 * (wall / engine - 1))});
    }
    Table states({Align::left, Align::right, Align::right, Align::right});
    states.add({"state of", "bytes", "save [us]", "restore [us]"});
    for (const StateCost& state : costs.states) {
      states.add({state.unit, std::to_string(state.bytes), format_number(1e6 * state.save_s, 3), format_number(1e6 * state.restore_s, 3)});
    }
    fmt::print("{} in communication steps of {} s, medians of {} interleaved runs\n{}\n{}", arguments->file, arguments->step,
               arguments->repetitions, runs.text(), states.text());
  });
}

}  // namespace quayside::harness
