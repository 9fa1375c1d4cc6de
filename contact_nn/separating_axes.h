// The separating-axis test of two boxes: along which of 15 directions are they farthest apart?
//
// Axes are numbered: 0-2 the face normals of A, 3-5 those of B, 6 + 3 i + j the common normal of A's edge
// direction i and B's edge direction j. Every normal points from A to B.
#pragma once

#include <array>

#include "contact_nn/contact.h"

namespace quayside::contact_nn {

inline constexpr int kAxisCount = 15;

// Below this sine two edges count as parallel and their common normal is not tried [1]. Skipping an axis of sine w/L
// under-reports a penetration d by at most w²/2d (the two neighbouring faces of the Minkowski difference share an
// edge with the skipped sliver of width w): 1e-9 m at 1 mm for 12 m edges. Trying it would cost ε L / sine, 2e-8 m.
inline constexpr double kParallelSine = 1e-7;

// Rounding of one axis' numerator, in units of ε times the size of the pair [1]: some ten operations.
inline constexpr double kAxisRounding = 16;

struct AxisSeparation {
  double gap;           // [m], negative when the boxes overlap on this axis
  int axis;             // 0 … 14
  Eigen::Vector3d n_A;  // unit, from A to B
};

// The axis of largest separation. Ties go to the lower axis number, and an edge pair must win by more than rounding.
AxisSeparation largest_separation(const Box& a, const Box& b, const Pose& X_AB);

// Unit, from A to B.
Eigen::Vector3d axis_normal(const Pose& X_AB, int axis);

// `certified`: the axis of largest separation is among the named ones. The whole test is made: four axes at a time it
// costs less than three axes and the proof that no other beats them.
struct NamedSeparation {
  AxisSeparation best;
  bool certified;
};
NamedSeparation largest_separation(const Box& a, const Box& b, const Pose& X_AB, const std::array<int, 3>& named);

// True when some axis separates the boxes by more than rounding. Never true for boxes that overlap; may be false
// for boxes that are apart by no more than rounding. Cheaper than the separation itself.
bool surely_apart(const Box& a, const Box& b, const Pose& X_AB);

}  // namespace quayside::contact_nn
