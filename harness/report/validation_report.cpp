#include "harness/report/validation_report.h"

#include <fstream>
#include <stdexcept>

#include "harness/report/page.h"
#include "harness/report/run_report.h"
#include "harness/versions.h"

namespace quayside::harness::report {

using Json = nlohmann::ordered_json;

void write_validation_report(const std::filesystem::path& directory, const std::vector<ValidatedCase>& cases,
                             const std::string& command) {
  Json list = Json::array(), versions_json = Json::object();
  for (const auto& [name, version] : versions()) versions_json[name] = version;
  for (const ValidatedCase& one : cases) {
    list.push_back({{"name", one.name}, {"exit_code", one.exit_code}, {"message", one.message}});
    const std::filesystem::path file = directory / one.name / "summary.json";
    if (!one.message.empty() || !std::filesystem::exists(file)) continue;
    std::ifstream stream(file);
    const Json summary = Json::parse(stream, nullptr, false);
    if (summary.is_discarded()) throw std::runtime_error(file.string() + ": is no JSON");
    list.back()["summary"] = summary;
  }
  write_page((directory / kReportFile).string(),
             page("validation", "Validation", {{"command", command}, {"versions", versions_json}, {"cases", list}}));
}

}  // namespace quayside::harness::report
