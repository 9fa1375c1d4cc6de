#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>

#include <fmt/format.h>

#include "harness/commands/commands.h"
#include "harness/coupling/oscillator_study.h"
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

void study(const fs::path& directory) {
  fs::create_directories(directory);
  const TwoMassOscillator oscillator;
  const auto points = oscillator_errors(oscillator, kHalvings);
  const auto limits = oscillator_limits(oscillator);
  write_csv(directory, points, limits);
  write_file(directory / "oscillator.svg", chart(points));
  print(points, limits);
  fmt::print("{}: oscillator_errors.csv, oscillator_limits.csv, oscillator.svg\n", directory.string());
}

}  // namespace

void add_coupling_command(CLI::App& app) {
  auto out = std::make_shared<std::string>("runs/coupling");
  CLI::App* command = app.add_subcommand("coupling", "What a cut costs: masters on an oscillator with a known solution");
  command->add_option("--out", *out, "Where results go")->type_name("DIR")->capture_default_str();
  command->footer(
      "The two-mass oscillator is cut in two ways and stepped by every master (jacobi, gauss_seidel, iterated,\n"
      "error_controlled): its error against the exact solution over the macro step and over the cost in steps of units,\n"
      "the order, and the longest stable step beside the one that theory gives.");
  command->callback([out] { study(*out); });
}

}  // namespace quayside::harness
