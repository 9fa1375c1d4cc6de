#include "harness/report/run_report.h"

#include "harness/build_scene.h"
#include "harness/report/curves.h"
#include "harness/report/machine_view.h"
#include "harness/report/page.h"
#include "harness/report/scene_view.h"

namespace quayside::harness::report {
namespace {

using Json = nlohmann::ordered_json;

// Of the packed curves; with all else a page stays well below 10 MB.
constexpr std::size_t kMostCurveBytes = 6'000'000;

// Everything recorded, and what the engine had to do for it: wall time and mean step of the integrator per output interval.
CurveTable curve_table(const RunResult& run, const crane_models::Scene& full, const EngineRun& engine) {
  const Recording& recording = engine.trajectory;
  CurveTable table{engine.engine, {}};
  for (std::size_t i = 0; i < recording.names.size(); ++i)
    table.curves.push_back({recording.names[i], recording.units[i], recording.times, recording.columns[i]});
  add_contact_views(run, engine, table);
  add_machine_views(full, recording, table);

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
  return table;
}

}  // namespace

std::string run_report(const RunResult& run, const nlohmann::ordered_json& summary) {
  LeftOut left_out;  // of a large yard, which is never built as a whole
  const crane_models::Scene full = build_scene(run.description, left_out);
  std::vector<CurveTable> tables;
  Json events = Json::object();
  for (const EngineRun& engine : run.engines) {
    tables.push_back(curve_table(run, full, engine));
    events[engine.engine] = to_json(engine.events);
  }
  return page("run", run.description.title,
              {{"summary", summary},
               {"scene", scene_view(run, full)},
               {"events", events},
               {"curves", pack_curves(tables, run.description.duration, kMostCurveBytes)}});
}

void write_run_report(const std::filesystem::path& directory, const RunResult& run, const nlohmann::ordered_json& summary) {
  write_page((directory / kReportFile).string(), run_report(run, summary));
}

}  // namespace quayside::harness::report
