// Contacts that geometry does not allow.
#pragma once

#include "contact_nn/contact.h"

namespace quayside::harness::mujoco {

// A contact that a collider reports between boxes A and B, in the frame of A.
struct ReportedContact {
  Eigen::Vector3d p_A;  // halfway between the surfaces [m]
  Eigen::Vector3d n_A;  // unit normal from A to B
  double depth;         // [m]
};

// True when the boxes are apart, when the point lies outside of one of them enlarged by the depth, or when the boxes
// overlap less along the normal than the depth; each by more than 1e-6 m, the rounding of a collider on boxes of 100 m.
bool is_phantom(const contact_nn::Box& a, const contact_nn::Box& b, const contact_nn::Pose& X_AB,
                const ReportedContact& contact);

}  // namespace quayside::harness::mujoco
