// A free box B near a fixed box A, followed in time under a contact law alone and, if wanted, its weight: the smallest
// simulation in which a law can show whether it makes energy, slides or sinks.
#pragma once

#include <functional>
#include <vector>

#include "contact_nn/contact.h"
#include "contact_nn/random.h"

namespace quayside::contact_nn {

class FreeBox {
 public:
  // Force on B and its torque about A's centre, at a pose and motion of B in A.
  using Force = std::function<ContactForce(const Pose& X_AB, const RelativeVelocity& V_AB)>;

  // p_AB [m]; q_AB (w, x, y, z); v_AB in A [m/s]; w_AB in B [rad/s].
  using State = Eigen::Matrix<double, 13, 1>;

  // `mass` [kg] is spread evenly over B; `gravity` [m/s²] pulls along −z of A.
  FreeBox(const Box& b, double mass, Force force, double gravity = 0);

  static State state(const Pose& X_AB, const Eigen::Vector3d& v_A, const Eigen::Vector3d& w_B);
  static Pose pose(const State& y);

  // Kinetic, of the weight, and stored in the contact [J].
  double energy(const State& y) const;

  // Follows B for at most `duration` [s], until `stop` says so after a step. Steps of Dormand and Prince (1980), orders 5 and
  // 4, each with an error of at most `tolerance` [m] (speeds count by the 20 ms that a contact lasts, angles by the box'
  // half length) but not shorter than a nanosecond, or a force that jumps would stop it. Returns the time passed [s].
  double follow(State& y, double duration, double tolerance,
                const std::function<bool(double time, const State& y)>& stop = {}) const;

 private:
  ContactForce contact(const State& y) const;
  State derivative(const State& y) const;
  double step(const State& y, double h, State& next) const;

  Eigen::Vector3d half_, inertia_;
  double mass_, gravity_;
  Force force_;
};

// An elastic and frictionless bounce. The box is followed until it has been 5 mm away for 50 ms, or for 3 s.
struct Throw {
  Box a, b;
  double mass;        // of B [kg]
  Pose X_AB;          // where it starts, apart
  Eigen::Vector3d v_A, w_B;
};
struct Rebound {
  bool touched = false, left = false;
  double gain = 0;  // energy at the end less energy at the start, over the latter [1]
};
Rebound rebound(const Throw& start, const FreeBox::Force& elastic, double tolerance = 1e-9);

// From a random direction in a random orientation, 2 mm away, at 0.2 to 1.3 m/s and up to 0.1 rad/s; 30 t.
Throw throw_from_anywhere(const Box& a, const Box& b, Random& random);

// Set down on top of A: tilted to 2.5°, yawed to 6°, off by up to 2 m along and 0.5 m across; at 0.1 to 0.6 m/s, drifting at
// 0.1 m/s, up to 0.05 rad/s; 30 t.
Throw throw_down(const Box& a, const Box& b, Random& random);

// Of the bounces that touched.
struct ReboundFigures {
  int touched = 0;
  int gained = 0;       // more than a thousandth
  int lost = 0;         // more than a thousandth
  int still_near = 0;   // not away after 3 s
  double median = 0;    // change of energy, either way [1]
  double most_gained = 0;
};
inline constexpr double kNoticeable = 1e-3;  // change of energy that counts [1]
ReboundFigures figures_of(std::vector<Rebound> bounces);

}  // namespace quayside::contact_nn
