#include "harness/report/run_report.h"

#include "harness/report/curves.h"
#include "harness/report/page.h"
#include "harness/report/scene_view.h"

namespace quayside::harness::report {
namespace {

using Json = nlohmann::ordered_json;

// Of the packed curves; with all else a page stays well below 10 MB.
constexpr std::size_t kMostCurveBytes = 6'000'000;

// Everything recorded, and what the engine had to do for it: wall time and mean step of the integrator per output interval.
CurveTable curve_table(const RunResult& run, const EngineRun& engine) {
  const Recording& recording = engine.trajectory;
  CurveTable table{engine.engine, {}};
  for (std::size_t i = 0; i < recording.names.size(); ++i)
    table.curves.push_back({recording.names[i], recording.units[i], recording.times, recording.columns[i]});

  // Interval i ends at row i + 1; a failed last step was timed but not recorded.
  // An integrator whose steps are longer than the interval takes none in some.
  CurveTable::Curve wall{"solver.wall_time", "s", {}, {}}, mean_step{"solver.mean_step", "s", {}, {}};
  std::size_t last = 0;
  for (std::size_t row = 1; row < recording.times.size() && row < engine.steps_taken.size(); ++row) {
    if (row <= engine.step_times_s.size()) {
      wall.times.push_back(recording.times[row]);
      wall.values.push_back(engine.step_times_s[row - 1]);
    }
    if (engine.steps_taken[row] == engine.steps_taken[last]) continue;
    mean_step.times.push_back(recording.times[row]);
    mean_step.values.push_back((recording.times[row] - recording.times[last]) /
                               static_cast<double>(engine.steps_taken[row] - engine.steps_taken[last]));
    last = row;
  }
  for (CurveTable::Curve* curve : {&wall, &mean_step})
    if (!curve->times.empty()) table.curves.push_back(std::move(*curve));
  add_contact_views(run, engine, table);
  return table;
}

}  // namespace

std::string run_report(const EvaluatedRun& evaluated, const std::string& command) {
  const RunResult& run = evaluated.run;
  std::vector<CurveTable> tables;
  Json events = Json::object();
  for (const EngineRun& engine : run.engines) {
    tables.push_back(curve_table(run, engine));
    events[engine.engine] = to_json(engine.events);
  }
  return page("run", run.description.title,
              {{"summary", summary(evaluated, command)},
               {"scene", scene_view(run)},
               {"events", events},
               {"curves", pack_curves(tables, run.description.duration, kMostCurveBytes)}});
}

void write_run_report(const std::filesystem::path& directory, const EvaluatedRun& evaluated, const std::string& command) {
  write_page((directory / kReportFile).string(), run_report(evaluated, command));
}

}  // namespace quayside::harness::report
