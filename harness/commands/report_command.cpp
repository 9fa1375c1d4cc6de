#include <memory>

#include <fmt/format.h>

#include "harness/commands/commands.h"
#include "harness/output_directory.h"
#include "harness/report/run_report.h"

namespace quayside::harness {

void add_report_command(CLI::App& app) {
  auto directory = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("report", "Make report.html again from the directory of a run");
  command->add_option("directory", *directory, "Where 'quayside run' or 'quayside validate --out' wrote")->required()->type_name("DIR");
  command->footer(
      "Nothing is simulated: trajectories, events and summary.json are read, and DIR/report.html is written over. It is the\n"
      "report that the run wrote, but for two plots whose data no file holds: wall time and mean step of every interval.\n\n"
      "Examples:\n"
      "  quayside report runs/land_on_stack");
  command->callback([directory] {
    const StoredResult stored = read_result(*directory);
    report::write_run_report(*directory, stored.run, stored.summary);
    fmt::print("{}\n", (std::filesystem::path(*directory) / report::kReportFile).string());
  });
}

}  // namespace quayside::harness
