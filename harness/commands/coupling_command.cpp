#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>

#include <fmt/format.h>

#include "harness/commands/commands.h"
#include "harness/commands/interrupt.h"
#include "harness/coupling/oscillator_study.h"
#include "harness/coupling/sampled_study.h"
#include "harness/coupling/split_crane.h"
#include "harness/csv.h"
#include "harness/plot.h"
#include "harness/terminal.h"

namespace quayside::harness {
namespace {

namespace fs = std::filesystem;

constexpr int kHalvings = 10;  // from 0.1 s to 0.1 ms

void write_file(const fs::path& file, const std::string& text) {
  std::ofstream stream(file);
  if (!(stream << text).flush()) throw std::runtime_error("cannot write '" + file.string() + "'");
}

void write_csv(const fs::path& directory, const std::vector<OscillatorPoint>& points, const std::vector<StabilityLimit>& limits) {
  CsvWriter errors(directory / "oscillator_errors.csv");
  for (const char* name : {"cut", "method", "step [s]", "tolerance", "error [m]", "unit_steps", "order"}) errors.cell(name);
  errors.end_row();
  for (const OscillatorPoint& p : points) {
    errors.cell(to_string(p.cut));
    errors.cell(p.method);
    for (const double value : {p.step, p.tolerance, p.error, static_cast<double>(p.unit_steps), p.order}) errors.cell(value);
    errors.end_row();
  }
  errors.close();
  CsvWriter stability(directory / "oscillator_limits.csv");
  for (const char* name : {"cut", "method", "theory [s]", "measured [s]"}) stability.cell(name);
  stability.end_row();
  for (const StabilityLimit& limit : limits) {
    stability.cell(to_string(limit.cut));
    stability.cell(limit.method);
    stability.cell(limit.theory);
    stability.cell(limit.measured);
    stability.end_row();
  }
  stability.close();
}

std::string chart(const std::vector<OscillatorPoint>& points) {
  std::vector<Panel> panels;
  for (const Cut cut : {Cut::displacement_force, Cut::force_force}) {
    panels.push_back({fmt::format("{}: largest error of a position [m]", to_string(cut)), {}});
    for (const OscillatorPoint& p : points) {
      if (p.cut != cut) continue;
      std::vector<Curve>& curves = panels.back().curves;
      if (curves.empty() || curves.back().label != p.method) curves.push_back({p.method, {}, {}});
      const bool shown = p.error < 1;  // what has blown up is no error
      curves.back().x.push_back(static_cast<double>(p.unit_steps));
      curves.back().y.push_back(shown ? p.error : std::nan(""));
    }
  }
  return svg_plot("Masters on the two-mass oscillator: error against cost", {"steps of units in 4 s", true, true, true}, panels);
}

void print(const std::vector<OscillatorPoint>& points, const std::vector<StabilityLimit>& limits) {
  using Align = Table::Align;
  Table errors({Align::left, Align::left, Align::right, Align::right, Align::right, Align::right, Align::right});
  errors.add({"cut", "method", "step [s]", "tolerance", "error [m]", "unit steps", "order"});
  for (const OscillatorPoint& p : points) {
    errors.add({to_string(p.cut), p.method, format_number(p.step, 3), p.tolerance > 0 ? format_number(p.tolerance, 2) : "",
                p.error < 1 ? format_number(p.error, 3) : "unstable", std::to_string(p.unit_steps),
                std::isfinite(p.order) && p.error < 1 ? fmt::format("{:.2f}", p.order) : ""});
  }
  Table table({Align::left, Align::left, Align::right, Align::right});
  table.add({"cut", "method", "limit by theory [s]", "found [s]"});
  const auto text = [](double limit) { return std::isfinite(limit) ? format_number(limit, 4) : fmt::format("> {:g}", kLongestStep); };
  for (const StabilityLimit& limit : limits) table.add({to_string(limit.cut), limit.method, text(limit.theory), text(limit.measured)});
  fmt::print("Two-mass oscillator, {} s, error against the exact solution\n{}\nLongest stable step (iterated: at which rounds "
             "converge)\n{}",
             kOscillatorDuration, errors.text(), table.text());
}

// --- Sampled contact

const std::vector<double> kBounceSteps{1e-4, 2e-4, 5e-4, 1e-3, 2e-3};     // [s]
const std::vector<double> kCaseSteps{1e-2, 5e-3, 2e-3, 1e-3, 5e-4};       // [s]

std::string number(double value) { return std::isfinite(value) ? format_number(value, 4) : "failed"; }

void study_sampled_contact(const fs::path& directory) {
  using Align = Table::Align;
  Table bounces({Align::left, Align::right, Align::right, Align::right});
  bounces.add({"engine", "step [s]", "leaves/arrives by theory", "found"});
  CsvWriter bounce_csv(directory / "sampled_bounces.csv");
  for (const char* name : {"engine", "step [s]", "theory", "found"}) bounce_csv.cell(name);
  bounce_csv.end_row();
  for (const SampledBounce& b : sampled_bounces(kBounceSteps)) {
    bounces.add({b.engine, number(b.step), number(b.theory), number(b.restitution)});
    bounce_csv.cell(b.engine);
    for (const double value : {b.step, b.theory, b.restitution}) bounce_csv.cell(value);
    bounce_csv.end_row();
  }
  bounce_csv.close();

  Table rests({Align::left, Align::left, Align::right, Align::right});
  rests.add({"engine", "direction", "limit by theory [s]", "found [s]"});
  CsvWriter rest_csv(directory / "sampled_rests.csv");
  for (const char* name : {"engine", "direction", "theory [s]", "found [s]"}) rest_csv.cell(name);
  rest_csv.end_row();
  for (const SampledRest& r : sampled_rests()) {
    rests.add({r.engine, r.direction, number(r.theory), number(r.found)});
    rest_csv.cell(r.engine);
    rest_csv.cell(r.direction);
    rest_csv.cell(r.theory);
    rest_csv.cell(r.found);
    rest_csv.end_row();
  }
  rest_csv.close();
  fmt::print("\nContact held between communication points: a container bounces without damping\n{}\nLongest step with which it "
             "rests on the ground\n{}{}: sampled_bounces.csv, sampled_rests.csv\n",
             bounces.text(), rests.text(), directory.string());
}

// --- A crane in three units

const std::vector<double> kCraneSteps{0.2, 0.1, 0.05, 0.025, 0.0125};     // [s]
const std::vector<double> kCraneTolerances{1e-2, 1e-3, 1e-4};
constexpr double kCraneReference = 0.00625, kCraneDuration = 2;  // [s]

void study_split_crane(const fs::path& directory) {
  using Align = Table::Align;
  Table table({Align::left, Align::right, Align::right, Align::right, Align::right, Align::right});
  table.add({"method", "step [s]", "tolerance", "error [m]", "evaluations", "order"});
  CsvWriter csv(directory / "split_crane.csv");
  for (const char* name : {"method", "step [s]", "tolerance", "error [m]", "evaluations", "order"}) csv.cell(name);
  csv.end_row();
  std::vector<Curve> curves;
  for (const SplitPoint& p : split_crane_errors(kCraneSteps, kCraneTolerances, kCraneReference, kCraneDuration)) {
    table.add({p.method, format_number(p.step, 3), p.tolerance > 0 ? format_number(p.tolerance, 2) : "", format_number(p.error, 3),
               std::to_string(p.evaluations), std::isfinite(p.order) ? fmt::format("{:.2f}", p.order) : ""});
    csv.cell(p.method);
    for (const double value : {p.step, p.tolerance, p.error, static_cast<double>(p.evaluations), p.order}) csv.cell(value);
    csv.end_row();
    if (curves.empty() || curves.back().label != p.method) curves.push_back({p.method, {}, {}});
    curves.back().x.push_back(static_cast<double>(p.evaluations));
    curves.back().y.push_back(p.error);
  }
  csv.close();
  write_file(directory / "split_crane.svg",
             svg_plot("A crane cut in drives, trolley and load: error against cost",
                      {"evaluations of the load's dynamics", true, true, true}, {{"largest error of a position [m]", curves}}));
  fmt::print("\nA crane cut in drives, trolley and load, {} s, against the iteration in steps of {} s\n{}{}: split_crane.csv, "
             "split_crane.svg\n",
             kCraneDuration, kCraneReference, table.text(), directory.string());
}

void study_case(const fs::path& directory, const std::string& file) {
  using Align = Table::Align;
  const cases::Case description = cases::load_case(file);
  Table table({Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::left});
  table.add({"engine", "step [s]", "rms [m]", "max [m]", "residual [J]", "time", ""});
  CsvWriter csv(directory / "sampled_runs.csv");
  for (const char* name : {"engine", "step [s]", "rms [m]", "max [m]", "energy_residual [J]", "wall_ratio", "failure"}) csv.cell(name);
  csv.end_row();
  std::vector<Curve> errors, residuals;
  for (const SampledRun& r : sampled_runs(description, kCaseSteps)) {
    table.add({r.engine, number(r.step), number(r.rms), number(r.max), number(r.residual), fmt::format("x {:.1f}", r.wall_ratio),
               r.failure.value_or("")});
    csv.cell(r.engine);
    for (const double value : {r.step, r.rms, r.max, r.residual, r.wall_ratio}) csv.cell(value);
    csv.cell(r.failure.value_or(""));
    csv.end_row();
    if (errors.empty() || errors.back().label != r.engine) {
      errors.push_back({r.engine, {}, {}});
      residuals.push_back({r.engine, {}, {}});
    }
    if (r.failure) continue;
    errors.back().x.push_back(r.step);
    errors.back().y.push_back(r.rms);
    residuals.back().x.push_back(r.step);
    residuals.back().y.push_back(std::abs(r.residual));
  }
  csv.close();
  write_file(directory / "sampled_runs.svg",
             svg_plot("Contact sampled at communication points: " + description.title, {"communication step [s]", true, true, true},
                      {{"rms distance to contact in the dynamics [m]", errors}, {"energy that the balance misses [J]", residuals}}));
  fmt::print("\n{}: contact sampled against contact in the dynamics (time: against the same)\n{}{}: sampled_runs.csv, "
             "sampled_runs.svg\n",
             description.name, table.text(), directory.string());
}

void study_oscillator(const fs::path& directory) {
  const TwoMassOscillator oscillator;
  const auto points = oscillator_errors(oscillator, kHalvings);
  const auto limits = oscillator_limits(oscillator);
  write_csv(directory, points, limits);
  write_file(directory / "oscillator.svg", chart(points));
  print(points, limits);
  fmt::print("{}: oscillator_errors.csv, oscillator_limits.csv, oscillator.svg\n", directory.string());
}

struct CouplingOptions {
  std::string out = "runs/coupling", file;
};

void study(const CouplingOptions& options) {
  const fs::path directory = options.out;
  fs::create_directories(directory);
  std::vector<std::function<void()>> studies{[&] { study_oscillator(directory); }, [&] { study_split_crane(directory); },
                                             [&] { study_sampled_contact(directory); }};
  if (!options.file.empty()) studies.push_back([&] { study_case(directory, options.file); });
  const Interrupt interrupt;
  for (const auto& study : studies) {  // each prints what it found
    study();
    std::fflush(stdout);
    if (Interrupt::signal() != 0) end_interrupted("the studies up to then are in " + directory.string());
  }
}

}  // namespace

void add_coupling_command(CLI::App& app) {
  auto options = std::make_shared<CouplingOptions>();
  CLI::App* command = app.add_subcommand("coupling", "What coupling costs: masters and sampled contact, against known answers");
  command->add_option("case", options->file, "Case file for sampled contact against contact in the dynamics")->type_name("CASE");
  command->add_option("--out", options->out, "Where results go")->type_name("DIR")->capture_default_str();
  command->footer(
      "The two-mass oscillator is cut in two ways and stepped by every master (jacobi, gauss_seidel, iterated,\n"
      "error_controlled): its error against the exact solution over the macro step and over the cost in steps of units,\n"
      "the order, and the longest stable step beside the one that theory gives. So is a crane, cut in its drives, the trolley\n"
      "with its motor, and ropes with spreader and load. A container bounces and rests on contact\n"
      "forces that are held between communication points, beside what theory says of that.\n\n"
      "Example:\n"
      "  quayside coupling cases/land_on_stack.yaml");
  command->callback([options] { study(*options); });
}

}  // namespace quayside::harness
