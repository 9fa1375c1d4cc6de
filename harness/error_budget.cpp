#include "harness/error_budget.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "harness/run.h"

namespace quayside::harness {
namespace {

constexpr double kTighter = 1e-2;            // share of the tolerance for runs whose integration error is not to count
constexpr double kTightestTolerance = 1e-12; // below, rounding in double precision

BudgetLine compared(const std::string& share, const std::string& comparison, const EngineRun& better,
                    const EngineRun& run) {
  BudgetLine line{share, comparison, {}, 0, 0, 0, 0, {}};
  if (better.failure || run.failure) {
    line.failure = better.failure ? better.failure : run.failure;
    return line;
  }
  const EngineComparison all = compare_engines(better, run);
  line.position = position_distance(all.trajectory);
  for (const EventPair& pair : all.events.pairs) {
    if (pair.a.kind != EventKind::contact_broken) continue;
    line.impulse = std::max(line.impulse, std::abs(pair.impulse_difference()));
    line.largest_impulse = std::max(line.largest_impulse, pair.a.impulse);
    line.peak_force = std::max(line.peak_force, std::abs(pair.peak_force_difference()));
  }
  for (const auto* alone : {&all.events.only_a, &all.events.only_b}) {
    line.unmatched += std::count_if(alone->begin(), alone->end(),
                                    [](const Event& event) { return event.kind == EventKind::contact_broken; });
  }
  return line;
}

}  // namespace

std::vector<BudgetLine> error_budget(const cases::Case& description, const std::function<bool(double)>& progress) {
  constexpr int kRuns = 6;
  int done = 0;
  bool interrupted = false;
  const auto run = [&](const cases::Case& variant, const std::string& engine, bool full_scene) {
    RunOptions options;
    options.engines = {engine};
    options.full_scene = full_scene;
    options.progress = [&](double time, const std::string&) {
      return !progress || progress((done + time / variant.duration) / kRuns);
    };
    RunResult result = run_case(variant, options);
    ++done;
    interrupted |= result.interrupted;
    return std::move(result.engines.front());
  };

  cases::Case tight = description, exact;
  tight.solver.relative_tolerance = std::max(kTightestTolerance, kTighter * description.solver.relative_tolerance);
  exact = tight;
  exact.contact.model = "exact";

  std::vector<BudgetLine> budget;
  const EngineRun reference = run(tight, "simbody", false);
  const auto add = [&](const std::string& share, const std::string& comparison, const cases::Case& variant,
                       const std::string& engine, bool full_scene) {
    if (interrupted) return;
    const EngineRun other = run(variant, engine, full_scene);
    if (!interrupted) budget.push_back(compared(share, comparison, reference, other));
  };
  add("integration", fmt::format("relative tolerance {:g} against {:g}", description.solver.relative_tolerance,
                                 tight.solver.relative_tolerance), description, "simbody", false);
  add("contact model", fmt::format("{} against exact", description.contact.model), exact, "simbody", false);
  add("scene reduction", "reduced against full", tight, "simbody", true);
  add("same law", "MuJoCo under our laws", tight, "mujoco_same_law", false);
  add("native", "MuJoCo with its own tendons and contacts", tight, "mujoco", false);
  return budget;
}

std::string budget_text(const std::vector<BudgetLine>& budget) {
  std::string text = fmt::format("{:<16} {:>12} {:>12} {:>12} {:>14} {:>14}  {}\n", "error budget", "rms [mm]", "max [mm]",
                                 "end [mm]", "impulse [N s]", "of [N s]", "from");
  for (const BudgetLine& line : budget) {
    if (line.failure) {
      text += fmt::format("{:<16} {}: {}\n", line.share, line.comparison, *line.failure);
      continue;
    }
    text += fmt::format("{:<16} {:>12.3g} {:>12.3g} {:>12.3g} {:>14.3g} {:>14.4g}  {}", line.share, 1e3 * line.position.rms,
                        1e3 * line.position.max, 1e3 * line.position.end, line.impulse, line.largest_impulse, line.comparison);
    if (line.unmatched > 0) text += fmt::format("; {} impacts in one alone", line.unmatched);
    text += '\n';
  }
  return text;
}

}  // namespace quayside::harness
