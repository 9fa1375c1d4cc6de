#include "cases/sections.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace quayside::cases {
namespace {

using namespace limits;

// Parts of the scene and of signal names that a container or body cannot be called after.
const std::set<std::string> kReservedNames{"boom",   "boom_tip", "contact",  "crane",   "deck",       "energy", "gantry",
                                           "ground", "guides",   "head",     "headblock", "hoist",     "inner_boom",
                                           "landed", "link",     "locks",    "mafi",    "rope",       "rotator",
                                           "spreader", "time",   "trolley",  "truck",   "twistlocks", "wind", "world"};

ContainerType read_container_type(const Value& value) {
  return value.choice<ContainerType>({{"20ft", ContainerType::iso20},
                                      {"40ft", ContainerType::iso40},
                                      {"40ft_hc", ContainerType::iso40_high_cube},
                                      {"45ft", ContainerType::iso45}});
}

// Between its limit switches.
void read_range(const Mapping& mapping, const Range& bounds, DriveSpec& drive) {
  mapping.vector<2>("range", bounds, drive.range);
  if (drive.range && !(drive.range->x() < drive.range->y())) {
    mapping["range"].refuse("the first end is not below the second, expected [lowest, highest]");
  }
}

void read_drive_limits(const Mapping& mapping, DriveSpec& drive) {
  mapping.number("max_speed", kMaxSpeed, drive.max_speed);
  mapping.number("max_acceleration", kMaxAcceleration, drive.max_acceleration);
  mapping.number("max_jerk", kMaxJerk, drive.max_jerk);
  mapping.number("emergency_stop", kMaxAcceleration, drive.emergency_stop);
  read_range(mapping, kPosition, drive);
}

// A drive of which nothing but its place is particular to the machine.
DriveSpec read_drive(const Value& value, const Range& position) {
  DriveSpec drive;
  const Mapping mapping = value.mapping({"position", "range", "max_speed", "max_acceleration", "max_jerk", "emergency_stop"});
  drive.position = mapping["position"].number(position);
  read_drive_limits(mapping, drive);
  return drive;
}

// The same for one that turns.
DriveSpec read_turning_drive(const Value& value, const Range& position) {
  DriveSpec drive;
  const Mapping mapping = value.mapping({"position", "range", "max_speed", "max_acceleration", "max_jerk", "emergency_stop"});
  drive.position = mapping["position"].number(position);
  mapping.number("max_speed", kMaxTurningSpeed, drive.max_speed);
  mapping.number("max_acceleration", kMaxTurningAcceleration, drive.max_acceleration);
  mapping.number("max_jerk", kMaxTurningJerk, drive.max_jerk);
  mapping.number("emergency_stop", kMaxTurningAcceleration, drive.emergency_stop);
  read_range(mapping, kAngle, drive);
  return drive;
}

void read_rope_crane(const Mapping& mapping, CraneSpec& crane) {
  if (const auto gantry = mapping.find("gantry")) crane.gantry = read_drive(*gantry, kPosition);
  const Mapping trolley = mapping["trolley"].mapping(
      {"position", "height", "range", "max_speed", "max_acceleration", "max_jerk", "emergency_stop"});
  crane.trolley_position = trolley["position"].number(kTrolleyPosition);
  crane.trolley_height = trolley["height"].number(kTrolleyHeight);
  read_drive_limits(trolley, crane.trolley);

  const Mapping hoist =
      mapping["hoist"].mapping({"rope_length", "range", "max_speed", "max_acceleration", "max_jerk", "emergency_stop"});
  crane.rope_length = hoist["rope_length"].number(kRopeLength);
  read_drive_limits(hoist, crane.hoist);

  if (const auto trim = mapping.find("trim")) crane.trim = read_drive(*trim, kRopeDifference);
  if (const auto list = mapping.find("list")) crane.list = read_drive(*list, kRopeDifference);
  if (const auto skew = mapping.find("skew")) crane.skew = read_drive(*skew, kRopeDifference);

  if (const auto sheaves = mapping.find("sheaves")) {
    const Mapping rectangles = sheaves->mapping({"trolley", "spreader"});
    rectangles.vector<2>("trolley", kSheaves, crane.trolley_sheaves);
    rectangles.vector<2>("spreader", kSheaves, crane.spreader_sheaves);
  }
  if (const auto ropes = mapping.find("ropes")) {
    const Mapping rope = ropes->mapping({"stiffness", "damping_time"});
    rope.number("stiffness", kRopeStiffness, crane.rope_stiffness);
    rope.number("damping_time", kDampingTime, crane.rope_damping_time);
  }
  if (const auto limits = mapping.find("limits")) {
    const Mapping limit = limits->mapping({"overload", "snag"});
    limit.number("overload", kOverload, crane.overload);
    limit.number("snag", kSnag, crane.snag);
  }
}

void read_reach_stacker(const Mapping& mapping, CraneSpec& crane) {
  if (const auto travel = mapping.find("travel")) crane.travel = read_drive(*travel, kPosition);
  crane.boom = read_turning_drive(mapping["boom"], kBoomAngle);
  if (const auto telescope = mapping.find("telescope")) crane.telescope = read_drive(*telescope, kTelescope);
  if (const auto rotation = mapping.find("rotation")) crane.rotation = read_turning_drive(*rotation, kAngle);
  if (const auto shift = mapping.find("side_shift")) crane.side_shift = read_drive(*shift, kSideShift);
  if (const auto pivots = mapping.find("pivots")) {
    pivots->mapping({"damping"}).number("damping", kPivotDamping, crane.pivot_damping);
  }
}

// The sections that belong to a machine; it has none of the others.
const std::map<std::string, std::set<std::string>> kSectionsOfMachines{
    {"quayside", {"gantry", "trolley", "hoist", "trim", "list", "skew", "sheaves", "ropes", "limits"}},
    {"rtg", {"gantry", "trolley", "hoist", "trim", "list", "skew", "sheaves", "ropes", "limits"}},
    {"reach_stacker", {"travel", "boom", "telescope", "rotation", "side_shift", "pivots"}},
    {"none", {}}};

// Exactly one of on (the spreader), on_top_of and position says where a container is.
void read_container_place(const Value& value, const Mapping& mapping, const Context& context,
                          ContainerSpec& container) {
  const auto on = mapping.find("on"), on_top_of = mapping.find("on_top_of"), position = mapping.find("position");
  if (on.has_value() + on_top_of.has_value() + position.has_value() != 1) {
    value.refuse("its place is not clear, expected exactly one of: on, on_top_of, position");
  }
  if (on) {
    container.on_spreader = on->choice<bool>({{"spreader", true}, {"mafi", false}});
    container.on_mafi = !container.on_spreader;
    if (container.on_spreader && !context.has_crane)
      on->refuse("there is no crane with a spreader, expected 'crane' and 'spreader', or a position");
    if (container.on_mafi && !context.has_mafi)
      on->refuse("there is no trailer, expected 'mafi' with its keys, or a position");
    for (const char* key : {"yaw", "fixed"}) {
      if (const auto other = mapping.find(key))
        other->refuse(container.on_mafi ? "it stands on the trailer, expected no such key with 'on'"
                                        : "it hangs on the spreader, expected no such key with 'on'");
    }
  }
  if (on_top_of) container.on_top_of = on_top_of->name();
  if (position) container.position = position->vector<3>(kPosition);
  if (const auto offset = mapping.find("offset")) {
    if (!on_top_of) offset->refuse("it is measured from the container below, expected 'on_top_of' beside it");
    container.offset = offset->vector<2>(kOffset);
  }
}

ContainerSpec read_container(const Value& value, const Context& context) {
  ContainerSpec container;
  const Mapping mapping = value.mapping(
      {"name", "type", "mass", "on", "on_top_of", "offset", "position", "yaw", "centre_of_gravity", "fixed"});
  container.name = mapping["name"].name();
  container.type = read_container_type(mapping["type"]);
  container.mass = mapping["mass"].number(kContainerMass);
  read_container_place(value, mapping, context, container);
  mapping.number("yaw", kAngle, container.yaw);
  mapping.vector<3>("centre_of_gravity", kCentreOfGravity, container.centre_of_gravity);
  mapping.boolean("fixed", container.fixed);
  return container;
}

Eigen::Quaterniond read_orientation(const Value& value) {
  const Mapping mapping = value.mapping({"rpy", "quaternion"});
  const auto rpy = mapping.find("rpy"), quaternion = mapping.find("quaternion");
  if (rpy.has_value() == quaternion.has_value()) value.refuse("expected exactly one of: rpy, quaternion");
  if (rpy) {
    const Eigen::Vector3d angles = rpy->vector<3>(kAngle) * (M_PI / 180);
    return Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX());
  }
  const Eigen::Vector4d wxyz = quaternion->vector<4>({-1, 1, ""});
  if (std::abs(wxyz.norm() - 1) > kQuaternionNormError) {
    quaternion->refuse(fmt::format("its norm is {:.6g}, expected a unit quaternion [w, x, y, z]", wxyz.norm()));
  }
  return Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized();
}

BodySpec read_body(const Value& value) {
  BodySpec body;
  const Mapping mapping =
      value.mapping({"name", "size", "mass", "position", "orientation", "velocity", "angular_velocity", "fixed"});
  body.name = mapping["name"].name();
  body.size = mapping["size"].vector<3>(kBodyEdge);
  mapping.boolean("fixed", body.fixed);
  if (!body.fixed || mapping.find("mass")) body.mass = mapping["mass"].number(kBodyMass);
  body.position = mapping["position"].vector<3>(kPosition);
  if (const auto orientation = mapping.find("orientation")) body.orientation = read_orientation(*orientation);
  for (const char* key : {"velocity", "angular_velocity"}) {
    const auto motion = mapping.find(key);
    if (motion && body.fixed) motion->refuse("the body is fixed, expected no such key");
  }
  mapping.vector<3>("velocity", kVelocity, body.velocity);
  mapping.vector<3>("angular_velocity", kAngularVelocity, body.angular_velocity);
  return body;
}

void check_name(const Value& value, const std::string& name, std::set<std::string>& taken) {
  if (kReservedNames.count(name))
    value.refuse(fmt::format("the name '{}' is taken by the scene, expected another name", name));
  if (!taken.insert(name).second) value.refuse(fmt::format("duplicate name '{}', expected another name", name));
}

// Every container that stands on another must lead down to one with a position of its own.
void check_stacks(const std::vector<Value>& values, const std::vector<ContainerSpec>& containers) {
  const auto find = [&](const std::string& name) {
    return std::find_if(containers.begin(), containers.end(), [&](const auto& c) { return c.name == name; });
  };
  for (std::size_t i = 0; i < containers.size(); ++i) {
    const auto refuse = [&](const std::string& message) { values[i].child("on_top_of").refuse(message); };
    std::size_t levels = 0;
    for (const ContainerSpec* upper = &containers[i]; upper->on_top_of;) {
      const auto lower = find(*upper->on_top_of);
      if (lower == containers.end()) {
        std::vector<std::string> names;
        for (const auto& container : containers) names.push_back(container.name);
        refuse(fmt::format("no container is called '{}'{}, expected the name of another container", *upper->on_top_of,
                           suggestion(*upper->on_top_of, names)));
      }
      if (lower->on_spreader)
        refuse(fmt::format("'{}' hangs on the spreader, expected a container that stands", lower->name));
      if (++levels > containers.size())
        refuse("the stack stands on itself, expected a lowest container with a position");
      upper = &*lower;
    }
  }
}

// A high cube has the corners of a 40 ft box.
bool fits(const SpreaderSpec& spreader, ContainerType container) {
  if (spreader.twin) return container == ContainerType::iso20;
  return spreader.size == (container == ContainerType::iso40_high_cube ? ContainerType::iso40 : container);
}

// What a spreader picks up stands somewhere, fits, and there is room for it.
void check_picks(const Value& value, const SpreaderSpec& spreader, std::size_t carried,
                 const std::vector<ContainerSpec>& containers) {
  if (spreader.picks_up.empty()) return;
  if (carried > 0) value.refuse("the spreader holds a container already, expected no container 'on: spreader'");
  if (spreader.picks_up.size() > (spreader.twin ? 2 : 1)) value.refuse("expected at most one, or two with size: 2x20ft");
  for (const std::string& name : spreader.picks_up) {
    const auto found =
        std::find_if(containers.begin(), containers.end(), [&](const auto& c) { return c.name == name; });
    if (found == containers.end())
      value.refuse(fmt::format("no container is called '{}', expected the name of a container", name));
    if (!fits(spreader, found->type))
      value.refuse(fmt::format("the spreader does not fit '{}', expected a container of the spreader's size", name));
    if (found->fixed)
      value.refuse(fmt::format("'{}' is part of the ground, expected a container that is not fixed", name));
  }
}

}  // namespace

CraneSpec read_crane(const Value& value) {
  CraneSpec crane;
  const Mapping mapping = value.mapping({"type", "gantry", "trolley", "hoist", "trim", "list", "skew", "sheaves", "ropes", "limits", "travel",
                                         "boom", "telescope", "rotation", "side_shift", "pivots"});
  crane.type = mapping["type"].word({"quayside", "rtg", "reach_stacker", "none"});
  const auto& sections = kSectionsOfMachines.at(crane.type);
  for (const auto& [machine, others] : kSectionsOfMachines) {
    for (const std::string& key : others) {
      const auto part = mapping.find(key.c_str());
      if (!part || sections.count(key)) continue;
      part->refuse(crane.type == "none"
                       ? "there is no crane, expected 'crane.type: " + machine + "' or no such key"
                       : fmt::format("a {} has none, expected one of: {}", crane.type, fmt::join(sections, ", ")));
    }
  }
  if (crane.type == "quayside" || crane.type == "rtg") read_rope_crane(mapping, crane);
  if (crane.type == "reach_stacker") read_reach_stacker(mapping, crane);
  return crane;
}

MafiSpec read_mafi(const Value& value) {
  MafiSpec mafi;
  const Mapping mapping =
      value.mapping({"position", "heading", "size", "deck_height", "deck_mass", "suspension", "guides", "twistlocks",
                     "stuck", "range", "max_speed", "max_acceleration", "max_jerk", "emergency_stop"});
  mafi.position = mapping["position"].vector<2>(kPosition);
  mapping.number("heading", kAngle, mafi.heading);
  if (const auto size = mapping.find("size")) {
    mafi.size = size->choice<ContainerType>(
        {{"20ft", ContainerType::iso20}, {"40ft", ContainerType::iso40}, {"45ft", ContainerType::iso45}});
  }
  mapping.number("deck_height", kDeckHeight, mafi.deck_height);
  mapping.number("deck_mass", kSpreaderMass, mafi.deck_mass);
  if (const auto suspension = mapping.find("suspension")) {
    const Mapping spring = suspension->mapping({"stiffness", "damping_ratio"});
    spring.number("stiffness", kStiffness, mafi.stiffness);
    spring.number("damping_ratio", kDampingRatio, mafi.damping_ratio);
  }
  mapping.boolean("guides", mafi.guides);
  mapping.boolean("twistlocks", mafi.twistlocks);
  if (const auto stuck = mapping.find("stuck")) {
    if (!mafi.twistlocks) stuck->refuse("there are no twistlocks on it, expected 'twistlocks: true' beside it");
    for (const Value& one : stuck->list(4)) {
      mafi.stuck.push_back(one.word({"front_left", "rear_left", "rear_right", "front_right"}));
    }
  }
  read_drive_limits(mapping, mafi.drive);
  return mafi;
}

WindSpec read_wind(const Value& value) {
  WindSpec wind;
  const Mapping mapping = value.mapping({"direction", "drag"});
  wind.direction = mapping["direction"].number(kAngle);
  mapping.number("drag", kDrag, wind.drag);
  return wind;
}

SpreaderSpec read_spreader(const Value& value, const Context& context) {
  if (!context.has_crane)
    value.refuse("there is no crane to carry it, expected 'crane' with its keys, or no 'spreader'");
  SpreaderSpec spreader;
  const Mapping mapping = value.mapping({"size", "skew", "mass", "lock_stiffness", "flippers", "picks_up"});
  // A high cube has the corners of a 40 ft box: there is no spreader of its own. Two of 20 ft fill the place of one of
  // 40 ft.
  spreader.size = mapping["size"].choice<ContainerType>({{"20ft", ContainerType::iso20},
                                                         {"40ft", ContainerType::iso40},
                                                         {"45ft", ContainerType::iso45},
                                                         {"2x20ft", ContainerType::iso40}});
  spreader.twin = mapping["size"].is_scalar("2x20ft");
  if (const auto flippers = mapping.find("flippers"))
    spreader.flippers = flippers->choice<bool>({{"down", true}, {"up", false}});
  if (const auto picks_up = mapping.find("picks_up")) {
    for (const Value& name : picks_up->list(2)) spreader.picks_up.push_back(name.name());
  }
  mapping.number("skew", kSkew, spreader.skew);
  mapping.number("mass", kSpreaderMass, spreader.mass);
  mapping.number("lock_stiffness", kStiffness, spreader.lock_stiffness);
  return spreader;
}

namespace {

int whole(const Value& value, const Range& range) {
  const double number = value.number(range);
  if (number != std::floor(number)) value.expected("a whole number");
  return static_cast<int>(number);
}

StackSpec read_stack(const Value& value) {
  StackSpec stack;
  const Mapping mapping = value.mapping({"name", "type", "mass", "position", "bays", "rows", "tiers", "spacing"});
  stack.name = mapping["name"].name();
  stack.type = read_container_type(mapping["type"]);
  stack.mass = mapping["mass"].number(kContainerMass);
  stack.position = mapping["position"].vector<3>(kPosition);
  stack.bays = whole(mapping["bays"], kBaysAndRows);
  stack.rows = whole(mapping["rows"], kBaysAndRows);
  stack.tiers = whole(mapping["tiers"], kTiers);
  stack.spacing = mapping["spacing"].vector<2>(kSpacing);
  const double count = static_cast<double>(stack.bays) * stack.rows * stack.tiers;
  if (count > kMaxStacked) value.refuse(fmt::format("{:.0f} containers, expected at most {:.0f}", count, kMaxStacked));
  return stack;
}

}  // namespace

void read_loads(const Mapping& root, const Context& context, Case& result) {
  std::set<std::string> names;
  std::vector<Value> containers;
  if (const auto list = root.find("containers")) containers = list->list(kMaxBodies);
  std::size_t carried = 0, on_mafi = 0;
  for (const Value& value : containers) {
    const ContainerSpec container = read_container(value, context);
    check_name(value.child("name"), container.name, names);
    if (container.on_spreader) {
      if (++carried > (result.spreader->twin ? 2 : 1)) {
        value.child("on").refuse(result.spreader->twin
                                     ? "the spreader holds two containers already, expected at most two"
                                     : "the spreader holds another container already, expected at most one");
      }
      if (!fits(*result.spreader, container.type)) {
        value.child("type").refuse("the spreader does not fit, expected a container of the spreader's size");
      }
    }
    if (container.on_mafi && ++on_mafi > 1) {
      value.child("on").refuse("another container stands on the trailer already, expected at most one");
    }
    result.containers.push_back(container);
  }
  check_stacks(containers, result.containers);
  if (result.spreader) check_picks(root["spreader"].child("picks_up"), *result.spreader, carried, result.containers);

  if (const auto stacks = root.find("stacks")) {
    for (const Value& value : stacks->list(kMaxStacks)) {
      result.stacks.push_back(read_stack(value));
      check_name(value.child("name"), result.stacks.back().name, names);
    }
  }
  if (const auto bodies = root.find("bodies")) {
    for (const Value& value : bodies->list(kMaxBodies)) {
      result.bodies.push_back(read_body(value));
      check_name(value.child("name"), result.bodies.back().name, names);
    }
  }
}

}  // namespace quayside::cases
