#include "harness/sweep.h"

#include <algorithm>
#include <stdexcept>

#include "harness/compare.h"

namespace quayside::harness {
namespace {

EngineRun run_once(cases::Case description, const Contender& contender, bool full_scene) {
  (contender.engine == "simbody" ? description.solver.relative_tolerance : description.solver.mujoco_step) = contender.setting;
  RunOptions options;
  options.engines = {contender.engine};
  options.full_scene = full_scene;
  return std::move(run_case(description, options).engines.front());
}

void measure_error(const EngineRun& reference, const EngineRun& run, SweepPoint& point) {
  constexpr std::string_view kSuffix = ".position";
  for (const SignalDifference& signal : compare_trajectories(reference.trajectory, run.trajectory).signals) {
    const std::string& name = signal.signal;
    if (name.size() < kSuffix.size() || name.compare(name.size() - kSuffix.size(), kSuffix.size(), kSuffix) != 0) continue;
    point.rms = std::max(point.rms, signal.rms);
    point.max = std::max(point.max, signal.max);
  }
}

SweepPoint point_of(const Contender& contender, const EngineRun& reference, const EngineRun& run) {
  SweepPoint point{contender, {run.wall_s}, 0, 0, run.statistics.steps, run.statistics.rhs_evaluations, run.failure};
  if (!run.failure) measure_error(reference, run, point);
  return point;
}

}  // namespace

double SweepPoint::median_wall_s() const {
  if (wall_s.empty()) return 0;
  std::vector<double> sorted = wall_s;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  return sorted[sorted.size() / 2];
}

Sweep sweep(const cases::Case& description, const SweepOptions& options) {
  Sweep result;
  result.simulated_s = description.duration;
  const std::size_t all = 2 + options.contenders.size() * options.repetitions;
  std::size_t done = 0;
  const auto go_on = [&](const Contender& next) {
    result.interrupted |= options.progress && !options.progress(done++, all, next);
    return !result.interrupted;
  };

  if (!go_on(options.reference)) return result;
  const EngineRun reference = run_once(description, options.reference, options.full_scene);
  if (reference.failure) throw std::runtime_error("the reference run failed: " + *reference.failure);
  if (!go_on(options.second_reference)) return result;
  result.second_reference = point_of(options.second_reference, reference,
                                     run_once(description, options.second_reference, options.full_scene));

  for (int repetition = 0; repetition < options.repetitions; ++repetition) {
    for (std::size_t i = 0; i < options.contenders.size(); ++i) {
      const Contender& contender = options.contenders[i];
      if (repetition > 0 && result.points[i].failure) continue;
      if (!go_on(contender)) return result;
      const EngineRun run = run_once(description, contender, options.full_scene);
      if (repetition == 0) result.points.push_back(point_of(contender, reference, run));
      else result.points[i].wall_s.push_back(run.wall_s);
    }
  }
  return result;
}

bool on_front(const SweepPoint& point, const std::vector<SweepPoint>& all) {
  if (point.failure) return false;
  return std::none_of(all.begin(), all.end(), [&](const SweepPoint& other) {
    return !other.failure && other.rms < point.rms && other.median_wall_s() < point.median_wall_s();
  });
}

}  // namespace quayside::harness
