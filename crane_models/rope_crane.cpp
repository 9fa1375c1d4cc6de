#include "crane_models/rope_crane.h"

#include <cassert>

#include "crane_models/load_bodies.h"
#include "spreader/reeving.h"

namespace quayside::crane_models {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

// Moved by drives, so that neither mass nor size has an influence on any motion [kg, m].
constexpr double kTrolleyMass = 25e3;
const Vector3d kTrolleySize{8, 6, 1.5};
constexpr double kGantryMass = 200e3;
const Vector3d kGantrySize{15, 25, 25};

constexpr int kAlongQuay = 0, kAlongBoom = 1;

Pose at_height(double z) {
  Pose X = Pose::Identity();
  X.translation().z() = z;
  return X;
}

int add_body(Scene& scene, Body body) {
  scene.bodies.push_back(std::move(body));
  return static_cast<int>(scene.bodies.size()) - 1;
}

Body driven_body(const char* name, double mass, const Vector3d& size, const Joint& joint, const Vector3d& p_WB) {
  Body body;
  body.name = name;
  set_mass_properties(body, spreader::uniform_box(mass, size));
  body.joint = joint;
  body.X_WB.translation() = p_WB;
  return body;
}

// A drive of which each rope has half, one way or the other; `side` says which for the rope at a corner (±1, ±1).
struct Difference {
  int drive;
  double (*side)(double x, double y);
};

std::vector<Difference> add_differences(const RopeCrane& crane, Scene& scene) {
  std::vector<Difference> differences;
  const auto add = [&](const char* name, const char* meaning, const std::optional<double>& position,
                       const DriveLimits& limits, double (*side)(double, double)) {
    if (position) differences.push_back({add_drive(scene, name, "m", meaning, *position, 1, limits), side});
  };
  add("trim", "by how much the ropes at the +x end are longer", crane.trim_position, crane.trim,
      [](double x, double) { return x; });
  add("list", "by how much the ropes on the +y side are longer", crane.list_position, crane.list,
      [](double, double y) { return y; });
  add("skew", "by how much the ropes at +x+y and -x-y are longer", crane.skew_position, crane.skew,
      [](double x, double y) { return x * y; });
  return differences;
}

}  // namespace

double hanging_height(const RopeCrane& crane, const Scene& scene) {
  return spreader::hanging_height(crane.trolley_sheaves, crane.spreader_sheaves, crane.rope_stiffness,
                                  crane.rope_length, -scene.gravity.z() * crane.load_side.mass());
}

int add_rope_crane(const RopeCrane& crane, Scene& scene) {
  assert(scene.gravity.x() == 0 && scene.gravity.y() == 0 && scene.gravity.z() < 0);
  int gantry = kWorld;
  if (crane.gantry_position) {
    const int drive = add_drive(scene, "gantry", "m", "position of the crane along the quay", *crane.gantry_position, 1,
                                crane.gantry);
    gantry = add_body(scene, driven_body("gantry", kGantryMass, kGantrySize,
                                         slider_along(kAlongQuay, kWorld, Vector3d::Zero(), drive),
                                         {*crane.gantry_position, 0, 0}));
  }
  const int trolley_drive = add_drive(scene, "trolley", "m", "position of the trolley along the boom",
                                      crane.trolley_position, 1, crane.trolley);
  const int hoist_drive = add_drive(scene, "hoist", "m", "rest length of the hoist ropes; a positive speed lifts",
                                    crane.rope_length, -1, crane.hoist);
  const std::vector<Difference> differences = add_differences(crane, scene);
  const int trolley =
      add_body(scene, driven_body("trolley", kTrolleyMass, kTrolleySize,
                                  slider_along(kAlongBoom, gantry, {0, 0, crane.trolley_height}, trolley_drive),
                                  {crane.gantry_position.value_or(0), crane.trolley_position, crane.trolley_height}));
  scene.frames.push_back({"trolley", trolley, Pose::Identity()});

  Body hanging = spreader_body(crane.load_side);
  const double sheave_height = crane.load_side.spreader.sheave_height;
  hanging.X_WB = scene.bodies[trolley].X_WB * at_height(-hanging_height(crane, scene)) *
                 AngleAxisd(crane.anchor_skew, Vector3d::UnitZ()) * at_height(-sheave_height);
  const int spreader = add_body(scene, std::move(hanging));

  spreader::Rope rope;
  rope.axial_stiffness = crane.rope_stiffness;
  rope.damping_time = crane.rope_damping_time;
  for (spreader::Rope& reeved : spreader::reeve({trolley, Vector3d::Zero(), crane.anchor_skew, crane.trolley_sheaves},
                                                {spreader, {0, 0, sheave_height}, 0, crane.spreader_sheaves}, rope)) {
    const Vector3d& corner = reeved.lower.p_B;
    reeved.drives = {{hoist_drive}};
    for (const Difference& difference : differences) {
      reeved.drives.push_back({difference.drive, 0.5 * difference.side(corner.x() > 0 ? 1 : -1, corner.y() > 0 ? 1 : -1)});
    }
    scene.ropes.push_back(std::move(reeved));
  }
  hang_loads(crane.load_side, spreader, scene);
  return spreader;
}

}  // namespace quayside::crane_models
