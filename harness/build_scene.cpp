#include "harness/build_scene.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "crane_models/load_bodies.h"
#include "crane_models/quayside_crane.h"

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
// No trolley runs farther, from backreach to outreach [m].
constexpr double kLongestTrolleyRun = 120;

// Starts may overlap by this much: a container at rest presses its contact in by about half of it [m].
constexpr double kAllowedOverlap = 1e-3;

// The headblock stays this far below the sheaves of the trolley, or there is no room to hang [m].
constexpr double kLeastHoistHeight = 1.0;

constexpr double kDegree = EIGEN_PI / 180;

[[noreturn]] void refuse(const cases::Case& description, const std::string& key, const std::string& message) {
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

double height(const cases::ContainerSpec& container) {
  return spreader::container_data(container_size(container.type)).size.z();
}

void override_limits(const cases::DriveSpec& spec, crane_models::DriveLimits& limits) {
  limits.max_speed = spec.max_speed.value_or(limits.max_speed);
  limits.max_acceleration = spec.max_acceleration.value_or(limits.max_acceleration);
}

crane_models::QuaysideCrane quayside_crane(const cases::Case& description) {
  const cases::CraneSpec& spec = description.crane;
  const cases::SpreaderSpec spreader = description.spreader.value_or(cases::SpreaderSpec{});
  crane_models::QuaysideCrane crane;
  crane.trolley_position = spec.trolley_position;
  crane.trolley_height = spec.trolley_height;
  crane.rope_length = spec.rope_length;
  override_limits(spec.trolley, crane.trolley);
  override_limits(spec.hoist, crane.hoist);
  crane.trolley_sheaves = spec.trolley_sheaves.value_or(crane.trolley_sheaves);
  crane.spreader_sheaves = spec.spreader_sheaves.value_or(crane.spreader_sheaves);
  crane.rope_stiffness = spec.rope_stiffness.value_or(crane.rope_stiffness);
  crane.rope_damping_time = spec.rope_damping_time.value_or(crane.rope_damping_time);
  crane.spreader.container = container_size(spreader.size);
  crane.spreader.mass = spreader.mass.value_or(crane.spreader.mass);
  crane.twistlocks.stiffness = spreader.lock_stiffness.value_or(crane.twistlocks.stiffness);
  crane.skew = spreader.skew * kDegree;
  for (const cases::ContainerSpec& container : description.containers) {
    if (container.on_spreader) {
      crane.load = {container.name, container.mass, container_size(container.type), container.centre_of_gravity};
    }
  }
  return crane;
}

void check_hanging(const cases::Case& description, const crane_models::QuaysideCrane& crane, const Scene& scene) {
  const double hoist_height = crane_models::hanging_height(crane, scene);
  const double load_height = crane.load ? spreader::container_data(crane.load->size).size.z() : 0;
  const double below_sheaves = crane.spreader.sheave_height + load_height;
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
                       crane.load ? crane.load->name : "spreader", -clearance, crane.rope_length + clearance));
  }
}

void add_crane(const cases::Case& description, Scene& scene) {
  const Vector3d& g = scene.gravity;
  if (g.x() != 0 || g.y() != 0 || g.z() >= 0) {
    refuse(description, "gravity",
           fmt::format("[{}, {}, {}] does not hang a load on a crane, expected [0, 0, g] with g < 0", g.x(), g.y(),
                       g.z()));
  }
  const crane_models::QuaysideCrane crane = quayside_crane(description);
  check_hanging(description, crane, scene);
  crane_models::add_quayside_crane(crane, scene);
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
    if (container.on_spreader) continue;  // came with the crane
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

double horizontal(const Vector3d& v) { return v.head<2>().norm(); }

// How far the scene may spread from where its boxes are now: with the speeds at the start and what gravity adds on a
// slope, or with the trolley [m].
double reach(const cases::Case& description, const Scene& scene) {
  const double duration = description.duration;
  double speed = 0, trolley_run = 0;
  for (const Body& body : scene.bodies) speed = std::max(speed, horizontal(body.v_WB));
  for (const auto& drive : scene.drives) {
    if (drive.name == "trolley") trolley_run = std::min(kLongestTrolleyRun, duration * drive.max_speed);
  }
  return trolley_run + duration * (speed + 0.5 * duration * horizontal(scene.gravity));
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

// All boxes of different bodies. Those of two static bodies have nothing to push.
void add_pairs(Scene& scene) {
  const int count = static_cast<int>(scene.bodies.size());
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      if (scene.bodies[a].is_static() && scene.bodies[b].is_static()) continue;
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

crane_models::Scene build_scene(const cases::Case& description) {
  Scene scene;
  scene.title = description.title;
  scene.gravity = description.gravity;
  if (description.crane.type == "quayside") add_crane(description, scene);
  add_containers(description, scene);
  add_plain_bodies(description, scene);
  if (description.ground) add_ground(description, scene);
  add_pairs(scene);
  if (!description.allow_overlap) check_overlaps(description, scene);
  crane_models::check(scene);
  return scene;
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
  settings.transition_speed = spec.transition_speed;
  settings.network = spec.network;
  return settings;
}

SolverSettings solver_settings(const cases::SolverSpec& spec) {
  return {spec.relative_tolerance, spec.max_step, spec.mujoco_step, spec.integrator, spec.mujoco_integrator};
}

SolverSettings solver_settings(const cases::Case& description) {
  SolverSettings settings = solver_settings(description.solver);
  settings.sampled_contact = description.sampled_contact;
  return settings;
}

}  // namespace quayside::harness
