#include "harness/script_use.h"

#include <cmath>

namespace quayside::harness {
namespace {

constexpr double kDegree = EIGEN_PI / 180;
constexpr int kManyChanges = 1000;  // of a drive that a unit moves as it likes

}  // namespace

std::string commanded_by(const cases::ConnectionSpec& connection) {
  const std::string prefix = "command.";
  return connection.to.rfind(prefix, 0) == 0 ? connection.to.substr(prefix.size()) : "";
}

crane_models::ScriptUse use_of(const crane_models::Scene& scene, const cases::Case& description) {
  const std::size_t drives = scene.drives.size(), commands = scene.commands.size();
  crane_models::ScriptUse use{std::vector<bool>(drives), std::vector<bool>(commands), std::vector<double>(drives),
                              std::vector<int>(drives)};
  for (const cases::ConnectionSpec& connection : description.connections) {
    const std::string name = commanded_by(connection);
    for (std::size_t i = 0; i < drives; ++i) {
      if (name != scene.drives[i].name) continue;
      use.drives_used[i] = true;
      use.drive_travel[i] = scene.drives[i].max_speed * description.duration;
      use.drive_changes[i] = kManyChanges;
    }
    for (std::size_t i = 0; i < commands; ++i) {
      if (name == scene.commands[i].name) use.commands_used[i] = true;
    }
  }
  for (const cases::ScriptEntry& line : description.script) {
    for (std::size_t i = 0; i < drives; ++i) {
      const double unit = scene.drives[i].unit == "rad" ? kDegree : 1;
      for (const auto& [name, speed] : line.speeds) {
        if (name != scene.drives[i].name) continue;
        ++use.drive_changes[i];
        use.drive_travel[i] = std::max(use.drive_travel[i], std::abs(speed) * unit * description.duration);
        if (speed != 0) use.drives_used[i] = true;
      }
    }
    for (std::size_t i = 0; i < commands; ++i) {
      for (const auto& [name, value] : line.commands) {
        if (name == scene.commands[i].name && value != scene.commands[i].start) use.commands_used[i] = true;
      }
    }
  }
  return use;
}

}  // namespace quayside::harness
