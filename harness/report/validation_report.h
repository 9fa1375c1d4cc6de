// The report of a validation: all cases in one table, failures first, each leading to the report of its run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace quayside::harness::report {

struct ValidatedCase {
  std::string name;
  int exit_code = -1;   // as of `quayside run`; -1: not finished
  std::string message;  // what was said of it; empty where its summary tells all
};

// Writes report.html into `directory`, which holds <case>/summary.json of every case that was run. Throws
// std::runtime_error where that cannot be read or the page not be written.
void write_validation_report(const std::filesystem::path& directory, const std::vector<ValidatedCase>& cases,
                             const std::string& command);

}  // namespace quayside::harness::report
