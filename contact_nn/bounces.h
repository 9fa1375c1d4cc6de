// Does a contact law make energy? A free 40 ft box is thrown against a fixed one, elastically and without friction, again and
// again from random starts, and its kinetic energy is compared before and after.
#pragma once

#include <cstdint>
#include <functional>

#include "contact_nn/contact.h"

namespace quayside::contact_nn {

// Elastic force on B [N] and its torque about A's centre [N m], expressed in A; zero when apart.
struct Wrench {
  Eigen::Vector3d f_A, t_A;
};
using ElasticLaw = std::function<Wrench(const Pose& X_AB)>;

// The two boxes: A is fixed, B of 30 t is free.
extern const Box kBounceBox;

// Position, quaternion (w, x, y, z) and velocity of B in A; angular velocity in B. SI units.
using BounceState = Eigen::Matrix<double, 13, 1>;

// A start 2 mm away from contact, in any orientation, at 0.2 to 1 m/s and up to 0.1 rad/s towards A.
BounceState random_bounce_start(std::uint64_t seed);

struct Bounce {
  bool touched = false;
  bool finished = false;  // apart at the end: after 50 ms farther away than 5 mm, or 3 s
  double gain = 0;        // kinetic energy gained, over that at the start [1]
  std::uint64_t evaluations = 0;
};

// Follows B through its contact with Dormand and Prince's pair of orders 5 and 4. `tolerance` is the error of a step [m];
// steps do not become shorter than 0.1 µs, so that a law that jumps is crossed.
Bounce bounce(const BounceState& start, const ElasticLaw& law, double tolerance);

inline constexpr double kBounceGain = 1e-3;  // what a bounce may gain of its energy [1]

struct BounceTrials {
  std::uint64_t bounces = 0, touched = 0, unfinished = 0;  // unfinished: not apart at the end
  std::uint64_t gained = 0;   // bounces that gained more than kBounceGain
  double most_gained = 0, most_lost = 0;  // of all finished ones, over the energy at the start [1]
  std::uint64_t evaluations = 0;

  void add(const Bounce& b);
};

}  // namespace quayside::contact_nn
