// What the gates see and say: from a pair of boxes to the inputs of a network, and from its outputs to what the
// closed form is asked to evaluate.
//
// A gate never decides what the answer is, only where to look first; a check follows it. So its inputs need not be
// continuous, but they must not break on the pairs that cranes meet: containers of 12 m on a quay of 200 m, millimetres
// deep, skewed by microradians. So the inputs are lengths relative to the depth of the overlap, on a logarithmic scale
// with both signs: a micrometre is seen where it decides, and a hundred metres are just "far".
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "contact_nn/contact.h"
#include "contact_nn/mlp.h"
#include "contact_nn/potential_law.h"
#include "contact_nn/separating_axes.h"

namespace quayside::contact_nn {

// 6 axes (A's, then B's): overlap, and how far the other box stays within the near and within the far face of this one.
// 18 tilts: how far one half extent of a box rises along each axis of the other.
inline constexpr int kGateInputs = 36;
using GateInputs = Eigen::Matrix<float, kGateInputs, 1>;

// ---- Law `potential`: which faces, and which cells of the other box, can carry force?

// One logit each for being needed: faces of A, cells of B on them, faces of B, cells of A on them. Within each group,
// axis by axis, the face towards the other box and then the one away from it.
inline constexpr int kPotentialOutputs = 24;
using PotentialOutputs = Eigen::Matrix<float, kPotentialOutputs, 1>;
using PotentialGate = Mlp<float, Activation::relu, kGateInputs, 32, kPotentialOutputs>;
inline constexpr const char* kPotentialInterface = "quayside gate_potential/1";  // of its network file

// ---- Law `points`: which of the 15 axes separates the boxes most?

inline constexpr int kPointsOutputs = kAxisCount;  // the larger, the likelier
using PointsOutputs = Eigen::Matrix<float, kPointsOutputs, 1>;
using PointsGate = Mlp<float, Activation::relu, kGateInputs, 32, 32, kPointsOutputs>;
inline constexpr const char* kPointsInterface = "quayside gate_points/1";

// A pair as a gate sees it. The axes of both boxes are turned round so that the other box lies towards their positive
// ends: the mirror symmetries of a box are taken out, and a network has one case to learn instead of 64. (Turning an
// axis makes inputs jump where a centre lies exactly abreast. That could not be allowed in a network whose output is the
// answer; here the answer is the closed form's on either side.)
struct GateView {
  GateView(const Box& a, const Box& b, const Pose& X_AB);

  // Every face that the gate names (positive logit) with every cell that it names on it.
  PieceMask named(const PotentialOutputs& logits) const;

  // What a perfect gate would say, 1 or 0.
  PotentialOutputs wanted(const PieceMask& needed) const;

  GateInputs inputs;

 private:
  // Number of the face on this axis of A or B that looks towards the other box; the one away from it is `^ 1`.
  std::array<int, 3> near_a_, near_b_;
};

// The three axes with the largest outputs.
std::array<int, 3> top_three(const PointsOutputs& outputs);

}  // namespace quayside::contact_nn
