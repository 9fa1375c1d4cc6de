// Small scenes with known answers, and a driver that steps an engine through them.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "harness/engine_unit.h"

namespace quayside::harness {

constexpr double kGravity = 9.81;  // [m/s²]
constexpr double kPi = 3.14159265358979323846;

inline const Eigen::Vector3d kContainerSize{12.192, 2.438, 2.591};  // ISO 40 ft [m]
constexpr double kContainerMass = 30480;                            // gross [kg]

inline crane_models::Pose at(double x, double y, double z) { return crane_models::Pose(Eigen::Translation3d(x, y, z)); }

inline Eigen::Matrix3d box_inertia(double mass, const Eigen::Vector3d& size) {
  const Eigen::Vector3d s = size.cwiseProduct(size);
  return mass / 12 * Eigen::Vector3d(s.y() + s.z(), s.z() + s.x(), s.x() + s.y()).asDiagonal();
}

// A uniform box that moves freely; its frame B is at its centre.
crane_models::Body free_box(const std::string& name, double mass, const Eigen::Vector3d& size,
                            const crane_models::Pose& X_WB);
// A box that stays where it is: 40 m square and 2 m thick, its top at z = 0.
crane_models::Body ground();
// Appends a body, a frame of the same name at its origin, and contact pairs with all bodies so far that have boxes.
void add_body(crane_models::Scene& scene, const crane_models::Body& body);

// A uniform container on four parallel vertical ropes, from points at z = 0 of the world or of the body `upper`. At
// rest the stretched ropes are `length` long. With a `drive` its value is the rest length.
struct Hoist {
  double length = 25;      // [m]
  double half_x = 2.5, half_y = 0.8;  // half the rectangle of the ropes, above and below alike [m]
  double stiffness = 0;    // of all four ropes together, EA / L0 [N/m]
  double damping_time = 0;
  double mass = kContainerMass;
  int upper = crane_models::kWorld;
  int drive = -1;
};
// The body is called "load", the ropes "rope0" to "rope3". Returns the rest length [m].
double hang_container(crane_models::Scene& scene, const Hoist& hoist);

// An engine, ready to step, on a scene.
class Simulation {
 public:
  Simulation(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact, double relative_tolerance,
             Time start = 0);
  // `engine`: as for make_engine.
  Simulation(const std::string& engine, const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
             const SolverSettings& solver, Time start = 0);

  double get(const std::string& name) const { return engine_->get(reference(name)); }
  void set(const std::string& name, double value) { engine_->set(reference(name), value); }
  Eigen::Vector3d vector(const std::string& name) const {
    return {get(name + ".x"), get(name + ".y"), get(name + ".z")};
  }
  Eigen::Quaterniond quaternion(const std::string& name) const {
    return {get(name + ".w"), get(name + ".x"), get(name + ".y"), get(name + ".z")};
  }
  double time() const { return seconds(time_); }
  // Steps of `step` until `end`, shorter where events end them; `visit` after each.
  void run_to(double end, double step, const std::function<void()>& visit = [] {});
  EngineUnit& engine() { return *engine_; }
  double relative_residual() const { return engine_->energy().residual() / engine_->energy().largest_exchange; }
  // Takes the unit's time to be `time`, after a restore.
  void at(double time) { time_ = nanoseconds(time); }

 private:
  ValueReference reference(const std::string& name) const;
  std::unique_ptr<EngineUnit> engine_;
  Time time_ = 0;
};

// Contact without a network, so that physics is tested and not training.
contact_nn::ContactSettings exact_contact();
// The same without friction, elastic.
contact_nn::ContactSettings elastic_contact();

}  // namespace quayside::harness
