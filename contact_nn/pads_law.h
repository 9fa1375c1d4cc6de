// Law `pads`: a spring of constant stiffness at every point of the manifold.
//
// This is what an engine has that solves every contact point on its own, so it maps one to one to MuJoCo's contacts. A pad
// has a quarter of the flat stiffness K. The whole therefore depends on how many points there are: K on the four corners of
// a face, K/2 on an edge, K/4 on a vertex, and up to 2 K on the eight points of two crossed faces.
#pragma once

#include "contact_nn/law_parameters.h"
#include "contact_nn/manifold.h"
#include "contact_nn/points_law.h"

namespace quayside::contact_nn {

constexpr int kPads = 4;  // that carry a flat contact

inline ContactForce pads_force(const Manifold& manifold, const Pose& X_AB, const RelativeVelocity& V_AB, LawParameters law) {
  law.stiffness *= static_cast<double>(manifold.count) / kPads;  // which the points then share
  return points_force(manifold, X_AB, V_AB, law);
}

}  // namespace quayside::contact_nn
