// The options that commands about cases share.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cases/case.h"
#include "harness/run.h"

namespace quayside::harness {

struct CaseOptions {
  std::vector<std::string> engines = RunOptions().engines;
  std::string contact_model, contact_law, integrator;  // empty: as in the case
  bool full_scene = false;
  std::vector<std::string> overrides;

  void add_to(CLI::App& command);

  // Throws cases::CaseError, also for expectations of signals that the run will not have; std::invalid_argument for an
  // engine named twice.
  cases::Case load(const std::filesystem::path& file) const;
  RunOptions run_options() const;
};

// Files as given, directories by their *.yaml in the order of their names. Throws cases::CaseError for a directory without.
std::vector<std::filesystem::path> case_files(const std::vector<std::string>& paths);

// Every variable that a run of this case has: the engines' inputs, and all outputs, of engines and drives, as recorded.
struct CaseVariables {
  std::vector<Variable> inputs, outputs;
};
CaseVariables case_variables(const cases::Case& description);

}  // namespace quayside::harness
