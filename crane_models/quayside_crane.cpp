#include "crane_models/quayside_crane.h"

#include <cassert>

#include "crane_models/load_bodies.h"
#include "spreader/reeving.h"

namespace quayside::crane_models {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

// A trolley with its machinery [kg, m]. It is moved by its drive, so that neither has an influence on any motion.
constexpr double kTrolleyMass = 25e3;
const Vector3d kTrolleySize{8, 6, 1.5};

Pose at_height(double z) {
  Pose X = Pose::Identity();
  X.translation().z() = z;
  return X;
}

// On rails along the world's y: a slider moves along its frame's x.
Body trolley_body(const QuaysideCrane& crane, int drive) {
  Body body;
  body.name = "trolley";
  set_mass_properties(body, spreader::uniform_box(kTrolleyMass, kTrolleySize));
  const AngleAxisd x_to_y(EIGEN_PI / 2, Vector3d::UnitZ());
  body.joint.type = JointType::slider;
  body.joint.drive = drive;
  body.joint.X_PF = at_height(crane.trolley_height) * x_to_y;
  body.joint.X_BM = Pose(x_to_y);
  body.X_WB = Eigen::Translation3d(0, crane.trolley_position, crane.trolley_height) * Pose::Identity();
  return body;
}

Body spreader_body(const spreader::Spreader& spreader) {
  Body body;
  body.name = "spreader";
  set_mass_properties(body, spreader::mass_properties(spreader));
  body.boxes = {{spreader.frame_size() / 2, at_height(spreader.frame_height / 2), body.name}};
  return body;
}

double suspended_mass(const QuaysideCrane& crane) { return crane.spreader.mass + (crane.load ? crane.load->mass : 0); }

template <typename T>
int add(std::vector<T>& items, T item) {
  items.push_back(std::move(item));
  return static_cast<int>(items.size()) - 1;
}

}  // namespace

double hanging_height(const QuaysideCrane& crane, const Scene& scene) {
  return spreader::hanging_height(crane.trolley_sheaves, crane.spreader_sheaves, crane.rope_stiffness,
                                  crane.rope_length, -scene.gravity.z() * suspended_mass(crane));
}

void add_quayside_crane(const QuaysideCrane& crane, Scene& scene) {
  assert(scene.gravity.x() == 0 && scene.gravity.y() == 0 && scene.gravity.z() < 0);
  const double g = -scene.gravity.z();

  const int trolley_drive = add(scene.drives, {"trolley", "m", "position of the trolley along the boom",
                                               crane.trolley_position, 1, crane.trolley.max_speed,
                                               crane.trolley.max_acceleration});
  const int hoist_drive =
      add(scene.drives, {"hoist", "m", "rest length of the hoist ropes; a positive speed lifts", crane.rope_length, -1,
                         crane.hoist.max_speed, crane.hoist.max_acceleration});

  const int trolley = add(scene.bodies, trolley_body(crane, trolley_drive));
  const int spreader = add(scene.bodies, spreader_body(crane.spreader));
  Body& hanging = scene.bodies[spreader];
  hanging.X_WB = scene.bodies[trolley].X_WB * at_height(-hanging_height(crane, scene)) *
                 AngleAxisd(crane.skew, Vector3d::UnitZ()) * at_height(-crane.spreader.sheave_height);
  scene.frames.push_back({"trolley", trolley, Pose::Identity()});
  scene.frames.push_back({"spreader", spreader, Pose::Identity()});

  spreader::Rope rope;
  rope.axial_stiffness = crane.rope_stiffness;
  rope.damping_time = crane.rope_damping_time;
  rope.drive = hoist_drive;
  const Vector3d p_SR(0, 0, crane.spreader.sheave_height);
  for (spreader::Rope& reeved : spreader::reeve({trolley, Vector3d::Zero(), crane.skew, crane.trolley_sheaves},
                                                {spreader, p_SR, 0, crane.spreader_sheaves}, rope)) {
    scene.ropes.push_back(std::move(reeved));
  }

  LandedSwitch landed{"landed", {spreader}, 0.5 * g * crane.spreader.mass};
  if (crane.load) {
    const QuaysideCrane::Load& load = *crane.load;
    const Vector3d p_BT = -container_bottom(load.size).translation();
    spreader::Lock lock = spreader::twistlock_lock(crane.twistlocks, load.size, load.mass, p_BT);
    Body body = container_body(load.name, load.size, load.mass, load.centre_of_gravity);
    body.X_WB = hanging.X_WB * at_height(-spreader::hanging_stretch(lock, g * load.mass) - p_BT.z());
    const int carried = add(scene.bodies, std::move(body));
    lock.body_a = spreader;
    lock.body_b = carried;
    lock.command = add(scene.commands, {"twistlocks", "true: closed, false: open", true});
    scene.locks.push_back(std::move(lock));
    scene.frames.push_back({load.name, carried, container_bottom(load.size)});
    landed = {"landed", {spreader, carried}, 0.5 * g * load.mass};
  }
  scene.landed_switches.push_back(std::move(landed));
}

}  // namespace quayside::crane_models
