// Hard cases: situations in which simulators break, each with what must come out, a threshold and where that comes from.
//
// A table of cases, each of which simulates and hands back findings. The same table is run by the tests and by the
// command that publishes the results.
#pragma once

#include <string>
#include <vector>

#include "tests/acceptance/scenes.h"

namespace quayside::harness {

// What to run the cases with.
struct HardCaseSettings {
  contact_nn::Model model = contact_nn::Model::committee;  // the product's default
  bool whole = true;  // false: the longest parts are shortened or left out
};

// One number that a case is judged by: it holds when |measured − expected| ≤ threshold.
struct Finding {
  std::string quantity;
  std::string unit;
  double expected, threshold, measured;
  std::string reason;  // of expectation and threshold

  // A threshold that is missed today: how far it may be missed (it must not become worse), and why.
  double accepted = 0;
  std::string shortfall = {};

  double deviation() const;       // NaN where nothing was measured
  bool holds() const { return deviation() <= threshold; }
  bool acceptable() const { return deviation() <= std::max(threshold, accepted); }
  Finding& short_of(double accepted_deviation, const std::string& why);
};

class Findings {
 public:
  Finding& near(const std::string& quantity, const std::string& unit, double measured, double expected,
                double threshold, const std::string& reason);
  Finding& at_most(const std::string& quantity, const std::string& unit, double measured, double threshold,
                   const std::string& reason) {
    return near(quantity, unit, measured, 0, threshold, reason);
  }
  std::vector<Finding> take() { return std::move(list_); }

 private:
  std::vector<Finding> list_;
};

struct HardCase {
  std::string name;
  std::string what;
  void (*run)(const HardCaseSettings&, Findings&);
};

// All of them, in the order of their files.
std::vector<HardCase> hard_cases();
std::vector<HardCase> rope_cases();
std::vector<HardCase> contact_cases();
std::vector<HardCase> resting_cases();
std::vector<HardCase> friction_cases();
std::vector<HardCase> solver_cases();

// --- Shared by the cases --------------------------------------------------------------------------------------------

constexpr double kDefaultTolerance = 1e-6;  // of the solver, relative: what a user gets who asks for nothing

contact_nn::ContactSettings default_contact(const HardCaseSettings& settings);
contact_nn::ContactSettings elastic(contact_nn::ContactSettings contact);  // no restitution loss, no friction

// Nothing but free boxes on static ones, for a scene without ropes and drives.
crane_models::Scene scene_of(const std::vector<crane_models::Body>& bodies, bool gravity = true);

// A container with its centre at `p_W` and orientation `R_WB`.
crane_models::Body container(const std::string& name, const crane_models::Pose& X_WB);
crane_models::Pose turned(const Eigen::Vector3d& axis, double angle, const Eigen::Vector3d& p_W);
// The lowest point of a box over its centre, a negative number.
double lowest(const Eigen::Vector3d& size, const Eigen::Matrix3d& R_WB);

// Flat contact stiffness of two faces that overlap in `area` [N/m], without the strip along the border.
double flat_stiffness(const contact_nn::ContactSettings& contact, double area);

// Force and centre of pressure between two bodies of a simulation, each one box about its frame's origin.
contact_nn::ContactForce contact_between(const contact_nn::ContactModule& module, const Simulation& simulation,
                                         const std::string& a, const Eigen::Vector3d& size_a, const std::string& b,
                                         const Eigen::Vector3d& size_b);
crane_models::Pose pose(const Simulation& simulation, const std::string& body);

// Of the events since the last call those of one kind.
std::vector<Event> events_of(Simulation& simulation, EventKind kind);

}  // namespace quayside::harness
