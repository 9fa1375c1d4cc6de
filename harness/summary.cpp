#include "harness/summary.h"

#include <algorithm>
#include <cmath>

#include "harness/versions.h"

namespace quayside::harness {

namespace {

using Json = nlohmann::ordered_json;

// The value below which the given part of the sample lies (nearest rank); null of an empty sample.
Json quantile(const std::vector<double>& sorted, double part) {
  if (sorted.empty()) return nullptr;
  const auto rank = static_cast<std::size_t>(std::ceil(part * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

Json case_json(const cases::Case& description) {
  return {{"name", description.name},
          {"title", description.title},
          {"file", description.file.string()},
          {"duration", description.duration},
          {"output_interval", description.output_interval},
          {"text", description.text}};
}

Json scene_json(const RunResult& run) {
  Json left_out = Json::array();
  for (const auto& entry : run.reduction.entries) left_out.push_back({{"what", entry.what}, {"reason", entry.reason}});
  return {{"bodies", run.scene.bodies.size()},
          {"degrees_of_freedom", crane_models::degrees_of_freedom(run.scene)},
          {"contact_pairs", run.scene.pairs.size()},
          {"before_reduction",
           {{"bodies", run.reduction.bodies_before},
            {"degrees_of_freedom", run.reduction.degrees_of_freedom_before},
            {"contact_pairs", run.reduction.pairs_before}}},
          {"left_out", left_out}};
}

Json contact_json(const cases::ContactSpec& contact) {
  return {{"model", contact.model},
          {"law", contact.law},
          {"stiffness", contact.stiffness},
          {"restitution", contact.restitution},
          {"reference_speed", contact.reference_speed},
          {"friction", contact.friction},
          {"friction_law", contact.friction_law},
          {"transition_speed", contact.transition_speed},
          {"network", contact.network}};
}

Json solver_json(const cases::SolverSpec& solver) {
  return {{"relative_tolerance", solver.relative_tolerance},
          {"max_step", solver.max_step},
          {"mujoco_step", solver.mujoco_step},
          {"integrator", solver.integrator},
          {"mujoco_integrator", solver.mujoco_integrator},
          {"free_bodies", solver.free_bodies}};
}

Json engine_json(const EngineRun& engine) {
  std::vector<double> step_times = engine.step_times_s;
  std::sort(step_times.begin(), step_times.end());
  const EnergyLedger& energy = engine.energy;
  return {{"wall_s", engine.wall_s},
          {"simulated_s", engine.simulated_s},
          {"real_time_factor", engine.wall_s > 0 ? Json(engine.simulated_s / engine.wall_s) : Json(nullptr)},
          {"steps", engine.statistics.steps},
          {"rhs_evaluations", engine.statistics.rhs_evaluations},
          {"jacobians", engine.statistics.jacobians},
          {"contact_queries", engine.statistics.contact.queries},
          {"network_evaluations", engine.statistics.contact.network_evaluations},
          {"contact_fallbacks", engine.statistics.contact.fallbacks},
          {"step_time_s",
           {{"median", quantile(step_times, 0.5)}, {"p99", quantile(step_times, 0.99)}, {"max", quantile(step_times, 1)}}},
          {"energy",
           {{"start", energy.start},
            {"end", energy.kinetic + energy.potential},
            {"work_in", energy.work_in},
            {"dissipated", energy.dissipated},
            {"residual", energy.residual()},
            {"largest_exchange", energy.largest_exchange}}},
          {"phantom_contacts", engine.statistics.phantom_contacts},
          {"events", engine.events.size()},
          {"open_contacts", to_json(engine.open_contacts)},
          {"failure", engine.failure ? Json(*engine.failure) : Json(nullptr)}};
}

}  // namespace

bool EvaluatedRun::completed() const {
  return std::none_of(run.engines.begin(), run.engines.end(), [](const EngineRun& e) { return e.failure.has_value(); });
}

bool EvaluatedRun::expectations_hold() const {
  return std::none_of(expectations.begin(), expectations.end(),
                      [](const ExpectationResult& e) { return e.verdict == Verdict::failed; });
}

EvaluatedRun evaluate(RunResult run) {
  EvaluatedRun evaluated;
  evaluated.run = std::move(run);
  const auto& engines = evaluated.run.engines;
  for (std::size_t i = 1; i < engines.size(); ++i)
    evaluated.comparisons.push_back(compare_engines(engines.front(), engines[i]));
  evaluated.expectations = evaluate_expectations(evaluated.run);
  return evaluated;
}

nlohmann::ordered_json to_json(const Event& event) {
  return {{"time", seconds(event.time)},
          {"event", to_string(event.kind)},
          {"subject", event.subject},
          {"impulse", event.impulse},
          {"peak_force", event.peak_force},
          {"duration", event.duration}};
}

nlohmann::ordered_json to_json(const std::vector<Event>& events) {
  Json list = Json::array();
  for (const Event& event : events) list.push_back(to_json(event));
  return list;
}

nlohmann::ordered_json to_json(const TrajectoryComparison& comparison) {
  Json signals = Json::object();
  for (const SignalDifference& signal : comparison.signals)
    signals[signal.signal] = {{"unit", signal.unit},
                              {"rms", signal.rms},
                              {"max", signal.max},
                              {"max_time", signal.max_time},
                              {"end", signal.end}};
  const bool meets = comparison.samples > 0;
  return {{"from", meets ? Json(comparison.from) : Json(nullptr)},
          {"to", meets ? Json(comparison.to) : Json(nullptr)},
          {"samples", comparison.samples},
          {"signals", signals}};
}

nlohmann::ordered_json to_json(const EventComparison& comparison) {
  Json pairs = Json::array();
  for (const EventPair& pair : comparison.pairs)
    pairs.push_back({{"event", to_string(pair.a.kind)},
                     {"subject", pair.a.subject},
                     {"time", seconds(pair.a.time)},
                     {"time_shift", pair.time_shift()},
                     {"impulse", pair.a.impulse},
                     {"impulse_difference", pair.impulse_difference()},
                     {"peak_force", pair.a.peak_force},
                     {"peak_force_difference", pair.peak_force_difference()}});
  return {{"matched", pairs},
          {"only_first", to_json(comparison.only_a)},
          {"only_second", to_json(comparison.only_b)}};
}

nlohmann::ordered_json to_json(const ExpectationResult& result) {
  return {{"text", result.text},
          {"verdict", to_string(result.verdict)},
          {"measured", result.measured ? Json(*result.measured) : Json(nullptr)},
          {"finding", result.finding},
          {"why", result.why},
          {"line", result.line}};
}

nlohmann::ordered_json to_json(const BudgetLine& line) {
  Json json = {{"share", line.share}, {"comparison", line.comparison}};
  if (line.failure) {
    json["failure"] = *line.failure;
    return json;
  }
  json["position"] = {{"unit", "m"}, {"rms", line.position.rms}, {"max", line.position.max}, {"end", line.position.end}};
  json["impulse"] = {{"unit", "N s"}, {"largest_difference", line.impulse}, {"largest", line.largest_impulse}};
  json["peak_force"] = {{"unit", "N"}, {"largest_difference", line.peak_force}};
  json["impacts_unmatched"] = line.unmatched;
  return json;
}

nlohmann::ordered_json summary(const EvaluatedRun& evaluated, const std::string& command) {
  const RunResult& run = evaluated.run;
  Json versions_json = Json::object();
  for (const auto& [name, version] : versions()) versions_json[name] = version;
  Json engines = Json::object();
  for (const EngineRun& engine : run.engines) engines[engine.engine] = engine_json(engine);
  Json comparisons = Json::object();
  for (const EngineComparison& comparison : evaluated.comparisons) {
    Json entry = {{"reference", comparison.reference}};
    entry.update(to_json(comparison.trajectory));
    entry["events"] = to_json(comparison.events);
    comparisons[comparison.engine] = entry;
  }
  Json expectations = Json::array();
  for (const ExpectationResult& result : evaluated.expectations) expectations.push_back(to_json(result));

  Json result = {{"case", case_json(run.description)},
                 {"command", command},
                 {"versions", versions_json},
                 {"scene", scene_json(run)},
                 {"contact", contact_json(run.description.contact)},
                 {"solver", solver_json(run.description.solver)},
                 {"engines", engines},
                 {"comparison", comparisons},
                 {"expectations", expectations}};
  for (const BudgetLine& line : evaluated.budget) result["error_budget"].push_back(to_json(line));
  if (run.pacing)
    result["real_time"] = {{"frames", run.pacing->frames}, {"late", run.pacing->late}, {"latest_s", run.pacing->latest_s}};
  result["interrupted"] = run.interrupted;
  return result;
}

}  // namespace quayside::harness
