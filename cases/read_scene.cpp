#include "cases/sections.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

namespace quayside::cases {
namespace {

using namespace limits;

// Parts of the scene and of signal names that a container or body cannot be called after.
const std::set<std::string> kReservedNames{"boom",      "contact", "crane",   "energy",     "ground",
                                           "headblock", "hoist",   "landed",  "locks",      "rope",
                                           "spreader",  "time",    "trolley", "twistlocks", "world"};

ContainerType read_container_type(const Value& value) {
  return value.choice<ContainerType>({{"20ft", ContainerType::iso20},
                                      {"40ft", ContainerType::iso40},
                                      {"40ft_hc", ContainerType::iso40_high_cube},
                                      {"45ft", ContainerType::iso45}});
}

void read_drive_limits(const Mapping& mapping, DriveSpec& drive) {
  mapping.number("max_speed", kMaxSpeed, drive.max_speed);
  mapping.number("max_acceleration", kMaxAcceleration, drive.max_acceleration);
}

// Exactly one of on (the spreader), on_top_of and position says where a container is.
void read_container_place(const Value& value, const Mapping& mapping, const Context& context,
                          ContainerSpec& container) {
  const auto on = mapping.find("on"), on_top_of = mapping.find("on_top_of"), position = mapping.find("position");
  if (on.has_value() + on_top_of.has_value() + position.has_value() != 1) {
    value.refuse("its place is not clear, expected exactly one of: on, on_top_of, position");
  }
  if (on) {
    container.on_spreader = on->choice<bool>({{"spreader", true}});
    if (!context.has_crane)
      on->refuse("there is no crane with a spreader, expected 'crane' and 'spreader', or a position");
    for (const char* key : {"yaw", "fixed"}) {
      if (const auto other = mapping.find(key))
        other->refuse("it hangs on the spreader, expected no such key with 'on'");
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
bool fits(ContainerType spreader, ContainerType container) {
  return spreader == (container == ContainerType::iso40_high_cube ? ContainerType::iso40 : container);
}

}  // namespace

CraneSpec read_crane(const Value& value) {
  CraneSpec crane;
  const Mapping mapping = value.mapping({"type", "trolley", "hoist", "sheaves", "ropes"});
  crane.type = mapping["type"].word({"quayside", "none"});
  if (crane.type == "none") {
    for (const char* key : {"trolley", "hoist", "sheaves", "ropes"}) {
      if (const auto part = mapping.find(key))
        part->refuse("there is no crane, expected 'crane.type: quayside' or no such key");
    }
    return crane;
  }

  const Mapping trolley = mapping["trolley"].mapping({"position", "height", "max_speed", "max_acceleration"});
  crane.trolley_position = trolley["position"].number(kTrolleyPosition);
  crane.trolley_height = trolley["height"].number(kTrolleyHeight);
  read_drive_limits(trolley, crane.trolley);

  const Mapping hoist = mapping["hoist"].mapping({"rope_length", "max_speed", "max_acceleration"});
  crane.rope_length = hoist["rope_length"].number(kRopeLength);
  read_drive_limits(hoist, crane.hoist);

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
  return crane;
}

SpreaderSpec read_spreader(const Value& value, const Context& context) {
  if (!context.has_crane)
    value.refuse("there is no crane to carry it, expected 'crane' with its keys, or no 'spreader'");
  SpreaderSpec spreader;
  const Mapping mapping = value.mapping({"size", "skew", "mass", "lock_stiffness"});
  // A high cube has the corners of a 40 ft box: there is no spreader of its own.
  spreader.size = mapping["size"].choice<ContainerType>(
      {{"20ft", ContainerType::iso20}, {"40ft", ContainerType::iso40}, {"45ft", ContainerType::iso45}});
  mapping.number("skew", kSkew, spreader.skew);
  mapping.number("mass", kSpreaderMass, spreader.mass);
  mapping.number("lock_stiffness", kStiffness, spreader.lock_stiffness);
  return spreader;
}

void read_loads(const Mapping& root, const Context& context, Case& result) {
  std::set<std::string> names;
  std::vector<Value> containers;
  if (const auto list = root.find("containers")) containers = list->list(kMaxBodies);
  const Value* carried = nullptr;
  for (const Value& value : containers) {
    const ContainerSpec container = read_container(value, context);
    check_name(value.child("name"), container.name, names);
    if (container.on_spreader) {
      if (carried) value.child("on").refuse("the spreader holds another container already, expected at most one");
      carried = &value;
      if (!fits(result.spreader->size, container.type)) {
        value.child("type").refuse("the spreader does not fit, expected a container of the spreader's size");
      }
    }
    result.containers.push_back(container);
  }
  check_stacks(containers, result.containers);

  if (const auto bodies = root.find("bodies")) {
    for (const Value& value : bodies->list(kMaxBodies)) {
      result.bodies.push_back(read_body(value));
      check_name(value.child("name"), result.bodies.back().name, names);
    }
  }
}

}  // namespace quayside::cases
