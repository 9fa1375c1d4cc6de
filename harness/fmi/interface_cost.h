// What it costs to step a case through the interface: as a unit, as an FMU, against the engine called directly.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cases/case.h"

namespace quayside::harness {

struct InterfaceRun {
  std::string what;
  std::vector<double> wall_s;  // of each repetition; stepping and reading outputs, no building
  double median_wall_s() const;
};

struct StateCost {
  std::string unit;
  std::size_t bytes = 0;
  double save_s = 0, restore_s = 0;  // medians of single calls
};

struct InterfaceCosts {
  // In this order: the engine in steps from event to event; the engine in communication steps, told its inputs at events as the
  // first one is; the case as a unit, drives and master at work and all outputs read; the same inside its exported FMU,
  // called from this process; and as a foreign FMU in a process of its own.
  std::vector<InterfaceRun> runs;
  std::vector<StateCost> states;
};

// `library`: as for export_fmu. Repetitions are interleaved: every way is gone once before any is gone twice. Throws what
// building, exporting and stepping throw. `progress` is called before each run with the share of runs that are done; returning
// false ends the measurement with what there is.
InterfaceCosts measure_interface(const std::filesystem::path& case_file, const std::vector<std::string>& overrides,
                                 const std::filesystem::path& library, double step, int repetitions,
                                 const std::function<bool(double done)>& progress = [](double) { return true; });

}  // namespace quayside::harness
