// The impulse of a blow between two rigid bodies at one point, in closed terms: no engine, no spring.
#pragma once

#include <Eigen/Core>

#include "harness/impacts/impact_matrix.h"

namespace quayside::harness {

// What the blow gives to the box, in the world.
struct TheoreticalBlow {
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  // [N s]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          // of the box after it [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // [rad/s]
  double energy_lost = 0;                                      // by both [J]
};

// At the origin of an impact scene, with the damping and friction of the settings. With K the sum of the inverse inertias of
// both bodies at the point, K_X = 1/m − [r] I⁻¹ [r], the sliding velocity v changes with the normal impulse J as
//
//   dv/dJ = K (n − μ v_t/√(|v_t|² + v_t0²)),
//
// whatever the spring. A normal force F(δ)(1 + c s), s = −n·v, does the elastic work F dδ = s/(1 + c s) dJ, and the blow ends
// when all of that has been given back. Without friction it is J = (1 + e) s/(n·K n) with the law's restitution e.
// Leaves out: motion of the point during the blow, torsion in the contact, gravity and ropes.
TheoreticalBlow theoretical_blow(const ImpactScene& scene, const contact_nn::ContactSettings& contact);

}  // namespace quayside::harness
