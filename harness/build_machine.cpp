#include "harness/build_machine.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "crane_models/mafi.h"
#include "crane_models/reach_stacker.h"
#include "crane_models/rope_crane.h"

namespace quayside::harness {
namespace {

using crane_models::Scene;

// The headblock stays this far below the sheaves of the trolley, or there is no room to hang [m].
constexpr double kLeastHoistHeight = 1.0;

// A twistlock turns where its head is within this of the middle of the aperture, in height as well: what an aperture of
// 124 by 63 mm leaves to a head of 104 by 55 mm [m].
constexpr double kTwistlockReach = 0.012;

// Overload is a matter of weight: what shakes for shorter does not count [s].
constexpr double kOverloadDelay = 0.5;

constexpr double kDegree = EIGEN_PI / 180;

// `unit`: 1, or radians per degree.
void override_limits(const cases::DriveSpec& spec, crane_models::DriveLimits& limits, double unit = 1) {
  const auto set = [&](const std::optional<double>& value, double& limit) {
    if (value) limit = *value * unit;
  };
  set(spec.max_speed, limits.max_speed);
  set(spec.max_acceleration, limits.max_acceleration);
  set(spec.max_jerk, limits.max_jerk);
  set(spec.emergency_stop, limits.emergency_stop);
  if (spec.range) {
    limits.lowest = spec.range->x() * unit;
    limits.highest = spec.range->y() * unit;
  }
}

crane_models::Load load_of(const cases::ContainerSpec& container) {
  return {container.name, container.mass, container_size(container.type), container.centre_of_gravity};
}

crane_models::LoadSide load_side(const cases::Case& description, crane_models::LoadSide side) {
  const cases::SpreaderSpec spec = description.spreader.value_or(cases::SpreaderSpec{});
  side.spreader.container = container_size(spec.size);
  side.spreader.twin = spec.twin;
  side.spreader.flippers.down = spec.flippers;
  side.spreader.mass = spec.mass.value_or(side.spreader.mass);
  side.twistlocks.stiffness = spec.lock_stiffness.value_or(side.twistlocks.stiffness);
  for (const cases::ContainerSpec& container : description.containers) {
    if (container.on_spreader) side.loads.push_back(load_of(container));
  }
  return side;
}

void check_hanging(const cases::Case& description, const crane_models::RopeCrane& crane, const Scene& scene) {
  const double hoist_height = crane_models::hanging_height(crane, scene);
  double load_height = 0;
  std::string name = "spreader";
  for (const crane_models::Load& load : crane.load_side.loads) {
    load_height = spreader::container_data(load.size).size.z();
    name = load.name;
  }
  const double below_sheaves = crane.load_side.spreader.sheave_height + load_height;
  if (hoist_height < kLeastHoistHeight) {
    refuse(description, "crane.hoist.rope_length",
           fmt::format("{} m of rope leave {:.3f} m between trolley and headblock, expected at least {} m",
                       crane.rope_length, hoist_height, kLeastHoistHeight));
  }
  const double clearance = crane.trolley_height - hoist_height - below_sheaves;
  if (description.ground && clearance < 0) {
    refuse(description, "crane.hoist.rope_length",
           fmt::format("'{}' would start {:.3f} m deep in the ground, expected ropes of at most about {:.2f} m or a "
                       "higher trolley",
                       name, -clearance, crane.rope_length + clearance));
  }
}

void add_rope_crane(const cases::Case& description, crane_models::RopeCrane crane, Scene& scene) {
  const cases::CraneSpec& spec = description.crane;
  crane.trolley_position = spec.trolley_position;
  crane.trolley_height = spec.trolley_height;
  crane.rope_length = spec.rope_length;
  crane.gantry_position = spec.gantry.position;
  crane.trim_position = spec.trim.position;
  crane.list_position = spec.list.position;
  crane.skew_position = spec.skew.position;
  override_limits(spec.gantry, crane.gantry);
  override_limits(spec.trolley, crane.trolley);
  override_limits(spec.hoist, crane.hoist);
  override_limits(spec.trim, crane.trim);
  override_limits(spec.list, crane.list);
  override_limits(spec.skew, crane.skew);
  crane.trolley_sheaves = spec.trolley_sheaves.value_or(crane.trolley_sheaves);
  crane.spreader_sheaves = spec.spreader_sheaves.value_or(crane.spreader_sheaves);
  crane.rope_stiffness = spec.rope_stiffness.value_or(crane.rope_stiffness);
  crane.rope_damping_time = spec.rope_damping_time.value_or(crane.rope_damping_time);
  crane.load_side = load_side(description, crane.load_side);
  crane.anchor_skew = description.spreader.value_or(cases::SpreaderSpec{}).skew * kDegree;
  check_hanging(description, crane, scene);
  crane_models::add_rope_crane(crane, scene);

  std::vector<int> ropes(scene.ropes.size());
  std::iota(ropes.begin(), ropes.end(), 0);
  if (spec.overload) {
    scene.load_limits.push_back({"overload", ropes, *spec.overload * -scene.gravity.z(), kOverloadDelay});
  }
  if (spec.snag) {
    for (const int rope : ropes) scene.load_limits.push_back({"snag." + scene.ropes[rope].name, {rope}, *spec.snag, 0});
  }
}

void add_reach_stacker(const cases::Case& description, Scene& scene) {
  const cases::CraneSpec& spec = description.crane;
  if (description.spreader && description.spreader->skew != 0) {
    refuse(description, "spreader.skew", "a reach_stacker turns its spreader, expected crane.rotation.position instead");
  }
  crane_models::ReachStacker machine;
  machine.travel_position = spec.travel.position.value_or(machine.travel_position);
  machine.boom_angle = spec.boom.position.value_or(machine.boom_angle / kDegree) * kDegree;
  machine.telescope_length = spec.telescope.position.value_or(machine.telescope_length);
  machine.rotation_angle = spec.rotation.position.value_or(0) * kDegree;
  machine.side_shift_position = spec.side_shift.position.value_or(machine.side_shift_position);
  override_limits(spec.travel, machine.travel);
  override_limits(spec.boom, machine.boom, kDegree);
  override_limits(spec.telescope, machine.telescope);
  override_limits(spec.rotation, machine.rotation, kDegree);
  override_limits(spec.side_shift, machine.side_shift);
  machine.pivot_damping = spec.pivot_damping.value_or(machine.pivot_damping);
  machine.load_side.spreader.mass = 6.5e3;  // with the rotator's lower half; no headblock
  machine.load_side = load_side(description, machine.load_side);
  crane_models::add_reach_stacker(machine, scene);
}

// The one place where machines are known by their words.
struct Machine {
  const char* type;
  void (*add)(const cases::Case& description, Scene& scene);
};
const Machine kMachines[] = {
    {"quayside", [](const cases::Case& d, Scene& scene) { add_rope_crane(d, crane_models::quayside_crane(), scene); }},
    {"rtg", [](const cases::Case& d, Scene& scene) { add_rope_crane(d, crane_models::rubber_tyred_gantry(), scene); }},
    {"reach_stacker", add_reach_stacker},
};

// Drives from `first` on stand between their limit switches.
void check_starts(const cases::Case& description, const std::string& section, const Scene& scene, std::size_t first) {
  for (std::size_t i = first; i < scene.drives.size(); ++i) {
    const crane_models::Drive& drive = scene.drives[i];
    if (drive.lowest <= drive.start && drive.start <= drive.highest) continue;
    const double unit = drive.unit == "rad" ? kDegree : 1;
    refuse(description, section,
           fmt::format("the drive '{}' starts at {:.6g} {}, expected within its range, {:.6g} to {:.6g}", drive.name,
                       drive.start / unit, drive.unit == "rad" ? "degrees" : drive.unit, drive.lowest / unit,
                       drive.highest / unit));
  }
}

void require_gravity(const cases::Case& description, const Scene& scene, const char* what) {
  const Eigen::Vector3d& g = scene.gravity;
  if (g.x() == 0 && g.y() == 0 && g.z() < 0) return;
  refuse(description, "gravity",
         fmt::format("[{}, {}, {}] does not {}, expected [0, 0, g] with g < 0", g.x(), g.y(), g.z(), what));
}

}  // namespace

void refuse(const cases::Case& description, const std::string& key, const std::string& message) {
  throw cases::CaseError(fmt::format("{}: {}: {}", description.file.string(), key, message));
}

spreader::ContainerSize container_size(cases::ContainerType type) {
  switch (type) {
    case cases::ContainerType::iso20: return spreader::ContainerSize::iso20;
    case cases::ContainerType::iso40: return spreader::ContainerSize::iso40;
    case cases::ContainerType::iso40_high_cube: return spreader::ContainerSize::iso40_high_cube;
    case cases::ContainerType::iso45: break;
  }
  return spreader::ContainerSize::iso45;
}

void add_crane(const cases::Case& description, Scene& scene) {
  for (const Machine& machine : kMachines) {
    if (description.crane.type != machine.type) continue;
    require_gravity(description, scene, "hang a load on a crane");
    const std::size_t first = scene.drives.size();
    machine.add(description, scene);
    check_starts(description, "crane", scene, first);
  }
}

void add_mafi(const cases::Case& description, Scene& scene) {
  if (!description.mafi) return;
  require_gravity(description, scene, "hold a load on a trailer");
  const cases::MafiSpec& spec = *description.mafi;
  crane_models::Mafi mafi;
  mafi.position = spec.position;
  mafi.heading = spec.heading * kDegree;
  override_limits(spec.drive, mafi.drive);
  mafi.size = container_size(spec.size);
  mafi.deck_height = spec.deck_height.value_or(mafi.deck_height);
  mafi.deck_mass = spec.deck_mass.value_or(mafi.deck_mass);
  mafi.suspension_stiffness = spec.stiffness.value_or(mafi.suspension_stiffness);
  mafi.suspension_damping_ratio = spec.damping_ratio.value_or(mafi.suspension_damping_ratio);
  mafi.guides = spec.guides;
  mafi.twistlocks = spec.twistlocks;
  constexpr const char* kCorners[] = {"front_left", "rear_left", "rear_right", "front_right"};  // as Mafi::stuck
  for (std::size_t i = 0; i < mafi.stuck.size(); ++i) {
    mafi.stuck[i] = std::count(spec.stuck.begin(), spec.stuck.end(), kCorners[i]) > 0;
  }
  for (const cases::ContainerSpec& container : description.containers) {
    if (container.on_mafi) mafi.load = load_of(container);
  }
  if (mafi.twistlocks && !mafi.load) {
    refuse(description, "mafi.twistlocks",
           "there is nothing on the trailer that they could hold, expected a container 'on: mafi'");
  }
  const std::size_t first = scene.drives.size();
  crane_models::add_mafi(mafi, scene);
  check_starts(description, "mafi", scene, first);
}

void add_pick_ups(const cases::Case& description, Scene& scene) {
  if (!description.spreader) return;
  const auto index_of = [&](const std::string& name) {
    const auto found = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                    [&](const auto& body) { return body.name == name; });
    return static_cast<int>(found - scene.bodies.begin());
  };
  const crane_models::LoadSide side = load_side(description, {});
  int place = 0;
  for (const std::string& name : description.spreader->picks_up) {
    const auto container = std::find_if(description.containers.begin(), description.containers.end(),
                                        [&](const auto& spec) { return spec.name == name; });
    crane_models::aim_at(side, index_of("spreader"), index_of(name), load_of(*container), place++, scene);
  }
  for (auto& lock : scene.locks) {
    if (lock.name.rfind("twistlocks", 0) == 0) lock.reach = kTwistlockReach;
  }
}

}  // namespace quayside::harness
