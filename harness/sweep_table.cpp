#include "harness/sweep_table.h"

#include <array>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>

#include "harness/csv.h"

namespace quayside::harness {
namespace {

constexpr std::array kErrors{1e-3, 1e-4, 1e-5, 1e-6};  // rms distance to the reference [m]
constexpr double kNever = std::numeric_limits<double>::infinity();

enum Family { bdf, sundials, simbody, same_law, mujoco, kFamilies };

Family family_of(const std::string& engine, const std::string& integrator) {
  static const std::set<std::string> kOfSundials{"adams", "erk", "dirk"};
  if (engine == "mujoco") return mujoco;
  if (engine == "mujoco_same_law") return same_law;
  return integrator == "bdf" ? bdf : kOfSundials.count(integrator) > 0 ? sundials : simbody;
}

struct Summary {
  std::array<std::array<double, kFamilies>, kErrors.size()> fastest;  // time per simulated second [s]
  std::string references_apart = "–";                                 // [m]
};

Summary summary_of(const std::filesystem::path& file) {
  Summary summary;
  for (auto& families : summary.fastest) families.fill(kNever);
  CsvReader csv(file);
  std::vector<std::string> cells;
  std::map<std::string, std::size_t> column;
  if (csv.next_row(cells)) {
    for (std::size_t i = 0; i < cells.size(); ++i) column[cells[i]] = i;
  }
  for (const char* name : {"engine", "integrator", "real_time_factor", "error_rms [m]", "front"}) {
    if (column.count(name) == 0) csv.fail(fmt::format("no column '{}', expected a table as `quayside sweep` writes it", name));
  }
  while (csv.next_row(cells)) {
    const auto text = [&](const char* name) { return cells[column.at(name)]; };
    const auto value = [&](const char* name) { return csv.number(text(name), name); };
    if (cells.size() != column.size()) csv.fail(fmt::format("{} cells, expected {}", cells.size(), column.size()));
    if (text("error_rms [m]").empty()) continue;  // it failed
    const double error = value("error_rms [m]");
    if (text("front") == "reference") {
      summary.references_apart = fmt::format("{:.0e}", error);
      continue;
    }
    const Family family = family_of(text("engine"), text("integrator"));
    for (std::size_t i = 0; i < kErrors.size(); ++i) {
      double& fastest = summary.fastest[i][family];
      if (error <= kErrors[i]) fastest = std::min(fastest, 1 / value("real_time_factor"));
    }
  }
  return summary;
}

std::string cell(double time, double unit, const char* format) {
  return time == kNever ? "–" : unit == kNever ? "only" : fmt::format(fmt::runtime(format), time / unit);
}

}  // namespace

std::string sweep_table(const std::vector<std::filesystem::path>& files) {
  std::string table = "| case | references apart [m] | error [m] | BDF [ms/s] | other SUNDIALS | Simbody's own | MuJoCo, same law | MuJoCo |\n"
                      "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const auto& file : files) {
    const Summary summary = summary_of(file);
    std::string name = file.stem().string();
    name = name.substr(0, name.rfind("_sweep"));
    for (std::size_t i = 0; i < kErrors.size(); ++i) {
      const auto& fastest = summary.fastest[i];
      table += i == 0 ? fmt::format("| [`{}`]({}_sweep.svg) | {} ", name, name, summary.references_apart) : "| | ";
      table += fmt::format("| {:.0e} | {} ", kErrors[i], cell(fastest[bdf], 1e-3, "{:.3g}"));
      for (const Family family : {sundials, simbody, same_law, mujoco}) {
        table += fmt::format("| {} ", cell(fastest[family], fastest[bdf], "× {:.2g}"));
      }
      table += "|\n";
    }
  }
  return table;
}

}  // namespace quayside::harness
