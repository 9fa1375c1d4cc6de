#include "tests/acceptance/scenes.h"

#include <algorithm>

namespace quayside::harness {

crane_models::Body free_box(const std::string& name, double mass, const Eigen::Vector3d& size,
                            const crane_models::Pose& X_WB) {
  crane_models::Body body;
  body.name = name;
  body.mass = mass;
  body.I_BBcm_B = box_inertia(mass, size);
  body.boxes.push_back({0.5 * size});
  body.X_WB = X_WB;
  return body;
}

crane_models::Body ground() {
  crane_models::Body body;
  body.name = "ground";
  body.joint.type = crane_models::JointType::fixed;
  body.boxes.push_back({Eigen::Vector3d(20, 20, 1)});
  body.X_WB = at(0, 0, -1);
  return body;
}

void add_body(crane_models::Scene& scene, const crane_models::Body& body) {
  const int index = static_cast<int>(scene.bodies.size());
  if (!body.boxes.empty()) {
    for (int i = 0; i < index; ++i) {
      if (!scene.bodies[i].boxes.empty() && !(body.is_static() && scene.bodies[i].is_static())) {
        scene.pairs.push_back({i, 0, index, 0});
      }
    }
  }
  scene.bodies.push_back(body);
  scene.frames.push_back({body.name, index});
}

double hang_container(crane_models::Scene& scene, const Hoist& hoist) {
  const Eigen::Vector3d half = 0.5 * kContainerSize;
  add_body(scene, free_box("load", hoist.mass, kContainerSize, at(0, 0, -hoist.length - half.z())));
  const int load = static_cast<int>(scene.bodies.size()) - 1;
  const double stretch = hoist.mass * kGravity / hoist.stiffness;
  const double rest_length = hoist.length - stretch;
  for (const double x : {-hoist.half_x, hoist.half_x}) {
    for (const double y : {-hoist.half_y, hoist.half_y}) {
      spreader::Rope rope;
      rope.name = "rope" + std::to_string(scene.ropes.size());
      rope.upper = {hoist.upper, {x, y, 0}};
      rope.lower = {load, {x, y, half.z()}};
      rope.axial_stiffness = hoist.stiffness / 4 * rest_length;
      rope.damping_time = hoist.damping_time;
      if (hoist.drive < 0) {
        rope.rest_length = rest_length;
      } else {
        rope.drives = {{hoist.drive}};
        scene.drives[hoist.drive].start = rest_length;
      }
      scene.ropes.push_back(rope);
    }
  }
  return rest_length;
}

Simulation::Simulation(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
                       double relative_tolerance, Time start)
    : Simulation("simbody", scene, contact, SolverSettings{relative_tolerance}, start) {}

Simulation::Simulation(const std::string& engine, const crane_models::Scene& scene,
                       const contact_nn::ContactSettings& contact, const SolverSettings& solver, Time start)
    : engine_(make_engine(engine, scene, contact, solver)), time_(start) {
  engine_->enter_initialization_mode(start);
  engine_->exit_initialization_mode();
  engine_->update_discrete_states();
  engine_->enter_step_mode();
}

ValueReference Simulation::reference(const std::string& name) const {
  const auto& variables = engine_->variables();
  const auto found =
      std::find_if(variables.begin(), variables.end(), [&](const Variable& v) { return v.name == name; });
  if (found == variables.end()) throw std::invalid_argument("no variable " + name);
  return static_cast<ValueReference>(found - variables.begin());
}

void Simulation::run_to(double end, double step, const std::function<void()>& visit) {
  const Time begin = time_, last = nanoseconds(end);
  for (std::int64_t i = 1; time_ < last; ++i) {
    const Time target = std::min(last, begin + nanoseconds(static_cast<double>(i) * step));
    while (time_ < target) {
      const StepResult result = engine_->do_step(time_, target - time_);
      time_ = result.time;
      if (result.event) {
        engine_->enter_event_mode();
        engine_->update_discrete_states();
        engine_->enter_step_mode();
      }
      visit();
    }
  }
}

contact_nn::ContactSettings exact_contact() {
  contact_nn::ContactSettings settings;
  settings.model = contact_nn::Model::exact;
  return settings;
}

contact_nn::ContactSettings elastic_contact() {
  contact_nn::ContactSettings settings = exact_contact();
  settings.restitution = 1;
  settings.friction = 0;
  return settings;
}

}  // namespace quayside::harness
