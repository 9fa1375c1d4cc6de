// Running a case: its scene in each engine, every engine with drives of its own, stepped by the master in lock-step.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cases/case.h"
#include "crane_models/reduction.h"
#include "harness/engine_unit.h"
#include "harness/recording.h"

namespace quayside::harness {

struct RunOptions {
  std::vector<std::string> engines{"simbody", "mujoco_same_law", "mujoco"};
  bool full_scene = false;
  bool real_time = false;
  bool cpu_times = false;  // a microsecond a step, which is a share of short ones
  // Called at communication points with simulated time and engine; returning false ends the run in good order.
  std::function<bool(double time, const std::string& engine)> progress;
};

// One engine's run. Where `failure` is set, everything up to then is here.
struct EngineRun {
  std::string engine;
  Recording trajectory;
  std::vector<Event> events;         // in the order of time
  std::vector<Event> open_contacts;  // contacts still made at the end
  EnergyLedger energy;
  EngineStatistics statistics;
  double wall_s = 0;                 // stepping only: no building, no writing
  double simulated_s = 0;
  std::vector<double> step_times_s;  // wall time of each macro step
  std::vector<double> step_cpu_s;    // with `cpu_times`: CPU time of this thread in each
  std::vector<std::uint64_t> steps_taken;  // by the integrator, up to each row of the trajectory
  std::optional<std::string> failure;
};

// How a run with `real_time` kept up: a frame is a communication point, late when all engines have reached it after the
// clock has.
struct Pacing {
  std::uint64_t frames = 0, late = 0;
  double latest_s = 0;  // the most that a frame was late
};

struct RunResult {
  cases::Case description;
  crane_models::Scene scene;         // as simulated
  crane_models::ReductionReport reduction;
  std::vector<EngineRun> engines;
  std::optional<Pacing> pacing;      // with `real_time`
  bool interrupted = false;
};

// The scene of a case as a run simulates it: in full, or reduced to what its script needs. Throws what building throws.
crane_models::Scene simulated_scene(const cases::Case& description, bool full_scene, crane_models::ReductionReport& reduction);

// Makes the unit of one engine; `make_engine` is the one that knows them all.
using EngineFactory = std::function<std::unique_ptr<EngineUnit>(
    const std::string& engine, const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
    const SolverSettings& solver)>;

// Units and connections of the case run along with every engine, each with instances of its own; a unit's outputs are recorded
// as UNIT.VARIABLE.
//
// Throws what building throws, std::invalid_argument for a list of engines that is empty or names one twice; failures
// while stepping are reported per engine.
RunResult run_case(const cases::Case& description, const RunOptions& options, const EngineFactory& factory = make_engine);

}  // namespace quayside::harness
