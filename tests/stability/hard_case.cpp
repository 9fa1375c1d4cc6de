#include "tests/stability/hard_case.h"

#include <cmath>

#include "contact_nn/potential_law.h"
#include "contact_nn/triangle_moments.h"

namespace quayside::harness {

double Finding::deviation() const { return std::abs(measured - expected); }

Finding& Finding::short_of(double accepted_deviation, const std::string& why) {
  accepted = accepted_deviation;
  shortfall = why;
  return *this;
}

Finding& Findings::near(const std::string& quantity, const std::string& unit, double measured, double expected,
                        double threshold, const std::string& reason) {
  list_.push_back({quantity, unit, expected, threshold, measured, reason});
  return list_.back();
}

std::vector<HardCase> hard_cases() {
  std::vector<HardCase> all;
  for (const auto& group : {rope_cases(), contact_cases(), resting_cases(), friction_cases(), solver_cases()}) {
    all.insert(all.end(), group.begin(), group.end());
  }
  return all;
}

contact_nn::ContactSettings default_contact(const HardCaseSettings& settings) {
  contact_nn::ContactSettings contact;
  contact.model = settings.model;
  return contact;
}

contact_nn::ContactSettings elastic(contact_nn::ContactSettings contact) {
  contact.restitution = 1;
  contact.friction = 0;
  return contact;
}

crane_models::Scene scene_of(const std::vector<crane_models::Body>& bodies, bool gravity) {
  crane_models::Scene scene;
  if (!gravity) scene.gravity.setZero();
  for (const crane_models::Body& body : bodies) add_body(scene, body);
  return scene;
}

crane_models::Body container(const std::string& name, const crane_models::Pose& X_WB) {
  return free_box(name, kContainerMass, kContainerSize, X_WB);
}

crane_models::Pose turned(const Eigen::Vector3d& axis, double angle, const Eigen::Vector3d& p_W) {
  crane_models::Pose X_WB = crane_models::Pose::Identity();
  X_WB.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  X_WB.translation() = p_W;
  return X_WB;
}

double lowest(const Eigen::Vector3d& size, const Eigen::Matrix3d& R_WB) {
  return -0.5 * R_WB.row(2).cwiseAbs().dot(size);
}

double flat_stiffness(const contact_nn::ContactSettings& contact, double area) {
  return contact.stiffness * std::pow(area / contact_nn::kReferenceArea, 2.0 / contact_nn::kNorm);
}

crane_models::Pose pose(const Simulation& simulation, const std::string& body) {
  crane_models::Pose X_WB = crane_models::Pose::Identity();
  X_WB.linear() = simulation.quaternion(body + ".orientation").toRotationMatrix();
  X_WB.translation() = simulation.vector(body + ".position");
  return X_WB;
}

contact_nn::ContactForce contact_between(const contact_nn::ContactModule& module, const Simulation& simulation,
                                         const std::string& a, const Eigen::Vector3d& size_a, const std::string& b,
                                         const Eigen::Vector3d& size_b) {
  contact_nn::ContactCounters counters;
  return module.force({0.5 * size_a}, {0.5 * size_b}, pose(simulation, a).inverse() * pose(simulation, b), {}, counters);
}

std::vector<Event> events_of(Simulation& simulation, EventKind kind) {
  std::vector<Event> events;
  for (const Event& event : simulation.engine().take_events()) {
    if (event.kind == kind) events.push_back(event);
  }
  return events;
}

}  // namespace quayside::harness
