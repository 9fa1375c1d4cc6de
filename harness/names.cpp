#include "harness/names.h"

#include <algorithm>

#include <fmt/ranges.h>

#include "cases/edit_distance.h"

namespace quayside::harness {

namespace {

constexpr std::size_t kListed = 5;  // names in a message: enough to hold the one that was meant, few enough to read

}  // namespace

std::string nearest_names(const std::string& wanted, const std::vector<std::string>& names) {
  if (names.empty()) return "there are none";
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const std::string& name : names) {
    // A name that continues what was written ("load.position" for load.position.z) is nearer than its length says.
    const bool continues = name.compare(0, wanted.size(), wanted) == 0;
    ranked.emplace_back(continues ? 0 : cases::edit_distance(wanted, name), name);
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const bool all = ranked.size() <= kListed;
  ranked.resize(std::min(ranked.size(), kListed));
  std::vector<std::string> listed;
  for (const auto& [distance, name] : ranked) listed.push_back(name);
  return fmt::format("{}: {}", all ? "there are" : "nearest", fmt::join(listed, ", "));
}

}  // namespace quayside::harness
