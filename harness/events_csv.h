// The impact record: the events of a run in all its engines as CSV.
//
// Columns: time [s], engine, event, subject, impulse [N s], peak_force [N], duration [s]. Rows are in the order of time; the
// last three columns are filled for contacts that broke and, as "contact_open" in the last rows, for those still made at
// the end of the run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/engine_unit.h"

namespace quayside::harness {

struct EventRecord {
  std::vector<Event> events;         // in the order of time
  std::vector<Event> open_contacts;  // at the end
};

struct EngineEvents {
  std::string engine;
  EventRecord record;
};

void write_events_csv(const std::vector<EngineEvents>& engines, const std::filesystem::path& file);
// Engines in the order in which they first appear; those without events do not. Throws std::runtime_error with file, line and
// what was expected.
std::vector<EngineEvents> read_events_csv(const std::filesystem::path& file);

}  // namespace quayside::harness
