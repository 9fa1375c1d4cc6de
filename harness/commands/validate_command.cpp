#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <new>
#include <numeric>
#include <set>
#include <thread>

#include <fmt/format.h>

#include "harness/commands/case_options.h"
#include "harness/commands/commands.h"
#include "harness/commands/interrupt.h"
#include "harness/output_directory.h"
#include "harness/report/run_report.h"
#include "harness/report/validation_report.h"
#include "harness/run_text.h"
#include "harness/terminal.h"
#include "harness/validation.h"

namespace quayside::harness {

namespace {

namespace fs = std::filesystem;

constexpr auto kPollInterval = std::chrono::milliseconds(20);  // of the processes at work; short against any case

struct ValidateCommand {
  std::vector<std::string> paths{"cases"};
  std::string out, table, command_line;
  CaseOptions options;
  unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
  bool json = false;

  void execute() const;
  std::vector<fs::path> cases() const;
  int run_one(const fs::path& file, std::atomic<float>& progress, std::FILE* report, std::FILE* rows) const;
};

std::vector<fs::path> ValidateCommand::cases() const {
  const std::vector<fs::path> files = case_files(paths);
  if (!out.empty()) {
    std::set<std::string> names;
    for (const fs::path& file : files)
      if (!names.insert(file.stem().string()).second)
        throw cases::CaseError(fmt::format("{}: another case is called {} too, and would use the same directory in {}; validate "
                                           "them one after the other", file.string(), file.stem().string(), out));
  }
  return files;
}

// Runs one case and tells about it in `report`, and in `rows` how far the engines are apart. Returns the exit code that this case alone would have.
int ValidateCommand::run_one(const fs::path& file, std::atomic<float>& progress, std::FILE* report,
                             std::FILE* rows) const {
  const Style style = style_for(STDOUT_FILENO);
  const std::string name = file.stem().string();
  const auto tell = [&](const std::string& mark, const std::string& text) { fmt::print(report, "{} {}: {}\n", mark, name, text); };
  const auto refuse = [&](const std::string& text) {
    if (json)
      fmt::print(report, "{}", nlohmann::ordered_json{{"file", file.string()}, {"refused", text}}.dump());
    else
      tell(style.bad("✗"), "refused: " + text);
    return input_refused;
  };

  EvaluatedRun evaluated;
  const auto begin = std::chrono::steady_clock::now();
  try {
    const cases::Case description = options.load(file);
    if (!out.empty()) prepare_output_directory(fs::path(out) / name);
    RunOptions run_options = options.run_options();
    run_options.progress = [&](double time, const std::string&) {
      progress = static_cast<float>(time / description.duration);
      return Interrupt::signal() == 0;
    };
    evaluated = evaluate(run_case(description, run_options));
  } catch (const cases::CaseError& error) {
    return refuse(error.what());
  } catch (const std::invalid_argument& error) {
    return refuse(error.what());
  } catch (const std::runtime_error& error) {
    return refuse(error.what());
  }
  if (!out.empty()) {
    write_output(fs::path(out) / name, evaluated, command_line);
    report::write_run_report(fs::path(out) / name, evaluated.run, summary(evaluated, command_line));
  }

  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const auto count = [&](Verdict verdict) {
    return std::count_if(evaluated.expectations.begin(), evaluated.expectations.end(),
                         [&](const ExpectationResult& result) { return result.verdict == verdict; });
  };
  std::vector<std::pair<std::string, std::vector<ValidationRow>>> validations;
  for (const EngineComparison& c : evaluated.comparisons) {
    const Likeness likeness = c.engine == "mujoco" || c.reference == "mujoco" ? Likeness::native : Likeness::same_law;
    validations.emplace_back(c.engine, validation_rows(likeness, c.trajectory, c.events));
    fmt::print(rows, "{}", csv_text(name, c.reference, c.engine, validations.back().second));
  }
  const bool good = evaluated.completed() && evaluated.expectations_hold() && !evaluated.run.interrupted;
  if (json) {
    fmt::print(report, "{}", summary(evaluated, command_line).dump());
  } else {
    std::string line = fmt::format("{} of {} expectations hold", count(Verdict::passed), evaluated.expectations.size());
    if (count(Verdict::not_checked) > 0) line += fmt::format(", {} not checked", count(Verdict::not_checked));
    if (evaluated.run.interrupted) line += ", interrupted";
    tell(good ? style.good("✓") : style.bad("✗"), fmt::format("{} ({})", line, format_duration(took)));
    for (const auto& [engine, all] : validations) fmt::print(report, "    {}: {}\n", engine, validation_text(all));
    for (const EngineRun& engine : evaluated.run.engines)
      if (engine.failure) fmt::print(report, "    {}\n", failure_text(engine));
    std::vector<ExpectationResult> failing;
    for (const ExpectationResult& result : evaluated.expectations)
      if (result.verdict == Verdict::failed) failing.push_back(result);
    fmt::print(report, "{}", expectations_text(failing, style));
  }
  if (evaluated.run.interrupted) return stopped_by_signal + Interrupt::signal();
  if (!evaluated.completed()) return not_completed;
  return evaluated.expectations_hold() ? 0 : expectation_failed;
}

// One case in a process of its own: MuJoCo's callbacks are global to a process, and a crash takes one case with it.
struct Job {
  fs::path file;
  pid_t process = 0;
  std::FILE* report = nullptr;  // unnamed files that both processes see
  std::FILE* rows = nullptr;
  std::string text;             // its contents, when the process has ended
  std::string table;
  int exit_code = -1;           // -1: not ended
};

std::string contents(std::FILE* file) {
  std::string text;
  char block[4096];
  std::rewind(file);
  for (std::size_t n; (n = std::fread(block, 1, sizeof block, file)) > 0;) text.append(block, n);
  return text;
}

// Progress that the processes at work leave for the one that draws the bar.
class SharedProgress {
 public:
  explicit SharedProgress(std::size_t count) : bytes_(count * sizeof(std::atomic<float>)), count_(count) {
    static_assert(std::atomic<float>::is_always_lock_free, "a lock would live in one process only");
    void* memory = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    fractions_ = static_cast<std::atomic<float>*>(memory);
    for (std::size_t i = 0; i < count; ++i) new (fractions_ + i) std::atomic<float>(0);
  }
  ~SharedProgress() { munmap(fractions_, bytes_); }
  SharedProgress(const SharedProgress&) = delete;
  SharedProgress& operator=(const SharedProgress&) = delete;

  std::atomic<float>& operator[](std::size_t i) { return fractions_[i]; }
  double mean() const { return std::accumulate(fractions_, fractions_ + count_, 0.0) / static_cast<double>(count_); }

 private:
  std::size_t bytes_, count_;
  std::atomic<float>* fractions_;
};

void ValidateCommand::execute() const {
  std::vector<Job> all;
  for (const fs::path& file : cases()) {
    all.emplace_back();
    all.back().file = file;
  }
  SharedProgress progress(all.size());
  const Interrupt interrupt;
  const Style style = style_for(STDOUT_FILENO);

  ProgressBar bar(fmt::format("{} cases", all.size()));
  std::size_t started = 0, printed = 0, running = 0;
  bool told_to_stop = false;
  while (printed < all.size() && (running > 0 || Interrupt::signal() == 0)) {
    if (Interrupt::signal() != 0 && !told_to_stop) {
      // SIGTERM, whatever came: Ctrl-C reaches all processes of a terminal, and a second SIGINT would be sudden.
      for (const Job& job : all)
        if (job.process > 0 && job.exit_code == -1) kill(job.process, SIGTERM);
      told_to_stop = true;
    }
    while (running < jobs && started < all.size() && Interrupt::signal() == 0) {
      Job& job = all[started];
      job.report = std::tmpfile();
      job.rows = std::tmpfile();
      if (job.report == nullptr || job.rows == nullptr) throw std::runtime_error(fmt::format("no temporary file: {}", std::strerror(errno)));
      std::fflush(nullptr);  // or the child writes it a second time
      job.process = fork();
      if (job.process < 0) throw std::runtime_error(fmt::format("no new process: {}", std::strerror(errno)));
      if (job.process == 0) {
        int code = not_completed;
        try {
          code = run_one(job.file, progress[started], job.report, job.rows);
        } catch (const std::exception& error) {
          fmt::print(job.report, "{} {}: {}\n", style.bad("✗"), job.file.stem().string(), error.what());
        }
        std::fflush(job.report);
        std::fflush(job.rows);
        _exit(code);
      }
      ++started;
      ++running;
    }
    for (std::size_t i = 0; i < started; ++i) {
      Job& job = all[i];
      int status = 0;
      if (job.exit_code != -1 || waitpid(job.process, &status, WNOHANG) != job.process) continue;
      --running;
      progress[i] = 1;
      job.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : not_completed;
      job.text = contents(job.report);
      std::fclose(job.report);
      job.table = contents(job.rows);
      std::fclose(job.rows);
      if (WIFSIGNALED(status))
        job.text += fmt::format("{} {}: its process ended by signal {} ({})\n", style.bad("✗"), job.file.stem().string(),
                                WTERMSIG(status), strsignal(WTERMSIG(status)));
    }
    // Reports come in the order of the cases, whichever ends first.
    while (!json && printed < started && all[printed].exit_code != -1) {
      bar.clear();
      fmt::print("{}", all[printed++].text);
      std::fflush(stdout);
      bar.relabel(fmt::format("{} of {} cases left", all.size() - printed, all.size()));
    }
    if (json && running == 0 && started == all.size()) printed = all.size();
    bar.update(progress.mean());
    std::this_thread::sleep_for(kPollInterval);
  }
  bar.clear();

  if (!table.empty()) {
    std::ofstream stream(table);
    stream << kValidationHeader;
    for (const Job& job : all) stream << job.table;
    if (!stream.flush()) throw std::runtime_error("cannot write '" + table + "'");
  }
  if (!out.empty()) {
    std::vector<report::ValidatedCase> validated;
    for (const Job& job : all) {
      const bool told = job.exit_code == input_refused || job.exit_code == -1;
      validated.push_back({job.file.stem().string(), job.exit_code, told ? job.text : ""});
    }
    fs::create_directories(out);
    report::write_validation_report(out, validated, command_line);
  }
  if (json) {
    std::string separator;
    fmt::print("[");
    for (const Job& job : all) {
      if (job.exit_code != -1) fmt::print("{}{}", std::exchange(separator, ",\n"), job.text);
    }
    fmt::print("]\n");
  }
  if (Interrupt::signal() != 0) end_interrupted(out.empty() ? "" : "what was simulated up to then is in " + out);
  for (const int code : {static_cast<int>(input_refused), static_cast<int>(not_completed), static_cast<int>(expectation_failed)}) {
    const auto count = std::count_if(all.begin(), all.end(), [&](const Job& job) { return job.exit_code == code; });
    if (count == 0) continue;
    const char* what = code == input_refused   ? "refused"
                       : code == not_completed ? "not completed"
                                               : "with an expectation that does not hold";
    fmt::print(stderr, "quayside: {} of {} cases {}\n", count, all.size(), what);
    throw CLI::RuntimeError(code);
  }
}

}  // namespace

void add_validate_command(CLI::App& app, const std::string& command_line) {
  auto validate = std::make_shared<ValidateCommand>();
  validate->command_line = command_line;
  CLI::App* command = app.add_subcommand("validate", "Run cases in all engines and check every expectation");
  command->add_option("paths", validate->paths, "Case files, and directories of them (default: cases)")->type_name("[CASE|DIR]...");
  validate->options.add_to(*command);
  command->add_option("--jobs", validate->jobs, "Cases at a time, each in a process of its own (default: one per core)")
      ->check(CLI::Range(1, 1024).description(""))
      ->type_name("N");
  command->add_option("--out", validate->out, "Keep the results of each case in DIR/<case>, and a report of all in DIR/report.html")->type_name("DIR");
  command->add_option("--table", validate->table, "Write how far the engines are apart in every signal and event, with tolerances and "
                                                  "their reasons, as CSV")
      ->type_name("FILE");
  command->add_flag("--json", validate->json, "Print the summaries of all cases as a JSON list");
  command->footer(
      "One line per case and per engine that is held against simbody, and a table of the expectations that do not hold.\n"
      "Tolerances of --table tell where engines differ more than their integrators or models explain; whether a case is good\n"
      "is for its expectations to say.\n\n"
      "Exit codes: 0 all hold, 1 an expectation failed, 2 a case was refused, 3 a simulation could not be completed,\n"
      "130 stopped by Ctrl-C.\n\n"
      "Examples:\n"
      "  quayside validate cases\n"
      "  quayside validate cases/free_sway.yaml --set solver.relative_tolerance=1e-8\n"
      "  quayside validate cases --jobs 1 --out runs\n"
      "  quayside validate cases --table tests/benchmarks/results/validation.csv");
  command->callback([validate] { validate->execute(); });
}

}  // namespace quayside::harness
