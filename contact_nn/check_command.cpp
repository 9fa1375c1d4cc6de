#include "contact_nn/check_command.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "contact_nn/evaluation.h"
#include "contact_nn/status_line.h"

namespace quayside::contact_nn {
namespace {

void print(const Evaluation& evaluation) {
  fmt::print("{:<24}{:>10}{:>9}{:>9}{:>8}{:>8}{:>9}{:>8}{:>9}{:>9}{:>7}{:>11}{:>11}\n", "committee", "poses", "touch",
             "phantom", "missed", "deeper", "gap off", "normal", "> 8 pts", "surface", "force", "fallbacks", "gap error");
  for (const SizeVerdict& v : evaluation.sizes) {
    const double poses = static_cast<double>(std::max<std::uint64_t>(v.poses, 1));
    fmt::print("{:<24}{:>10}{:>7.1f} %{:>9}{:>8}{:>8}{:>9}{:>8}{:>9}{:>9}{:>7}{:>9.2f} %{:>11.1e}\n", v.name, v.poses,
               100.0 * static_cast<double>(v.touching) / poses, v.phantom, v.missed, v.deeper, v.gap_off, v.normal_off,
               v.too_many, v.off_surface, v.force_off, 100.0 * static_cast<double>(v.fallbacks) / poses,
               v.worst_gap);
  }
  fmt::print("(numbers of poses in which something was wrong; fallbacks of all forces; gap error: the largest, in units of "
             "the boxes' size;\n tolerance {:.0e} of it)\n\n", kEvaluationTolerance);
  fmt::print("{:<38}{:>10}{:>22}{:>12}{:>14}\n", "gate alone, first three axes", "poses", "depth off by > 1 mm",
             "allowed", "most, m");
  for (const GateVerdict& v : evaluation.gate)
    fmt::print("{:<38}{:>10}{:>20.4f} %{:>10.1f} %{:>14.2e}\n", v.name, v.poses, 100 * v.share(), 100 * v.allowed,
               v.worst);
}

void run_check(EvaluationOptions options) {
  const auto start = std::chrono::steady_clock::now();
  const Evaluation evaluation = [&options] {
    StatusLine status;
    options.progress = [&status](double done) { status.show(fmt::format("{:.0f} %", 100 * done)); };
    return evaluate_committee(options);
  }();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{} poses, seed {}, {:.0f} s\n\n", options.poses, options.seed, seconds);
  print(evaluation);
  if (evaluation.failures() > 0)
    throw std::runtime_error(fmt::format("the committee was wrong in {} ways", evaluation.failures()));
}

}  // namespace

void add_check_command(CLI::App& contact_app) {
  auto options = std::make_shared<EvaluationOptions>();
  CLI::App* command =
      contact_app.add_subcommand("check", "Judge the committee from outside: contacts that are none, missed or misplaced");
  command->add_option("--poses", options->poses, "Random poses, over six pairs of sizes")
      ->check(CLI::Range(std::uint64_t{6}, std::uint64_t{1} << 40))->capture_default_str();
  command->add_option("--seed", options->seed, "Of the poses")->capture_default_str();
  command->add_option("--threads", options->threads, "0: all cores. The figures do not depend on it")
      ->capture_default_str();
  command->add_option("--network", options->network, "Another gate for the axes (ONNX)");
  command->footer("Example, the long check (a minute or two on two cores):\n  quayside contact check --poses 10000000");
  command->callback([options] { run_check(*options); });
}

}  // namespace quayside::contact_nn
