#include "crane_models/reach_stacker.h"

#include <cassert>
#include <cmath>

#include "crane_models/load_bodies.h"

namespace quayside::crane_models {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr int kX = 0, kY = 1, kZ = 2;

// Moved by its drive, so that neither has an influence on any motion [kg, m].
constexpr double kTruckMass = 60e3;
const Vector3d kTruckSize{4.2, 8, 2};
// Outlines that give the moving parts their inertia [m].
const Vector3d kBoomSize{0.9, 8, 0.9}, kInnerBoomSize{0.7, 6, 0.7}, kHeadSize{1.5, 1.5, 0.5};
constexpr double kInnerBoomBehindTip = 3;  // its middle [m]

// A uniform box about p_BG, its frame B where its joint is.
Body part(const std::string& name, double mass, const Vector3d& size, const Vector3d& p_BG, const Joint& joint,
          const Pose& X_WB) {
  Body body;
  body.name = name;
  Pose X_BG = Pose::Identity();
  X_BG.translation() = p_BG;
  set_mass_properties(body, spreader::moved(spreader::uniform_box(mass, size), X_BG));
  body.joint = joint;
  body.X_WB = X_WB;
  return body;
}

}  // namespace

Vector3d ReachStacker::tip() const {
  const double length = boom_length + telescope_length;
  return {0, travel_position + boom_hinge.x() + length * std::cos(boom_angle),
          boom_hinge.y() + length * std::sin(boom_angle)};
}

int add_reach_stacker(const ReachStacker& m, Scene& scene) {
  assert(scene.gravity.x() == 0 && scene.gravity.y() == 0 && scene.gravity.z() < 0);
  const auto add = [&](Body body) {
    scene.bodies.push_back(std::move(body));
    return static_cast<int>(scene.bodies.size()) - 1;
  };
  const int travel =
      add_drive(scene, "travel", "m", "position of the front axle along y", m.travel_position, 1, m.travel);
  const int boom_drive =
      add_drive(scene, "boom", "rad", "angle of the boom above the horizontal", m.boom_angle, 1, m.boom);
  const int telescope =
      add_drive(scene, "telescope", "m", "length by which the boom is pushed out", m.telescope_length, 1, m.telescope);
  const int rotation =
      add_drive(scene, "rotation", "rad", "angle of the spreader about the vertical", m.rotation_angle, 1, m.rotation);
  const int side_shift = add_drive(scene, "side_shift", "m", "position of the spreader along its length",
                                   m.side_shift_position, 1, m.side_shift);

  Pose X_WB = Pose::Identity();
  X_WB.translation().y() = m.travel_position;
  const Joint wheels = slider_along(kY, kWorld, {0, 0, 0}, travel);
  const int truck = add(part("truck", kTruckMass, kTruckSize, {0, -3, 1.5}, wheels, X_WB));

  const Vector3d hinge(0, m.boom_hinge.x(), m.boom_hinge.y());
  X_WB = X_WB * Eigen::Translation3d(hinge) * AngleAxisd(m.boom_angle, Vector3d::UnitX());
  const int boom = add(part("boom", m.boom_mass, kBoomSize, {0, m.boom_length / 2, 0},
                            hinge_about(kX, truck, hinge, boom_drive), X_WB));
  // The origin of the inner boom is the tip.
  X_WB = X_WB * Eigen::Translation3d(0, m.boom_length + m.telescope_length, 0);
  const int inner = add(part("inner_boom", m.inner_boom_mass, kInnerBoomSize, {0, -kInnerBoomBehindTip, 0},
                             slider_along(kY, boom, {0, m.boom_length, 0}, telescope), X_WB));
  scene.frames.push_back({"boom_tip", inner, Pose::Identity()});

  // From here on everything hangs: axes as the world's.
  const auto at = [&](const Vector3d& p_WB) {
    Pose X = Pose::Identity();
    X.translation() = p_WB;
    return X;
  };
  const Vector3d tip = m.tip(), lower_pivot = tip - Vector3d(0, 0, m.pivot_drop);
  Joint pivot = hinge_about(kX, inner, {0, 0, 0}, -1);
  pivot.damping = m.pivot_damping;
  const int link = add(part("link", 0.1 * m.head_mass, kHeadSize, {0, 0, -m.pivot_drop / 2}, pivot, at(tip)));
  pivot = hinge_about(kY, link, {0, 0, -m.pivot_drop}, -1);
  pivot.damping = m.pivot_damping;
  const int head = add(part("head", 0.4 * m.head_mass, kHeadSize, {0, 0, -0.25}, pivot, at(lower_pivot)));
  const Pose X_WR = at(lower_pivot) * AngleAxisd(m.rotation_angle, Vector3d::UnitZ());
  const int rotator =
      add(part("rotator", 0.5 * m.head_mass, kHeadSize, {0, 0, -0.5}, hinge_about(kZ, head, {0, 0, 0}, rotation), X_WR));

  Body spreader = spreader_body(m.load_side);
  spreader.joint = slider_along(kX, rotator, {0, 0, -m.spreader_drop}, side_shift);
  spreader.X_WB = X_WR * Eigen::Translation3d(m.side_shift_position, 0, -m.spreader_drop);
  const int index = add(std::move(spreader));
  hang_loads(m.load_side, index, scene);
  return index;
}

}  // namespace quayside::crane_models
