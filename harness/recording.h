// Trajectories: the outputs of one run, sampled at the communication points.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace quayside::harness {

// A table: one row per time, one column per signal.
struct Recording {
  std::vector<std::string> names;            // without time: "load.position.z"
  std::vector<std::string> units;            // "m"
  std::vector<double> times;                 // [s]
  std::vector<std::vector<double>> columns;  // columns[signal][row]

  // Index of a signal. Throws std::out_of_range with the nearest names.
  std::size_t index(const std::string& name) const;
  // The scalar signals that a name stands for: itself, or name.x, name.y, name.z (or w, x, y, z).
  std::vector<std::size_t> indices(const std::string& name) const;
  // Linear interpolation at `time` within the recorded span.
  double at(std::size_t signal, double time) const;
};

// CSV: first row "time [s],load.position.z [m],...", then the rows in shortest decimal form that reads back to the same double.
void write_csv(const Recording& recording, const std::filesystem::path& file);
// Any CSV with a first column of time. Throws std::runtime_error with file, line and what was expected.
Recording read_csv(const std::filesystem::path& file);

}  // namespace quayside::harness
