#include "crane_models/scene.h"

#include <functional>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace quayside::crane_models {
namespace {

Scene good_scene() {
  Scene scene;
  scene.drives = {{"hoist", "m", "rest length of the ropes", 10, -1, 1, 1}};
  scene.commands = {{"twistlocks", "true: closed", true}};
  const auto body = [](const char* name) {
    Body b;
    b.name = name;
    b.mass = 1000;
    b.boxes = {CollisionBox{{1, 1, 1}}};
    return b;
  };
  scene.bodies = {body("ground"), body("spreader"), body("load")};
  scene.bodies[0].joint.type = JointType::fixed;
  scene.bodies[0].mass = 0;
  spreader::Rope rope;
  rope.name = "rope";
  rope.upper = {kWorld, {0, 0, 20}};
  rope.lower = {1, {0, 0, 1}};
  rope.axial_stiffness = 84e6;
  rope.drives = {{0}};
  scene.ropes = {rope};
  spreader::Lock lock;
  lock.name = "twistlocks";
  lock.body_a = 1;
  lock.body_b = 2;
  lock.pins.resize(4);
  for (auto& pin : lock.pins) pin.p_A = pin.p_B = Eigen::Vector3d::Zero();
  lock.stiffness = 1e8;
  lock.command = 0;
  scene.locks = {lock};
  scene.pairs = {{0, 0, 2, 0}};
  scene.landed_switches = {{"landed", {2}, 1}};
  scene.frames = {{"load", 2, Pose::Identity()}};
  return scene;
}

TEST(Scene, AcceptsAGoodOne) { EXPECT_NO_THROW(check(good_scene())); }

TEST(Scene, RefusesWhatNoEngineCanBuild) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    const char* message;  // must be part of what the user reads
    std::function<void(Scene&)> spoil;
  } cases[] = {
      {"body load: its mass", [](Scene& s) { s.bodies[2].mass = 0; }},
      {"body load: its mass", [&](Scene& s) { s.bodies[2].mass = nan; }},
      {"body load: the name is used twice", [](Scene& s) { s.bodies[1].name = "load"; }},
      {"body load: the size of a box", [](Scene& s) { s.bodies[2].boxes[0].half.x() = -1; }},
      {"body load: no mass distribution", [](Scene& s) { s.bodies[2].I_BBcm_B.diagonal() << 1, 1, 2.1; }},
      {"body load: the principal moments", [](Scene& s) { s.bodies[2].I_BBcm_B.diagonal() << 1, 1, -1; }},
      {"body load: the inertia is not symmetric", [](Scene& s) { s.bodies[2].I_BBcm_B(0, 1) = 0.1; }},
      {"body load: its start", [](Scene& s) { s.bodies[2].X_WB.linear() *= 2; }},
      {"body load: its start", [](Scene& s) { s.bodies[2].X_WB.linear() *= -1; }},
      {"body load: its velocity", [&](Scene& s) { s.bodies[2].w_WB.x() = nan; }},
      {"body spreader: the parent", [](Scene& s) { s.bodies[1].joint = {JointType::hinge, 2}; }},
      {"body spreader: a free joint", [](Scene& s) { s.bodies[1].joint.parent = 0; }},
      {"body spreader: the drive", [](Scene& s) { s.bodies[1].joint.drive = 1; }},
      {"body spreader: only a slider", [](Scene& s) { s.bodies[1].joint.drive = 0; }},
      {"rope rope: a body", [](Scene& s) { s.ropes[0].lower.body = 3; }},
      {"rope rope: both ends", [](Scene& s) { s.ropes[0].upper.body = 1; }},
      {"rope rope: its stiffness", [](Scene& s) { s.ropes[0].axial_stiffness = 0; }},
      {"rope rope: its damping", [](Scene& s) { s.ropes[0].damping_time = -1; }},
      {"rope rope: its drive", [](Scene& s) { s.ropes[0].drives = {{0}, {1}}; }},
      {"rope rope: the share", [&](Scene& s) { s.ropes[0].drives[0].share = nan; }},
      {"rope rope: its rest length", [](Scene& s) { s.drives[0].start = -1; }},
      {"lock twistlocks: a body", [](Scene& s) { s.locks[0].body_b = 3; }},
      {"lock twistlocks: it holds", [](Scene& s) { s.locks[0].body_b = 1; }},
      {"lock twistlocks: it has no pins", [](Scene& s) { s.locks[0].pins.clear(); }},
      {"lock twistlocks: its stiffness", [](Scene& s) { s.locks[0].stiffness = -1; }},
      {"lock twistlocks: its command", [](Scene& s) { s.locks[0].command = 1; }},
      {"lock twistlocks: it must start", [](Scene& s) { s.locks[0].closed = false; }},
      {"contact pair", [](Scene& s) { s.pairs[0].box_b = 1; }},
      {"contact pair", [](Scene& s) { s.pairs[0].body_b = 0; }},
      {"switch landed: it watches", [](Scene& s) { s.landed_switches[0].bodies.clear(); }},
      {"switch landed: its threshold", [](Scene& s) { s.landed_switches[0].threshold = 0; }},
      {"frame load: its body", [](Scene& s) { s.frames[0].body = -1; }},
      {"drive hoist: its sign", [](Scene& s) { s.drives[0].sign = 0; }},
      {"drive hoist: its largest speed", [](Scene& s) { s.drives[0].max_speed = -1; }},
      {"gravity", [&](Scene& s) { s.gravity.z() = nan; }},
  };
  for (const auto& c : cases) {
    Scene scene = good_scene();
    c.spoil(scene);
    try {
      check(scene);
      ADD_FAILURE() << "accepted: " << c.message;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(c.message), std::string::npos) << error.what();
    }
  }
}

TEST(Scene, CountsWhatAnEngineIntegrates) {
  Scene scene = good_scene();
  EXPECT_EQ(degrees_of_freedom(scene), 12);  // two free bodies; the ground is static
  scene.bodies[1].joint = {JointType::slider, kWorld};
  EXPECT_EQ(degrees_of_freedom(scene), 7);
  scene.bodies[1].joint.drive = 0;
  EXPECT_EQ(degrees_of_freedom(scene), 6);
  scene.bodies[2].joint = {JointType::pivot, 1};
  EXPECT_EQ(degrees_of_freedom(scene), 3);
}

}  // namespace
}  // namespace quayside::crane_models
