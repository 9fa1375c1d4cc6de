// Speed against error: one case, many settings of engines, integrators and contact models, each against a converged
// reference.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cases/case.h"
#include "harness/run.h"

namespace quayside::harness {

// One engine with one of its integrators at one setting: a relative tolerance for Simbody, a step [s] for MuJoCo.
struct Contender {
  std::string engine;
  std::string integrator;  // as in solver.integrator or solver.mujoco_integrator
  std::string contact;     // "exact", "committee" or "learned"; empty: as in the case
  double setting = 0;

  std::string label() const;  // all but the setting
};

// All sensible combinations of what is named, each over its settings from coarse to fine. Integrators go to the engines
// that have them; the engine "mujoco" has contacts of its own, and under our laws MuJoCo's implicit method is its Euler.
std::vector<Contender> contenders(const std::vector<std::string>& engines, const std::vector<std::string>& integrators,
                                  const std::vector<std::string>& contacts, std::vector<double> tolerances,
                                  std::vector<double> steps);

struct SweepPoint {
  Contender contender;
  std::vector<double> wall_s;  // of each repetition; stepping only
  double rms = 0, max = 0;     // distance to the reference: of the positions of all reported frames the one farthest off [m]
  std::uint64_t steps = 0, rhs_evaluations = 0;
  std::optional<std::string> failure;  // no error is given then

  double median_wall_s() const;
};

struct SweepOptions {
  std::vector<Contender> contenders;
  int repetitions = 3;
  // With exact contact, so that a contact model's own error counts.
  Contender reference{"simbody", "bdf", "exact", 1e-10};
  Contender second_reference{"mujoco_same_law", "rk4", "exact", 1e-5};
  bool full_scene = false;
  // A contender that steps longer than this has failed, and its finer settings with it [s].
  double time_limit = 20;
  // Called before each run; returning false ends the sweep with what there is.
  std::function<bool(std::size_t done, std::size_t all, const Contender& next)> progress;
};

struct Sweep {
  std::vector<SweepPoint> points;     // in the order of the contenders
  SweepPoint second_reference;        // against the reference: how far the two independent references are apart
  double simulated_s = 0;
  bool interrupted = false;
};

// Repetitions are interleaved: every contender runs once before any runs twice. Throws what run_case throws, and
// std::runtime_error when the reference itself fails.
Sweep sweep(const cases::Case& description, const SweepOptions& options);

// On the front: no other point is both faster and nearer to the reference.
bool on_front(const SweepPoint& point, const std::vector<SweepPoint>& all);

}  // namespace quayside::harness
