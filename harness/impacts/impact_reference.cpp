#include "harness/impacts/impact_reference.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "harness/csv.h"

namespace quayside::harness {
namespace {

constexpr double kMargin = 10;      // over the difference to a run at a tenth of the tolerance
constexpr double kTighter = 0.1;
constexpr double kStepsOfABlow = 100;

const std::vector<std::string> kColumns = {"impact", "response", "unit", "value", "tolerance"};

using Key = std::pair<std::string, std::string>;
Key key(const ReferenceRow& row) { return {row.impact, row.response}; }

std::map<Key, const ReferenceRow*> by_key(const std::vector<ReferenceRow>& rows) {
  std::map<Key, const ReferenceRow*> result;
  for (const ReferenceRow& row : rows) result[key(row)] = &row;
  return result;
}

bool same(const ReferenceRow& before, double now) { return std::abs(now - before.value) <= before.tolerance; }

}  // namespace

std::vector<ReferenceRow> read_impact_reference(const std::filesystem::path& file) {
  CsvReader csv(file);
  std::vector<std::string> cells;
  if (!csv.next_row(cells) || cells != kColumns) csv.fail("expected the columns impact,response,unit,value,tolerance");
  std::vector<ReferenceRow> rows;
  while (csv.next_row(cells)) {
    if (cells.size() != kColumns.size()) csv.fail("expected five cells");
    rows.push_back({cells[0], cells[1], cells[2], csv.number(cells[3], "value"), csv.number(cells[4], "tolerance")});
  }
  return rows;
}

void write_impact_reference(const std::filesystem::path& file, const std::vector<ReferenceRow>& rows) {
  CsvWriter csv(file);
  for (const std::string& column : kColumns) csv.cell(column);
  csv.end_row();
  for (const ReferenceRow& row : rows) {
    for (const std::string& text : {row.impact, row.response, row.unit}) csv.cell(text);
    csv.cell(row.value);
    csv.cell(row.tolerance);
    csv.end_row();
  }
  csv.close();
}

std::vector<ReferenceRow> measure_impacts(const std::vector<Impact>& impacts, const ImpactSetup& setup, const ImpactProgress& progress) {
  std::vector<ReferenceRow> rows;
  for (std::size_t i = 0; i < impacts.size() && progress(i, impacts.size()); ++i) {
    for (const ResponseValue& response : impact_response(impacts[i], setup)) {
      rows.push_back({impacts[i].name(), response.name, response.unit, response.value});
    }
  }
  return rows;
}

void estimate_tolerances(const std::vector<Impact>& impacts, const ImpactSetup& setup, std::vector<ReferenceRow>& rows,
                         const ImpactProgress& progress) {
  ImpactSetup tighter = setup;
  tighter.relative_tolerance *= kTighter;
  auto row = rows.begin();
  for (std::size_t i = 0; i < impacts.size() && progress(i, impacts.size()); ++i) {
    for (const ResponseValue& response : impact_response(impacts[i], tighter)) {
      assert(row != rows.end() && row->response == response.name);
      // Tolerances of velocities are for 1 m/s: relative to what a slow impact has they are larger.
      const double least = kStepsOfABlow * setup.relative_tolerance / std::min(1.0, impacts[i].speed) * response.scale;
      row->tolerance = std::stod(fmt::format("{:.2g}", std::max({least, response.spread, kMargin * std::abs(row->value - response.value)})));
      ++row;
    }
  }
}

std::vector<MovedResponse> moved_responses(const std::vector<ReferenceRow>& before, const std::vector<ReferenceRow>& now) {
  std::vector<MovedResponse> moved;
  const auto known = by_key(before), measured = by_key(now);
  for (const ReferenceRow& row : now) {
    const auto found = known.find(key(row));
    if (found == known.end()) moved.push_back({row.impact, row.response, row.unit, {}, row.value});
    else if (!same(*found->second, row.value))
      moved.push_back({row.impact, row.response, row.unit, found->second->value, row.value, found->second->tolerance});
  }
  for (const ReferenceRow& row : before) {
    if (measured.find(key(row)) == measured.end()) moved.push_back({row.impact, row.response, row.unit, row.value, {}, row.tolerance});
  }
  return moved;
}

std::vector<ReferenceRow> updated_reference(const std::vector<ReferenceRow>& before, const std::vector<ReferenceRow>& now) {
  std::vector<ReferenceRow> rows = now;
  const auto known = by_key(before);
  for (ReferenceRow& row : rows) {
    const auto found = known.find(key(row));
    if (found != known.end() && same(*found->second, row.value)) row = *found->second;
  }
  return rows;
}

}  // namespace quayside::harness
