#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "harness/build_scene.h"
#include "harness/commands/commands.h"
#include "harness/mujoco/export_mjcf.h"

namespace quayside::harness {

void add_export_mjcf_command(CLI::App& app) {
  struct Arguments {
    std::string file, out;
    std::vector<std::string> overrides;
    double step = 2e-4;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("export-mjcf", "Write the scene of a case as MJCF, to open in MuJoCo's viewer");
  command->add_option("case", arguments->file, "Case file (YAML)")->required()->type_name("CASE");
  command->add_option("-o,--out", arguments->out, "The model to write (default: <case>.xml)")->type_name("FILE.xml");
  command->add_option("--step", arguments->step, "MuJoCo's time step [s]; contacts of stacked containers need 0.5 ms or less")
      ->check(CLI::Range(1e-6, 0.1).description(""))
      ->capture_default_str();
  command->add_option("--set", arguments->overrides, "Changes one value of the case; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY.PATH=VALUE");
  command->footer(
      "The full scene at its start, with MuJoCo's own tendons, locks and contacts as the engine 'mujoco' has them. The script\n"
      "stays behind: the trolley stands and the ropes keep their length. In the viewer, load the keyframe 'start' first.\n\n"
      "Examples:\n"
      "  quayside export-mjcf cases/land_on_stack.yaml -o stack.xml\n"
      "  simulate stack.xml                           # MuJoCo's viewer");
  command->callback([arguments] {
    const cases::Case description = cases::load_case(arguments->file, arguments->overrides);
    const std::filesystem::path out = arguments->out.empty() ? description.name + ".xml" : arguments->out;
    const std::string model = mujoco::export_mjcf(build_scene(description), contact_settings(description.contact), arguments->step);
    std::ofstream stream(out, std::ios::binary);
    if (!(stream << model).flush()) throw std::runtime_error(fmt::format("{}: cannot be written", out.string()));
    fmt::print("{}\n", out.string());
  });
}

}  // namespace quayside::harness
