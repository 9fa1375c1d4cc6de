// Small scenes with known answers, and a driver for a unit.
#pragma once

#include <cmath>
#include <memory>
#include <string>

#include "harness/mujoco/mujoco_unit.h"

namespace quayside::harness {

constexpr double kGravity = 9.81;  // [m/s²]

inline crane_models::Body box_body(const std::string& name, double mass, const Eigen::Vector3d& size,
                                   const Eigen::Vector3d& position) {
  crane_models::Body body;
  body.name = name;
  body.mass = mass;
  const Eigen::Vector3d squares = size.cwiseAbs2();
  body.I_BBcm_B = Eigen::Vector3d(mass / 12 * (squares.sum() - squares.array())).asDiagonal();
  body.boxes.push_back({0.5 * size, crane_models::Pose::Identity(), ""});
  body.X_WB.translation() = position;
  return body;
}

inline crane_models::Body ground() {
  crane_models::Body body;
  body.name = "ground";
  body.joint.type = crane_models::JointType::fixed;
  body.boxes.push_back({{100, 100, 1}, crane_models::Pose(Eigen::Translation3d(0, 0, -1)), ""});
  return body;
}

inline void report(crane_models::Scene& scene, const std::string& body) {
  for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i) {
    if (scene.bodies[i].name == body) scene.frames.push_back({body, i, crane_models::Pose::Identity()});
  }
}

inline ValueReference find(const Unit& unit, const std::string& variable) {
  const auto& list = unit.variables();
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].name == variable) return static_cast<ValueReference>(i);
  }
  throw std::invalid_argument("no variable " + variable);
}

inline double get(const Unit& unit, const std::string& variable) { return unit.get(find(unit, variable)); }
inline void set(Unit& unit, const std::string& variable, double value) { unit.set(find(unit, variable), value); }

inline Eigen::Vector3d get3(const Unit& unit, const std::string& name) {
  return {get(unit, name + ".x"), get(unit, name + ".y"), get(unit, name + ".z")};
}

inline void start(Unit& unit) {
  unit.enter_initialization_mode(0);
  unit.exit_initialization_mode();
  unit.update_discrete_states();
  unit.enter_step_mode();
}

// Steps by `step` until `end`, through events.
inline Time run(Unit& unit, Time now, Time end, Time step) {
  while (now < end) {
    const StepResult result = unit.do_step(now, std::min(step, end - now));
    now = result.time;
    if (!result.event) continue;
    unit.enter_event_mode();
    unit.update_discrete_states();
    unit.enter_step_mode();
  }
  return now;
}

constexpr Time kMillisecond = 1'000'000;
constexpr Time kSecond = 1'000'000'000;

inline contact_nn::ContactSettings exact_contact() {
  contact_nn::ContactSettings contact;
  contact.model = contact_nn::Model::exact;
  return contact;
}

inline std::unique_ptr<EngineUnit> same_law(const crane_models::Scene& scene, const SolverSettings& solver = {},
                                            const contact_nn::ContactSettings& contact = exact_contact()) {
  return make_mujoco_engine(true, scene, contact, solver);
}
inline std::unique_ptr<EngineUnit> native(const crane_models::Scene& scene, const SolverSettings& solver = {},
                                          const contact_nn::ContactSettings& contact = exact_contact()) {
  return make_mujoco_engine(false, scene, contact, solver);
}

// A load on four vertical ropes below a trolley that a drive moves along y, the rope length driven as well.
inline crane_models::Scene crane(double rope_length) {
  using namespace crane_models;
  Scene scene;
  scene.title = "four ropes";
  scene.drives.push_back({"trolley", "m", "position along the boom", 0, 1, 3, 0.6});
  scene.drives.push_back({"hoist", "m", "rope length", rope_length, -1, 1, 0.5});
  Body trolley = box_body("trolley", 20e3, {4, 6, 1}, {0, 0, 40});
  trolley.joint.type = JointType::slider;
  trolley.joint.drive = 0;
  Eigen::Matrix3d along_y;  // columns: F's x axis is the world's y
  along_y << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  trolley.joint.X_PF = Eigen::Translation3d(0, 0, 40) * Eigen::Quaterniond(along_y);
  trolley.joint.X_BM = Pose(Eigen::Quaterniond(along_y));
  scene.bodies.push_back(trolley);
  const double mass = 40e3, ea = 42e6;
  const double stretch = mass * kGravity * rope_length / (4 * ea);
  scene.bodies.push_back(box_body("load", mass, {12.192, 2.438, 2.591}, {0, 0, 40 - rope_length - stretch}));
  int i = 0;
  for (const double x : {-2.0, 2.0}) {
    for (const double y : {-0.9, 0.9}) {
      spreader::Rope rope;
      rope.name = "rope." + std::to_string(i++);
      rope.upper = {0, {x, y, 0}};
      rope.lower = {1, {x, y, 0}};
      rope.axial_stiffness = ea;
      rope.damping_time = 0.005;
      rope.drives = {{1}};
      scene.ropes.push_back(rope);
    }
  }
  report(scene, "load");
  report(scene, "trolley");
  return scene;
}

}  // namespace quayside::harness
