#include "harness/events_csv.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/csv.h"

namespace quayside::harness {

namespace {

const std::vector<std::string> kColumns{"time [s]",      "engine",         "event",       "subject",
                                        "impulse [N s]", "peak_force [N]", "duration [s]"};
const std::string kOpen = "contact_open";
constexpr std::array kKinds{EventKind::contact_made, EventKind::contact_broken, EventKind::rope_slack,
                            EventKind::rope_taut,    EventKind::landed,         EventKind::lifted,
                            EventKind::lock_closed,  EventKind::lock_opened,
                            EventKind::lock_refused, EventKind::tripped,     EventKind::stopped};

struct Row {
  const Event* event;
  const std::string* engine;
};

// The rows of `part` of every engine's record, those of the same time in the order of the engines.
std::vector<Row> in_order_of_time(const std::vector<EngineEvents>& engines, std::vector<Event> EventRecord::*part) {
  std::vector<Row> rows;
  for (const EngineEvents& engine : engines) {
    for (const Event& event : engine.record.*part) rows.push_back({&event, &engine.engine});
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.event->time < b.event->time; });
  return rows;
}

void write_row(CsvWriter& csv, const Row& row, const std::string& kind) {
  csv.cell(seconds(row.event->time));
  csv.cell(*row.engine);
  csv.cell(kind);
  csv.cell(row.event->subject);
  for (const double value : {row.event->impulse, row.event->peak_force, row.event->duration}) {
    if (row.event->kind == EventKind::contact_broken) {
      csv.cell(value);
    } else {
      csv.cell(std::string());
    }
  }
  csv.end_row();
}

EventRecord& record_of(std::vector<EngineEvents>& engines, const std::string& name) {
  for (EngineEvents& engine : engines) {
    if (engine.engine == name) return engine.record;
  }
  engines.push_back({name, {}});
  return engines.back().record;
}

}  // namespace

void write_events_csv(const std::vector<EngineEvents>& engines, const std::filesystem::path& file) {
  CsvWriter csv(file);
  for (const std::string& column : kColumns) csv.cell(column);
  csv.end_row();
  for (const Row& row : in_order_of_time(engines, &EventRecord::events)) write_row(csv, row, to_string(row.event->kind));
  for (const Row& row : in_order_of_time(engines, &EventRecord::open_contacts)) write_row(csv, row, kOpen);
  csv.close();
}

std::vector<EngineEvents> read_events_csv(const std::filesystem::path& file) {
  CsvReader csv(file);
  std::vector<EngineEvents> engines;
  std::vector<std::string> cells;
  if (!csv.next_row(cells) || cells != kColumns) {
    csv.fail(fmt::format("expected the first row \"{}\"", fmt::join(kColumns, ",")));
  }
  std::vector<std::string> kinds;
  for (const EventKind kind : kKinds) kinds.emplace_back(to_string(kind));

  while (csv.next_row(cells)) {
    if (cells.size() != kColumns.size()) csv.fail(fmt::format("{} cells, expected {}", cells.size(), kColumns.size()));
    EventRecord& record = record_of(engines, cells[1]);
    Event event;
    const double time = csv.number(cells[0], kColumns[0]);
    constexpr double kEndOfTime = 9.2e9;  // [s]; what nanoseconds can count
    if (!(std::abs(time) < kEndOfTime)) csv.fail(fmt::format("\"{}\" is no time of a simulation", cells[0]));
    event.time = nanoseconds(time);
    event.subject = cells[3];
    const std::array<double*, 3> values{&event.impulse, &event.peak_force, &event.duration};
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!cells[i + 4].empty()) *values[i] = csv.number(cells[i + 4], kColumns[i + 4]);
    }
    if (cells[2] == kOpen) {
      event.kind = EventKind::contact_broken;
      record.open_contacts.push_back(event);
      continue;
    }
    const auto kind = std::find(kinds.begin(), kinds.end(), cells[2]);
    if (kind == kinds.end()) {
      csv.fail(fmt::format("unknown event \"{}\"; expected one of {}, {}", cells[2], fmt::join(kinds, ", "), kOpen));
    }
    event.kind = kKinds[static_cast<std::size_t>(kind - kinds.begin())];
    record.events.push_back(event);
  }
  return engines;
}

}  // namespace quayside::harness
