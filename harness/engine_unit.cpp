#include "harness/engine_unit.h"

#include <cassert>

namespace quayside::harness {
namespace {

class VariableList {
 public:
  void input(std::string name, std::string unit, std::string description, double start) {
    list_.push_back({std::move(name), std::move(unit), Causality::input, Type::float64, std::move(description), start});
  }
  void command(std::string name, std::string description, bool start) {
    list_.push_back({std::move(name), "", Causality::input, Type::boolean, std::move(description), start ? 1.0 : 0.0});
  }
  void output(std::string name, std::string unit, std::string description) {
    list_.push_back({std::move(name), std::move(unit), Causality::output, Type::float64, std::move(description), 0});
  }
  void flag(std::string name, std::string description) {
    list_.push_back({std::move(name), "", Causality::output, Type::boolean, std::move(description), 0});
  }
  void outputs(const std::string& name, const char* components, const std::string& unit,
               const std::string& description) {
    for (const char* c = components; *c; ++c) output(name + "." + *c, unit, description);
  }
  std::vector<Variable> take() { return std::move(list_); }

 private:
  std::vector<Variable> list_;
};

}  // namespace

const char* to_string(EventKind kind) {
  switch (kind) {
    case EventKind::contact_made: return "contact_made";
    case EventKind::contact_broken: return "contact_broken";
    case EventKind::rope_slack: return "rope_slack";
    case EventKind::rope_taut: return "rope_taut";
    case EventKind::landed: return "landed";
    case EventKind::lifted: return "lifted";
    case EventKind::lock_closed: return "lock_closed";
    case EventKind::lock_opened: return "lock_opened";
    case EventKind::lock_refused: return "lock_refused";
    case EventKind::tripped: return "tripped";
    case EventKind::stopped: return "stopped";
  }
  assert(false && "an event kind without a name");
  return "";
}

std::vector<Variable> engine_variables(const crane_models::Scene& scene) {
  VariableList list;
  for (const auto& drive : scene.drives) {
    list.input(drive.name + ".value", drive.unit, drive.meaning, drive.start);
    list.input(drive.name + ".rate", drive.unit + "/s", drive.meaning + ": rate", 0);
    list.input(drive.name + ".acceleration", drive.unit + "/s2", drive.meaning + ": acceleration", 0);
    list.input(drive.name + ".jerk", drive.unit + "/s3", drive.meaning + ": jerk", 0);
  }
  for (const auto& command : scene.commands) list.command(command.name, command.meaning, command.start);

  for (const auto& frame : scene.frames) {
    list.outputs(frame.name + ".position", "xyz", "m", "position of " + frame.name + " in the world");
    list.outputs(frame.name + ".orientation", "wxyz", "1", "quaternion from " + frame.name + " to the world");
    list.outputs(frame.name + ".velocity", "xyz", "m/s", "velocity of " + frame.name + " in the world");
    list.outputs(frame.name + ".angular_velocity", "xyz", "rad/s",
                 "angular velocity of " + frame.name + " in the world");
    list.output(frame.name + ".tilt", "rad", "angle between the z axes of " + frame.name + " and the world");
  }
  for (const auto& rope : scene.ropes) {
    list.output(rope.name + ".tension", "N", "tension of the rope group");
    list.output(rope.name + ".stretch", "m", "length less rest length; negative when slack");
  }
  for (const auto& lock : scene.locks) {
    if (lock.command >= 0) list.flag(lock.name + ".closed", "whether the lock holds");
  }
  for (const auto& group : crane_models::contact_groups(scene)) {
    list.output("contact." + group.a + "." + group.b + ".force", "N",
                "magnitude of the contact force of " + group.a + " on " + group.b);
  }
  for (const auto& landed : scene.landed_switches) {
    list.flag(landed.name, "upward contact force beyond the threshold of the switch");
  }
  list.output("energy.kinetic", "J", "kinetic energy");
  list.output("energy.potential", "J", "energy of gravity, ropes, locks and contacts");
  list.output("energy.work_in", "J", "work of the drives since the start");
  list.output("energy.dissipated", "J", "taken by ropes, locks, contacts and joints since the start");
  list.output("energy.residual", "J", "what the energy balance misses: an error of the integration");
  return list.take();
}

}  // namespace quayside::harness
