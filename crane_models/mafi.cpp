#include "crane_models/mafi.h"

#include <cassert>
#include <cmath>

#include "crane_models/load_bodies.h"

namespace quayside::crane_models {
namespace {

using Eigen::Vector3d;

constexpr int kAlongPath = 0;
constexpr double kSprings = 4;

// Moved by its drive: the mass has no influence on any motion [kg].
constexpr double kTractorMass = 12e3;
// The tractor, ahead of the deck: it is what runs into things [m].
const Vector3d kTractorSize{4.5, 2.5, 3.0};
constexpr double kTractorGap = 0.6;        // between tractor and deck [m]
constexpr double kGroundClearance = 0.3;   // of the tractor [m]

constexpr double kDeckThickness = 0.3;     // [m]
constexpr double kDeckOverhang = 0.15;     // beyond the container on each side, where the guides stand [m]
constexpr double kGuideWidth = 0.4, kGuideThickness = 0.08;  // [m]
// Springs: this part of half length and half width from the middle.
constexpr double kSpringPlace = 0.7;

Pose at(const Vector3d& p) {
  Pose X = Pose::Identity();
  X.translation() = p;
  return X;
}

// The deck's frame: middle of its top, x along the path.
Body deck_body(const Mafi& mafi) {
  const Vector3d& box = spreader::container_data(mafi.size).size;
  const Vector3d size(box.x() + 2 * kDeckOverhang, box.y() + 2 * kDeckOverhang, kDeckThickness);
  Body body;
  body.name = "deck";
  const Pose X_BG = at({0, 0, -kDeckThickness / 2});
  set_mass_properties(body, spreader::moved(spreader::uniform_box(mafi.deck_mass, size), X_BG));
  body.boxes.push_back({size / 2, X_BG, body.name});
  if (!mafi.guides) return body;
  const double out = mafi.guide_clearance + kGuideThickness / 2, z = mafi.guide_height / 2;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      body.boxes.push_back({{kGuideWidth / 2, kGuideThickness / 2, z},
                            at({x * (box.x() - kGuideWidth) / 2, y * (box.y() / 2 + out), z}), "guides"});
      body.boxes.push_back({{kGuideThickness / 2, kGuideWidth / 2, z},
                            at({x * (box.x() / 2 + out), y * (box.y() - kGuideWidth) / 2, z}), "guides"});
    }
  }
  return body;
}

// A spring's pin on the chassis stands higher than that on the deck by what the weight above stretches it.
spreader::Lock suspension(const Mafi& mafi, double weight, double sprung_mass) {
  const Vector3d& box = spreader::container_data(mafi.size).size;
  spreader::Lock lock;
  lock.name = "suspension";
  lock.elastic = true;
  lock.stiffness = mafi.suspension_stiffness;
  lock.damping = 2 * mafi.suspension_damping_ratio * std::sqrt(mafi.suspension_stiffness * sprung_mass / kSprings);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      const Vector3d p_D(x * kSpringPlace * box.x() / 2, y * kSpringPlace * box.y() / 2, -kDeckThickness);
      const Vector3d p_C = p_D + Vector3d(0, 0, mafi.deck_height + weight / (kSprings * mafi.suspension_stiffness));
      lock.pins.push_back({p_C, p_D});
    }
  }
  return lock;
}

// The twistlocks that open, and those that do not.
void add_twistlocks(const Mafi& mafi, int deck, int load, Scene& scene) {
  const Vector3d p_BR = container_bottom(mafi.load->size).translation();
  const spreader::Lock all = spreader::twistlock_lock(mafi.twistlock, mafi.load->size, mafi.load->mass, {0, 0, 0});
  spreader::Lock open = all, stuck = all;
  open.name = "mafi_twistlocks";
  stuck.name = "stuck_twistlock";
  open.pins.clear();
  stuck.pins.clear();
  // Apertures come as +x+y, −x+y, −x−y, +x−y: front left, rear left, rear right, front right.
  for (std::size_t i = 0; i < all.pins.size(); ++i) {
    (mafi.stuck[i] ? stuck : open).pins.push_back({all.pins[i].p_A, p_BR + all.pins[i].p_A});
  }
  scene.commands.push_back({"mafi_twistlocks", "twistlocks on the trailer; true: closed, false: open", true});
  open.command = static_cast<int>(scene.commands.size()) - 1;
  for (spreader::Lock* lock : {&open, &stuck}) {
    if (lock->pins.empty()) continue;
    lock->body_a = deck;
    lock->body_b = load;
    scene.locks.push_back(*lock);
  }
}

}  // namespace

void add_mafi(const Mafi& mafi, Scene& scene) {
  assert(scene.gravity.x() == 0 && scene.gravity.y() == 0 && scene.gravity.z() < 0);
  const auto add = [&](Body body) {
    scene.bodies.push_back(std::move(body));
    return static_cast<int>(scene.bodies.size()) - 1;
  };
  const Vector3d& box = spreader::container_data(mafi.size).size;
  const Pose X_WP = Eigen::Translation3d(mafi.position.x(), mafi.position.y(), 0) *
                    Pose(Eigen::AngleAxisd(mafi.heading, Vector3d::UnitZ()));

  Body tractor;
  tractor.name = "mafi";
  set_mass_properties(tractor, spreader::uniform_box(kTractorMass, kTractorSize));
  tractor.boxes.push_back({kTractorSize / 2,
                           at({box.x() / 2 + kDeckOverhang + kTractorGap + kTractorSize.x() / 2, 0,
                               kGroundClearance + kTractorSize.z() / 2}),
                           tractor.name});
  tractor.joint = slider_along(kAlongPath, kWorld, {0, 0, 0},
                               add_drive(scene, "mafi", "m", "way of the tractor along its path", 0, 1, mafi.drive));
  tractor.joint.X_PF = X_WP * tractor.joint.X_PF;
  tractor.X_WB = X_WP;
  const int chassis = add(std::move(tractor));
  scene.frames.push_back({"mafi", chassis, Pose::Identity()});

  Body deck = deck_body(mafi);
  deck.X_WB = X_WP * at({0, 0, mafi.deck_height});
  const int deck_index = add(std::move(deck));
  scene.frames.push_back({"deck", deck_index, Pose::Identity()});

  const double sprung_mass = mafi.deck_mass + (mafi.load ? mafi.load->mass : 0);
  spreader::Lock springs = suspension(mafi, -scene.gravity.z() * sprung_mass, sprung_mass);
  springs.body_a = chassis;
  springs.body_b = deck_index;
  scene.locks.push_back(std::move(springs));

  if (!mafi.load) return;
  const Load& load = *mafi.load;
  Body body = container_body(load.name, load.size, load.mass, load.centre_of_gravity);
  body.X_WB = scene.bodies[deck_index].X_WB * container_bottom(load.size).inverse();
  const int carried = add(std::move(body));
  scene.frames.push_back({load.name, carried, container_bottom(load.size)});
  if (mafi.twistlocks) add_twistlocks(mafi, deck_index, carried, scene);
}

}  // namespace quayside::crane_models
