// One self-contained HTML page: the page's sources, embedded when this was built, around the data of one report.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace quayside::harness::report {

// `kind`: "run", "sweep" or "validation"; it says which of the page's scripts takes the data.
std::string page(const std::string& kind, const std::string& title, const nlohmann::ordered_json& data);

// Throws std::runtime_error, naming the file, where it cannot be written.
void write_page(const std::string& file, const std::string& html);

}  // namespace quayside::harness::report
