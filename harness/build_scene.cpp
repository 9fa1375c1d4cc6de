#include "harness/build_scene.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "crane_models/drives.h"
#include "crane_models/load_bodies.h"
#include "crane_models/reach.h"
#include "harness/build_machine.h"
#include "harness/script_use.h"

namespace quayside::harness {
namespace {

using crane_models::Body;
using crane_models::Pose;
using crane_models::Scene;
using Eigen::Vector3d;

// The ground is a slab with its top at z = 0. Half of its height is far more than any contact presses in.
constexpr double kGroundHalfHeight = 1.5;  // [m]
// Ground beyond all that stands or may get there, so that nothing meets its rim [m].
constexpr double kGroundMargin = 30;
// Nothing that is driven runs farther: a trolley from backreach to outreach, a machine within its block [m].
constexpr double kLongestRun = 120;

// Starts may overlap by this much: a container at rest presses its contact in by about half of it [m].
constexpr double kAllowedOverlap = 1e-3;

constexpr double kDegree = EIGEN_PI / 180;

double height(const cases::ContainerSpec& container) {
  return spreader::container_data(container_size(container.type)).size.z();
}

// Where the centres of the bottoms stand: on the world's floor, or on one another.
class ContainerPlaces {
 public:
  explicit ContainerPlaces(const cases::Case& description) {
    for (const auto& container : description.containers) specs_[container.name] = &container;
  }

  Pose bottom(const cases::ContainerSpec& container) const {
    Pose X_WR = Pose::Identity();
    if (container.on_top_of) {
      const cases::ContainerSpec& lower = *specs_.at(*container.on_top_of);
      X_WR = bottom(lower) * Eigen::Translation3d(container.offset.x(), container.offset.y(), height(lower));
    } else {
      X_WR.translation() = container.position;
    }
    return X_WR * Eigen::AngleAxisd(container.yaw * kDegree, Vector3d::UnitZ());
  }

 private:
  std::map<std::string, const cases::ContainerSpec*> specs_;
};

void add_body(Body body, bool fixed, const Pose& X_BR, Scene& scene) {
  if (fixed) crane_models::fix_to_world(body);
  scene.frames.push_back({body.name, static_cast<int>(scene.bodies.size()), X_BR});
  scene.bodies.push_back(std::move(body));
}

void add_containers(const cases::Case& description, Scene& scene) {
  const ContainerPlaces places(description);
  for (const cases::ContainerSpec& container : description.containers) {
    const spreader::ContainerSize size = container_size(container.type);
    const Vector3d half = spreader::container_data(size).size / 2;
    if ((container.centre_of_gravity.cwiseAbs().array() >= half.array()).any()) {
      refuse(description, fmt::format("containers.{}.centre_of_gravity", container.name),
             fmt::format("lies outside the box, expected within ±[{}, {}, {}] m of its centre", half.x(), half.y(),
                         half.z()));
    }
    if (container.on_spreader || container.on_mafi) continue;  // came with the machine
    const Pose X_BR = crane_models::container_bottom(size);
    Body body = crane_models::container_body(container.name, size, container.mass, container.centre_of_gravity);
    body.X_WB = places.bottom(container) * X_BR.inverse();
    add_body(std::move(body), container.fixed, X_BR, scene);
  }
}

void add_plain_bodies(const cases::Case& description, Scene& scene) {
  for (const cases::BodySpec& spec : description.bodies) {
    Body body = crane_models::box_body(spec.name, spec.size, spec.mass);
    body.X_WB = Eigen::Translation3d(spec.position) * spec.orientation.normalized();
    body.v_WB = spec.velocity;
    body.w_WB = spec.angular_velocity;
    add_body(std::move(body), spec.fixed, Pose::Identity(), scene);
  }
}

// The place of one stack of a block, from above.
crane_models::GroundPlan stack_place(const cases::StackSpec& spec, int bay, int row) {
  const Eigen::Vector2d half = spreader::container_data(container_size(spec.type)).size.head<2>() / 2;
  const Eigen::Vector2d centre = spec.position.head<2>() + Eigen::Vector2d(bay * spec.spacing.x(), row * spec.spacing.y());
  return {centre - half, centre + half};
}

void check_spacing(const cases::Case& description, const cases::StackSpec& spec) {
  const Eigen::Vector2d size = spreader::container_data(container_size(spec.type)).size.head<2>();
  const Eigen::Vector2d gap = spec.spacing - size;
  if ((spec.bays > 1 && gap.x() < 0) || (spec.rows > 1 && gap.y() < 0)) {
    refuse(description, fmt::format("stacks.{}.spacing", spec.name),
           fmt::format("[{}, {}] is closer than its boxes are large, expected at least [{}, {}] m", spec.spacing.x(),
                       spec.spacing.y(), size.x(), size.y()));
  }
}

// The stacks of a block, bay by bay; `wanted` says which of them.
void add_stacks(const cases::StackSpec& spec, const std::vector<bool>& wanted, Scene& scene) {
  const spreader::ContainerSize size = container_size(spec.type);
  const double height = spreader::container_data(size).size.z();
  const Pose X_BR = crane_models::container_bottom(size);
  for (int bay = 0; bay < spec.bays; ++bay) {
    for (int row = 0; row < spec.rows; ++row) {
      if (!wanted[bay * spec.rows + row]) continue;
      for (int tier = 0; tier < spec.tiers; ++tier) {
        const std::string name = fmt::format("{}_{}_{}_{}", spec.name, bay + 1, row + 1, tier + 1);
        Body body = crane_models::container_body(name, size, spec.mass, Vector3d::Zero());
        const Vector3d offset(bay * spec.spacing.x(), row * spec.spacing.y(), tier * height);
        body.X_WB = Eigen::Translation3d(spec.position + offset) * X_BR.inverse();
        add_body(std::move(body), false, X_BR, scene);
      }
    }
  }
}

// All stacks, or only those that may be touched by what the scene holds so far.
void add_stacks(const cases::Case& description, LeftOut* left_out, Scene& scene) {
  if (description.stacks.empty()) return;
  std::optional<std::vector<crane_models::GroundPlan>> reach;
  bool sideways = false;
  if (left_out) {
    const crane_models::ScriptUse use = use_of(scene, description);
    reach = crane_models::reach(scene, use);
    sideways = crane_models::moves_sideways(scene, use);
  }
  for (const cases::StackSpec& spec : description.stacks) {
    check_spacing(description, spec);
    std::vector<bool> wanted(spec.bays * spec.rows, true);
    if (reach) {
      std::vector<crane_models::GroundPlan> places;
      for (int bay = 0; bay < spec.bays; ++bay) {
        for (int row = 0; row < spec.rows; ++row) places.push_back(stack_place(spec, bay, row));
      }
      const double height = spec.tiers * spreader::container_data(container_size(spec.type)).size.z();
      wanted = crane_models::touched(places, height, *reach, sideways);
      left_out->containers += spec.tiers * static_cast<int>(std::count(wanted.begin(), wanted.end(), false));
      left_out->reason = sideways ? "nothing that the script moves, nor a stack that it fells, comes near them"
                                  : "the script moves nothing sideways, and what it moves is more than a metre away";
    }
    add_stacks(spec, wanted, scene);
  }
}

// The speed is the script's. Gusts: 50 m/s² is the edge of a squall.
void add_wind(const cases::WindSpec& spec, Scene& scene) {
  constexpr double kAirDensity = 1.25;  // [kg/m³]
  scene.wind.drive = crane_models::add_drive(scene, "wind", "m", "way of the air; its rate is the wind's speed", 0, 1,
                                             {75.0, 50.0});
  scene.drives.back().emergency_stop = 0;
  scene.wind.direction_W = Eigen::AngleAxisd(spec.direction * kDegree, Vector3d::UnitZ()) * Vector3d::UnitX();
  scene.wind.pressure_factor = 0.5 * kAirDensity * spec.drag;
}

double horizontal(const Vector3d& v) { return v.head<2>().norm(); }

// How far the scene may spread from where its boxes are now: with the speeds at the start and what gravity adds on a
// slope, or with a machine [m].
double reach(const cases::Case& description, const Scene& scene) {
  const double duration = description.duration;
  double speed = 0, run = 0;
  for (const Body& body : scene.bodies) {
    speed = std::max(speed, horizontal(body.v_WB));
    if (body.joint.drive < 0 || body.joint.type != crane_models::JointType::slider) continue;
    run += std::min(kLongestRun, duration * scene.drives[body.joint.drive].max_speed);
  }
  return run + duration * (speed + 0.5 * duration * horizontal(scene.gravity));
}

// Added last, so that contacts read "load/ground".
void add_ground(const cases::Case& description, Scene& scene) {
  Eigen::AlignedBox2d extent(Eigen::Vector2d(0, 0));
  for (const Body& body : scene.bodies) {
    for (const auto& box : body.boxes) {
      const Eigen::Vector2d centre = (body.X_WB * box.X_BG.translation()).head<2>();
      extent.extend(centre + Eigen::Vector2d::Constant(box.half.norm()));
      extent.extend(centre - Eigen::Vector2d::Constant(box.half.norm()));
    }
  }
  const double beyond = kGroundMargin + reach(description, scene);
  const Eigen::Vector2d size = extent.sizes() + Eigen::Vector2d::Constant(2 * beyond);
  Body ground = crane_models::box_body("ground", {size.x(), size.y(), 2 * kGroundHalfHeight}, 0);
  ground.X_WB.translation() << extent.center(), -kGroundHalfHeight;
  crane_models::fix_to_world(ground);
  scene.bodies.push_back(std::move(ground));
}

// A deck and its chassis, which its springs keep apart.
bool on_springs(const Scene& scene, int a, int b) {
  return std::any_of(scene.locks.begin(), scene.locks.end(), [&](const spreader::Lock& lock) {
    return lock.elastic && std::minmax(lock.body_a, lock.body_b) == std::minmax(a, b);
  });
}

// Pairs grow with the square of the bodies, and so do memory and time.
void check_amount(const cases::Case& description, const Scene& scene) {
  constexpr std::size_t kMostBodies = 1000;
  if (scene.bodies.size() <= kMostBodies) return;
  refuse(description, "stacks",
         fmt::format("{} bodies that may all meet are too many, expected at most {}: simulate the reduced scene, or bound "
                     "what the script moves", scene.bodies.size(), kMostBodies));
}

// All boxes of different bodies. Those of two static bodies have nothing to push.
void add_pairs(Scene& scene) {
  const int count = static_cast<int>(scene.bodies.size());
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      if (scene.bodies[a].is_static() && scene.bodies[b].is_static()) continue;
      if (on_springs(scene, a, b)) continue;
      for (int i = 0; i < static_cast<int>(scene.bodies[a].boxes.size()); ++i) {
        for (int j = 0; j < static_cast<int>(scene.bodies[b].boxes.size()); ++j) scene.pairs.push_back({a, i, b, j});
      }
    }
  }
}

// How deep two bodies are in one another at the start; negative when apart [m].
double overlap(const Body& a, const Body& b) {
  double deepest = -1;
  for (const auto& box_a : a.boxes) {
    for (const auto& box_b : b.boxes) {
      const Pose X_AB = (a.X_WB * box_a.X_BG).inverse() * (b.X_WB * box_b.X_BG);
      deepest = std::max(deepest, -contact_nn::separation({box_a.half}, {box_b.half}, X_AB));
    }
  }
  return deepest;
}

void check_overlaps(const cases::Case& description, const Scene& scene) {
  for (auto a = scene.bodies.begin(); a != scene.bodies.end(); ++a) {
    for (auto b = a + 1; b != scene.bodies.end(); ++b) {
      const double depth = overlap(*a, *b);
      if (depth > kAllowedOverlap) {
        refuse(description, a->name,
               fmt::format("starts {:.3f} m deep in '{}', expected a place of its own, or allow_overlap: true", depth,
                           b->name));
      }
    }
  }
}

}  // namespace

void LeftOut::add_to(crane_models::ReductionReport& report) const {
  if (containers == 0) return;
  report.entries.insert(report.entries.begin(), {fmt::format("{} containers of stacks left out", containers), reason});
  report.bodies_before += containers;
  report.degrees_of_freedom_before += 6 * containers;
}

namespace {

Scene build(const cases::Case& description, LeftOut* left_out) {
  Scene scene;
  scene.title = description.title;
  scene.gravity = description.gravity;
  add_crane(description, scene);
  add_mafi(description, scene);
  add_containers(description, scene);
  add_pick_ups(description, scene);
  add_plain_bodies(description, scene);
  if (description.wind) add_wind(*description.wind, scene);
  add_stacks(description, left_out, scene);
  if (description.ground) add_ground(description, scene);
  check_amount(description, scene);
  add_pairs(scene);
  if (!description.allow_overlap) check_overlaps(description, scene);
  crane_models::check(scene);
  return scene;
}

}  // namespace

crane_models::Scene build_scene(const cases::Case& description) { return build(description, nullptr); }

crane_models::Scene build_scene(const cases::Case& description, LeftOut& left_out) {
  left_out = {};
  return build(description, &left_out);
}

contact_nn::ContactSettings contact_settings(const cases::ContactSpec& spec) {
  contact_nn::ContactSettings settings;
  settings.model = spec.model == "exact" ? contact_nn::Model::exact : contact_nn::Model::committee;
  settings.law = spec.law == "points"    ? contact_nn::Law::points
                 : spec.law == "pads"    ? contact_nn::Law::pads
                 : spec.law == "learned" ? contact_nn::Law::learned
                                         : contact_nn::Law::potential;
  settings.stiffness = spec.stiffness;
  settings.restitution = spec.restitution;
  settings.reference_speed = spec.reference_speed;
  settings.friction = spec.friction;
  settings.friction_law = spec.friction_law == "bristle" ? contact_nn::Friction::bristle : contact_nn::Friction::regularised;
  settings.transition_speed = spec.transition_speed;
  settings.network = spec.network;
  return settings;
}

SolverSettings solver_settings(const cases::SolverSpec& spec) {
  return {spec.relative_tolerance, spec.max_step, spec.mujoco_step, spec.integrator, spec.mujoco_integrator,
          spec.free_bodies};
}

SolverSettings solver_settings(const cases::Case& description) {
  SolverSettings settings = solver_settings(description.solver);
  settings.sampled_contact = description.sampled_contact;
  return settings;
}

}  // namespace quayside::harness
