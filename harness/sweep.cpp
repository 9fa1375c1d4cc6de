#include "harness/sweep.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include <fmt/format.h>

#include "harness/compare.h"

namespace quayside::harness {
namespace {

// References are worth waiting for, this many time limits long.
constexpr double kReferencePatience = 30;

cases::Case with(cases::Case description, const Contender& contender) {
  if (contender.engine == "simbody") {
    description.solver.integrator = contender.integrator;
    description.solver.relative_tolerance = contender.setting;
  } else {
    description.solver.mujoco_integrator = contender.integrator;
    description.solver.mujoco_step = contender.setting;
  }
  if (contender.contact == "learned") description.contact.law = "learned";
  else if (!contender.contact.empty()) description.contact.model = contender.contact;
  return description;
}

EngineRun run_once(const cases::Case& description, const Contender& contender, const SweepOptions& sweep,
                   double patience) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  RunOptions options;
  options.engines = {contender.engine};
  options.full_scene = sweep.full_scene;
  options.progress = [&](double, const std::string&) {
    return std::chrono::duration<double>(Clock::now() - begin).count() <= patience;
  };
  RunResult result = run_case(with(description, contender), options);
  EngineRun& run = result.engines.front();
  if (result.interrupted) run.failure = fmt::format("not done after {:g} s: {:.3g} s simulated", patience, run.simulated_s);
  return std::move(run);
}

SweepPoint point_of(const Contender& contender, const EngineRun& reference, const EngineRun& run) {
  SweepPoint point{contender, {run.wall_s}, 0, 0, run.statistics.steps, run.statistics.rhs_evaluations, run.failure};
  if (!run.failure) {
    const PositionDistance error = position_distance(compare_trajectories(reference.trajectory, run.trajectory));
    point.rms = error.rms;
    point.max = error.max;
  }
  return point;
}

}  // namespace

std::string Contender::label() const {
  std::string label = engine + " " + integrator;
  if (!contact.empty()) label += ", " + contact;
  return label;
}

std::vector<Contender> contenders(const std::vector<std::string>& engines, const std::vector<std::string>& integrators,
                                  const std::vector<std::string>& contacts, std::vector<double> tolerances,
                                  std::vector<double> steps) {
  std::sort(tolerances.rbegin(), tolerances.rend());
  std::sort(steps.rbegin(), steps.rend());
  std::vector<Contender> all;
  for (const std::string& engine : engines) {
    const bool simbody = engine == "simbody", native = engine == "mujoco";
    for (const std::string& integrator : integrators) {
      const bool of_mujoco = integrator == "rk4" || integrator == "implicit" || integrator == "euler";
      if (of_mujoco == simbody || (integrator == "implicit" && !native)) continue;
      for (const std::string& contact : native ? std::vector<std::string>{""} : contacts) {
        for (const double setting : simbody ? tolerances : steps) all.push_back({engine, integrator, contact, setting});
      }
    }
  }
  return all;
}

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

  const double patience = kReferencePatience * options.time_limit;
  if (!go_on(options.reference)) return result;
  const EngineRun reference = run_once(description, options.reference, options, patience);
  if (reference.failure) throw std::runtime_error("the reference run failed: " + *reference.failure);
  if (!go_on(options.second_reference)) return result;
  result.second_reference = point_of(options.second_reference, reference,
                                     run_once(description, options.second_reference, options, patience));

  for (int repetition = 0; repetition < options.repetitions; ++repetition) {
    for (std::size_t i = 0; i < options.contenders.size(); ++i) {
      const Contender& contender = options.contenders[i];
      if (!go_on(contender)) return result;
      if (repetition > 0) {
        if (result.points[i].failure) continue;
        result.points[i].wall_s.push_back(run_once(description, contender, options, options.time_limit).wall_s);
        continue;
      }
      const SweepPoint* coarser = i > 0 && options.contenders[i - 1].label() == contender.label() ? &result.points.back() : nullptr;
      if (coarser != nullptr && coarser->failure && coarser->median_wall_s() > 0.5 * options.time_limit) {
        result.points.push_back(*coarser);
        result.points.back().contender = contender;
        result.points.back().failure = "not run: a coarser setting took too long";
        continue;
      }
      result.points.push_back(
          point_of(contender, reference, run_once(description, contender, options, options.time_limit)));
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
