// What a yard costs: one container is set on a stack, among ten containers and among ten thousand.
//
//   start:  from the case file to engines at time 0 [s]
//   step:   time of one integrator step, on average over the job [s]
//
//     yard_benchmark --benchmark_enable_random_interleaving=true --benchmark_repetitions=15
#include <benchmark/benchmark.h>

#include <chrono>

#include "harness/run.h"

namespace quayside::harness {
namespace {

const char kCase[] = QUAYSIDE_CASES "/yard_of_10000.yaml";

// The stack under the load and the one beside it; expectations speak of the whole yard.
const std::vector<std::string> kTen{"stacks.yard.bays=1", "stacks.yard.rows=2", "stacks.yard.position=[0, 20, 0]", "expect=[]"};

EngineRun run(const std::vector<std::string>& overrides) {
  RunOptions options;
  options.engines = {"simbody"};
  return std::move(run_case(cases::load_case(kCase, overrides), options).engines[0]);
}

void step(benchmark::State& state, const std::vector<std::string>& overrides) {
  for (auto _ : state) {
    const EngineRun job = run(overrides);
    if (job.failure) return state.SkipWithError(job.failure->c_str());
    state.SetIterationTime(job.wall_s / static_cast<double>(job.statistics.steps));
    state.counters["steps"] = static_cast<double>(job.statistics.steps);
  }
}

void start(benchmark::State& state, std::vector<std::string> overrides) {
  overrides.push_back("duration=0.02");  // one communication point
  overrides.push_back("script=[{at: 0, hoist: -0.3}]");
  overrides.push_back("expect=[]");
  for (auto _ : state) benchmark::DoNotOptimize(run(overrides));
}

BENCHMARK_CAPTURE(step, ten, kTen)->UseManualTime()->Iterations(1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(step, ten_thousand, {})->UseManualTime()->Iterations(1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(start, ten, kTen)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(start, ten_thousand, {})->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace quayside::harness

BENCHMARK_MAIN();
