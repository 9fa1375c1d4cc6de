#include "crane_models/load_side.h"

#include <algorithm>
#include <cassert>

#include "crane_models/load_bodies.h"

namespace quayside::crane_models {
namespace {

using Eigen::Vector3d;

template <typename T>
int add(std::vector<T>& items, T item) {
  items.push_back(std::move(item));
  return static_cast<int>(items.size()) - 1;
}

int twistlock_command(Scene& scene, bool start) {
  for (std::size_t i = 0; i < scene.commands.size(); ++i) {
    if (scene.commands[i].name == "twistlocks") return static_cast<int>(i);
  }
  return add(scene.commands, {"twistlocks", "true: closed, false: open", start});
}

// Pins in S and in the load's frame, without the bodies.
spreader::Lock lock_at(const LoadSide& side, const Load& load, int place) {
  const Vector3d p_BT = -container_bottom(load.size).translation();
  spreader::Lock lock = spreader::twistlock_lock(side.twistlocks, load.size, load.mass, p_BT);
  for (spreader::Lock::Pin& pin : lock.pins) pin.p_A.x() += side.spreader.place(place);
  if (side.spreader.twin) lock.name += place == 0 ? "_left" : "_right";
  return lock;
}

}  // namespace

double LoadSide::mass() const {
  double mass = spreader.mass;
  for (const Load& load : loads) mass += load.mass;
  return mass;
}

Body spreader_body(const LoadSide& side) {
  Body body;
  body.name = "spreader";
  set_mass_properties(body, spreader::mass_properties(side.spreader));
  for (const spreader::Plate& plate : spreader::plates(side.spreader)) {
    Pose X_SG = Pose::Identity();
    X_SG.translation() = plate.centre;
    body.boxes.push_back({plate.size / 2, X_SG, body.name});
  }
  return body;
}

void hang_loads(const LoadSide& side, int spreader_body, Scene& scene) {
  assert(side.loads.size() <= (side.spreader.twin ? 2u : 1u));
  const double g = -scene.gravity.z();
  scene.frames.push_back({"spreader", spreader_body, Pose::Identity()});

  LandedSwitch landed{"landed", {spreader_body}, 0.5 * g * side.spreader.mass};
  double load_mass = 0;
  for (std::size_t i = 0; i < side.loads.size(); ++i) {
    const Load& load = side.loads[i];
    const int place = static_cast<int>(i);
    spreader::Lock lock = lock_at(side, load, place);
    Body body = container_body(load.name, load.size, load.mass, load.centre_of_gravity);
    const double p_BT = -container_bottom(load.size).translation().z();
    body.X_WB = scene.bodies[spreader_body].X_WB *
                Eigen::Translation3d(side.spreader.place(place), 0,
                                     -spreader::hanging_stretch(lock, g * load.mass) - p_BT);
    const int carried = add(scene.bodies, std::move(body));
    lock.body_a = spreader_body;
    lock.body_b = carried;
    lock.command = twistlock_command(scene, true);
    scene.locks.push_back(std::move(lock));
    scene.frames.push_back({load.name, carried, container_bottom(load.size)});
    landed.bodies.push_back(carried);
    load_mass += load.mass;
  }
  if (load_mass > 0) landed.threshold = 0.5 * g * load_mass;
  scene.landed_switches.push_back(std::move(landed));
}

void aim_at(const LoadSide& side, int spreader_body, int container_body, const Load& container, int place,
            Scene& scene) {
  spreader::Lock lock = lock_at(side, container, place);
  lock.body_a = spreader_body;
  lock.body_b = container_body;
  lock.closed = false;
  lock.command = twistlock_command(scene, false);
  scene.locks.push_back(std::move(lock));
}

}  // namespace quayside::crane_models
