#include "harness/report/sweep_report.h"

#include <fmt/format.h>

#include "harness/report/page.h"
#include "harness/versions.h"

namespace quayside::harness::report {
namespace {

using Json = nlohmann::ordered_json;

std::string references_text(const SweepPoint& second) {
  if (second.failure) return fmt::format("The second reference, {}, failed: {}.", second.contender.label(), *second.failure);
  if (second.wall_s.empty()) return "";
  return fmt::format("The reference and a second, independent one, {} at {:g} s, are {:.3g} m apart (rms; at most {:.3g} m).",
                     second.contender.label(), second.contender.setting, second.rms, second.max);
}

}  // namespace

void write_sweep_report(const std::filesystem::path& file, const cases::Case& description, const Sweep& sweep,
                        const std::string& command) {
  Json points = Json::array(), versions_json = Json::object();
  for (const auto& [name, version] : versions()) versions_json[name] = version;
  for (const SweepPoint& point : sweep.points)
    points.push_back({{"label", point.contender.label()},
                      {"engine", point.contender.engine},
                      {"setting", point.contender.setting},
                      {"wall_s", point.median_wall_s()},
                      {"rms", point.rms},
                      {"max", point.max},
                      {"steps", point.steps},
                      {"evaluations", point.rhs_evaluations},
                      {"front", on_front(point, sweep.points)},
                      {"failure", point.failure ? Json(*point.failure) : Json(nullptr)}});
  write_page(file.string(), page("sweep", description.title,
                                 {{"title", description.title},
                                  {"file", description.file.string()},
                                  {"command", command},
                                  {"versions", versions_json},
                                  {"simulated_s", sweep.simulated_s},
                                  {"interrupted", sweep.interrupted},
                                  {"references", references_text(sweep.second_reference)},
                                  {"points", points}}));
}

}  // namespace quayside::harness::report
