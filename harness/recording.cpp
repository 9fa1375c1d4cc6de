#include "harness/recording.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "harness/csv.h"
#include "harness/names.h"

namespace quayside::harness {

namespace {

std::string titled(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : fmt::format("{} [{}]", name, unit);
}

// "load.position.z [m]" in its two parts; a title without brackets has no unit.
std::pair<std::string, std::string> name_and_unit(const std::string& title) {
  const std::size_t bracket = title.rfind(" [");
  if (bracket == std::string::npos || title.back() != ']') return {title, ""};
  return {title.substr(0, bracket), title.substr(bracket + 2, title.size() - bracket - 3)};
}

}  // namespace

std::size_t Recording::index(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw std::out_of_range(fmt::format("no signal \"{}\"; {}", name, nearest_names(name, names)));
  }
  return static_cast<std::size_t>(found - names.begin());
}

std::vector<std::size_t> Recording::indices(const std::string& name) const {
  std::vector<std::size_t> found;
  for (const char* suffix : {"", ".w", ".x", ".y", ".z"}) {
    const auto place = std::find(names.begin(), names.end(), name + suffix);
    if (place != names.end()) found.push_back(static_cast<std::size_t>(place - names.begin()));
  }
  if (found.empty()) index(name);  // throws
  return found;
}

double Recording::at(std::size_t signal, double time) const {
  const std::vector<double>& column = columns.at(signal);
  if (times.empty() || !(time >= times.front() && time <= times.back())) {
    const std::string span = times.empty() ? "is empty" : fmt::format("goes from {} s to {} s", times.front(), times.back());
    throw std::out_of_range(fmt::format("no value of {} at {} s: the recording {}", names[signal], time, span));
  }
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  const auto row = static_cast<std::size_t>(after - times.begin());
  if (*after == time) return column[row];
  const double part = (time - times[row - 1]) / (times[row] - times[row - 1]);
  return column[row - 1] + part * (column[row] - column[row - 1]);
}

void write_csv(const Recording& recording, const std::filesystem::path& file) {
  CsvWriter csv(file);
  csv.cell("time [s]");
  for (std::size_t i = 0; i < recording.names.size(); ++i) csv.cell(titled(recording.names[i], recording.units[i]));
  csv.end_row();
  for (std::size_t row = 0; row < recording.times.size(); ++row) {
    csv.cell(recording.times[row]);
    for (const std::vector<double>& column : recording.columns) csv.cell(column[row]);
    csv.end_row();
  }
  csv.close();
}

Recording read_csv(const std::filesystem::path& file) {
  CsvReader csv(file);
  Recording recording;
  std::vector<std::string> cells;
  if (!csv.next_row(cells)) csv.fail("is empty; expected a first row \"time [s],signal [unit],...\"");

  const auto [time_name, time_unit] = name_and_unit(cells[0]);
  if ((time_name != "time" && time_name != "t") || (time_unit != "s" && !time_unit.empty())) {
    csv.fail(fmt::format("the first column is \"{}\"; expected \"time [s]\"", cells[0]));
  }
  for (std::size_t i = 1; i < cells.size(); ++i) {
    const auto [name, unit] = name_and_unit(cells[i]);
    if (name.empty()) csv.fail(fmt::format("column {} has no name; expected \"signal [unit]\"", i + 1));
    if (std::find(recording.names.begin(), recording.names.end(), name) != recording.names.end()) {
      csv.fail(fmt::format("two columns are called \"{}\"", name));
    }
    recording.names.push_back(name);
    recording.units.push_back(unit);
  }
  recording.columns.resize(recording.names.size());

  while (csv.next_row(cells)) {
    if (cells.size() != recording.names.size() + 1) {
      csv.fail(fmt::format("{} cells, but the first row has {}", cells.size(), recording.names.size() + 1));
    }
    const double time = csv.number(cells[0], "time");
    if (!std::isfinite(time)) csv.fail(fmt::format("time is {}; expected a finite number", cells[0]));
    if (!recording.times.empty() && time <= recording.times.back()) {
      csv.fail(fmt::format("time {} s does not come after {} s; times have to increase", time, recording.times.back()));
    }
    recording.times.push_back(time);
    for (std::size_t i = 0; i < recording.columns.size(); ++i) {
      recording.columns[i].push_back(csv.number(cells[i + 1], recording.names[i]));
    }
  }
  return recording;
}

}  // namespace quayside::harness
