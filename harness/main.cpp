// The command line: quayside COMMAND ...
#include <cstdio>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cases/case.h"
#include "contact_nn/contact_command.h"
#include "contact_nn/paper/paper_command.h"
#include "harness/commands/commands.h"
#include "harness/versions.h"

namespace {

using namespace quayside;

// What the user typed, quoted where a shell would need it.
std::string command_line(int argc, char** argv) {
  std::string line = "quayside";
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const bool plain = !argument.empty() && argument.find_first_of(" \t\n'\"\\$&|;<>()*?[]{}`#~!") == std::string::npos;
    std::string quoted;
    for (const char c : argument) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += plain ? " " + argument : " '" + quoted + "'";
  }
  return line;
}

int complain(const std::string& message, int exit_code) {
  fmt::print(stderr, "quayside: {}\n", message);
  return exit_code;
}

// What is wrong with the command line, and which help tells more. CLI11 says of a misspelt command that one is required.
std::string complaint(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  std::string path = app.get_name();
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    path += " " + command->get_name();
  }
  std::string problem = error.what();
  std::vector<std::string> expected;
  for (const CLI::App* choice : command->get_subcommands([](const CLI::App*) { return true; })) expected.push_back(choice->get_name());
  if (!expected.empty()) {
    const auto words = command->remaining();
    problem = words.empty() ? "no command" : fmt::format("unknown command '{}'", words.front());
    problem += fmt::format(", expected one of: {}", fmt::join(expected, ", "));
  }
  return fmt::format("{} (see '{} --help')", problem, path);
}

std::string version_text() {
  std::string text;
  for (const auto& [name, version] : harness::versions()) text += fmt::format("{} {}\n", name, version);
  text.pop_back();
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Simulates the handling of containers by harbour cranes, side by side in Simbody and MuJoCo.", "quayside"};
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text(), "What this was built from");
  app.footer(
      "Examples:\n"
      "  quayside run cases/land_on_stack.yaml        the main job: simulate, compare, check\n"
      "  quayside signals cases/land_on_stack.yaml    what can be recorded, expected and compared\n"
      "  quayside validate cases                      all expectations of all cases\n"
      "  quayside compare runs/before runs/after      how far two runs are apart\n\n"
      "'quayside COMMAND --help' tells more.");

  const std::string command = command_line(argc, argv);
  try {
    harness::add_run_command(app, command);
    harness::add_validate_command(app, command);
    harness::add_signals_command(app);
    harness::add_compare_command(app);
    harness::add_plot_command(app);
    harness::add_report_command(app);
    harness::add_sweep_command(app, command);
    harness::add_frames_command(app);
    harness::add_impacts_command(app);
    harness::add_table_command(app);
    harness::add_export_command(app);
    harness::add_export_mjcf_command(app);
    harness::add_case_format_command(app);
    harness::add_completion_command(app);
    harness::add_coupling_command(app);
    harness::add_interface_command(app);
    contact_nn::add_contact_commands(app);
    contact_nn::add_paper_commands(*app.get_subcommand("contact"));
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::RuntimeError& error) {  // thrown by commands, which have said what there is to say
    return error.get_exit_code();
  } catch (const CLI::Success& request) {  // --help, --version
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    return complain(complaint(app, error), harness::input_refused);
  } catch (const cases::CaseError& error) {
    return complain(error.what(), harness::input_refused);
  } catch (const std::invalid_argument& error) {
    return complain(error.what(), harness::input_refused);
  } catch (const std::runtime_error& error) {
    return complain(error.what(), harness::input_refused);
  } catch (const std::exception& error) {
    return complain(fmt::format("this should not happen: {}; please report it with the command '{}'", error.what(), command),
                    harness::not_completed);
  }
}
