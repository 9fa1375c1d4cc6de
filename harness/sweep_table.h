// Many sweeps in one table: for each case, how fast each family of integrators is at a given error.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace quayside::harness {

// A table in Markdown from the files that `quayside sweep` writes, `<case>_sweep.csv`. A family's time is that of its fastest
// setting whose error is at most the one asked for; of Simbody with CVODES' BDF, the default, in milliseconds per simulated
// second, of all others as multiples of it. Throws std::runtime_error for a file that is none of these.
std::string sweep_table(const std::vector<std::filesystem::path>& files);

}  // namespace quayside::harness
