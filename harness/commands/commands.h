// The commands of the program, each registering itself with its options, help and examples.
//
// A command does its work in its callback. It ends normally (exit code 0), by throwing CLI::RuntimeError with one of the
// exit codes below after it has said on stderr what there is to say, or by any other exception: `main` turns these into
// one line on stderr, and into `input_refused` where the user can do something about it.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace quayside::harness {

enum ExitCode {
  expectation_failed = 1,
  input_refused = 2,
  not_completed = 3,       // with everything recorded up to then on disk
  stopped_by_signal = 128  // plus the number of the signal: Ctrl-C gives 130
};

// `command_line`: as the user gave it, for the summary.
void add_run_command(CLI::App& app, const std::string& command_line);
void add_validate_command(CLI::App& app, const std::string& command_line);
void add_signals_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_plot_command(CLI::App& app);
void add_report_command(CLI::App& app);
void add_sweep_command(CLI::App& app, const std::string& command_line);
void add_frames_command(CLI::App& app);
void add_impacts_command(CLI::App& app);
void add_table_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_export_mjcf_command(CLI::App& app);
void add_case_format_command(CLI::App& app);
void add_completion_command(CLI::App& app);
void add_coupling_command(CLI::App& app);
void add_interface_command(CLI::App& app);

}  // namespace quayside::harness
