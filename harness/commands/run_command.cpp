#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "harness/commands/case_options.h"
#include "harness/commands/commands.h"
#include "harness/commands/interrupt.h"
#include "harness/output_directory.h"
#include "harness/report/run_report.h"
#include "harness/run_text.h"
#include "harness/terminal.h"

namespace quayside::harness {

namespace {

namespace fs = std::filesystem;

struct RunCommand {
  std::string file, out, command_line;
  CaseOptions options;
  bool real_time = false, quiet = false, json = false, budget = false;

  void execute() const;
};

void RunCommand::execute() const {
  const cases::Case description = options.load(file);
  const fs::path directory = out.empty() ? fs::path("runs") / description.name : fs::path(out);
  const Interrupt interrupt;  // from here on there is something to lose
  prepare_output_directory(directory);

  RunOptions run_options = options.run_options();
  run_options.real_time = real_time;
  EvaluatedRun evaluated;
  {
    ProgressBar bar(description.name, !quiet);
    run_options.progress = [&](double time, const std::string&) {
      bar.update(time / description.duration);
      return Interrupt::signal() == 0;
    };
    evaluated = evaluate(run_case(description, run_options));
    if (budget && !evaluated.run.interrupted) {
      bar.relabel("error budget");
      evaluated.budget = error_budget(description, [&](double done) {
        bar.update(done);
        return Interrupt::signal() == 0;
      });
    }
  }

  std::vector<std::string> written;
  try {
    written = write_output(directory, evaluated, command_line);
    report::write_run_report(directory, evaluated.run, summary(evaluated, command_line));
    written.emplace_back(report::kReportFile);
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "quayside: the results could not be written: {}\n", error.what());
    throw CLI::RuntimeError(not_completed);
  }
  const std::string budget_lines = budget ? "\n" + budget_text(evaluated.budget) : "";
  if (json) {
    fmt::print("{}\n", summary(evaluated, command_line).dump(2));
  } else if (!quiet) {
    fmt::print("{}{}\n{}: {}\n", run_text(evaluated, style_for(STDOUT_FILENO)), budget_lines, directory.string(), fmt::join(written, ", "));
  }
  if (const auto& pacing = evaluated.run.pacing; pacing && !json && !quiet)
    fmt::print("real time: {} of {} frames late ({:.2g} %), by {:.3g} ms at most\n", pacing->late, pacing->frames,
               100.0 * static_cast<double>(pacing->late) / static_cast<double>(pacing->frames), 1e3 * pacing->latest_s);
  std::fflush(stdout);

  if (evaluated.run.interrupted) end_interrupted("what was simulated up to then is in " + directory.string());
  for (const EngineRun& engine : evaluated.run.engines)
    if (engine.failure)
      fmt::print(stderr, "quayside: {}: {}; what was simulated up to then is in {}\n", file, failure_text(engine),
                 directory.string());
  if (!evaluated.completed()) throw CLI::RuntimeError(not_completed);
  if (!evaluated.expectations_hold()) {
    std::size_t failed = 0;
    for (const ExpectationResult& result : evaluated.expectations) {
      if (result.verdict != Verdict::failed) continue;
      ++failed;
      if (quiet) fmt::print(stderr, "quayside: {}:{}: expected {}: {}\n", file, result.line, result.text, result.finding);
    }
    if (!quiet) fmt::print(stderr, "quayside: {} of {} expectations do not hold\n", failed, evaluated.expectations.size());
    throw CLI::RuntimeError(expectation_failed);
  }
}

}  // namespace

void add_run_command(CLI::App& app, const std::string& command_line) {
  auto run = std::make_shared<RunCommand>();
  run->command_line = command_line;
  CLI::App* command = app.add_subcommand("run", "Simulate a case in each engine, compare them, check its expectations");
  command->add_option("case", run->file, "Case file (YAML)")->required()->type_name("CASE");
  run->options.add_to(*command);
  command->add_flag("--budget", run->budget, "Tell where the error comes from: integration, contact model, scene reduction, engine; five "
                                             "runs more, some at a hundredth of the tolerance");
  command->add_flag("--real-time", run->real_time, "Do not run faster than the clock; tells how many output intervals came late");
  command->add_option("--out", run->out, "Where results go (default: runs/<case>)")->type_name("DIR");
  command->add_flag("--quiet", run->quiet, "Print nothing but errors");
  command->add_flag("--json", run->json, "Print summary.json in place of the tables");
  command->footer(
      "Writes to DIR: trajectory_<engine>.csv, events.csv (contacts with impulse and peak force, ropes, locks), summary.json,\n"
      "report.html (a player of the run with plots, events and expectations; opens in any browser, offline).\n"
      "Ctrl-C ends the run in good order: what was simulated up to then is written.\n\n"
      "Exit codes: 0 done, 1 an expectation failed, 2 the input was refused, 3 the simulation could not be completed,\n"
      "130 stopped by Ctrl-C.\n\n"
      "Examples:\n"
      "  quayside run cases/land_on_stack.yaml\n"
      "  quayside run cases/land_on_stack.yaml --engine simbody --set solver.relative_tolerance=1e-8\n"
      "  quayside run cases/land_on_stack.yaml --contact exact --law points --out runs/points\n"
      "  quayside run cases/free_sway.yaml --scene full --json | jq .engines.simbody");
  command->callback([run] { run->execute(); });
}

}  // namespace quayside::harness
