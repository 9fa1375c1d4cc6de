#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "harness/commands/commands.h"
#include "harness/fmi/export_fmu.h"
#include "harness/fmi/exported_case.h"

namespace quayside::harness {

void add_export_command(CLI::App& app) {
  struct Arguments {
    std::string file, out;
    int version = 3;
    std::vector<std::string> overrides;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("export-fmu", "Write a case as an FMU, to run inside other simulators");
  command->add_option("case", arguments->file, "Case file (YAML)")->required()->type_name("CASE");
  command->add_option("-o,--out", arguments->out, "The FMU to write (default: <case>.fmu)")->type_name("FILE.fmu");
  command->add_option("--fmi", arguments->version, "Version of the standard: 3 (3.0, default) or 2 (2.0)")
      ->check(CLI::IsMember({2, 3}).description(""))
      ->type_name("2|3");
  command->add_option("--set", arguments->overrides, "Changes one value of the case; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY.PATH=VALUE");
  command->footer(
      "The FMU is for Co-Simulation on x86-64 Linux. It takes along every library it needs and runs on a Debian 12 "
      "machine with\n"
      "none of our packages installed. It runs the case's script, or obeys its inputs command.* when its parameter "
      "'script'\n"
      "is false. Its scene is the full one: nothing is left out, since an operator may move what the script does "
      "not.\n\n"
      "Examples:\n"
      "  quayside export-fmu cases/land_on_stack.yaml -o crane.fmu\n"
      "  quayside export-fmu cases/free_sway.yaml --fmi 2 --set containers.load.mass=20000");
  command->callback([arguments] {
    namespace fs = std::filesystem;
    const fs::path file = arguments->file;
    const fs::path out = arguments->out.empty() ? fs::path(file.stem().string() + ".fmu") : fs::path(arguments->out);
    const fs::path library = fs::canonical("/proc/self/exe").parent_path() / (std::string(kModelIdentifier) + ".so");
    export_fmu(file, arguments->overrides, arguments->version == 2 ? FmiVersion::fmi2 : FmiVersion::fmi3, library, out);
    fmt::print("{}: FMI {}.0, {:.1f} MB\n", out.string(), arguments->version,
               static_cast<double>(fs::file_size(out)) / 1e6);
  });
}

}  // namespace quayside::harness
