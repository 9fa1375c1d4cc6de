// Friction that sticks: a slider of Coulomb's limit in series with a spring and a damper side by side, one for each pair of
// boxes.
//
// Let the pair press with N along n at the centre of pressure c, r² the polar moment of the pressure over N. The slide is
// u = (velocity of B at c across n, r times the spin about n), in four components; z, the bristle's deflection, has as many:
// a displacement in A's axes and a turning about n times r. With k the stiffness and σ = k τ the damping
//
//     q = k z + σ u,    f = s q,    ż = u − (1 − s) q/σ,    s = S(x)/x,    x = |q|/(μ N),
//
// where S(x) = x up to 1 − w, 1 from 1 + w on and a parabola in between. The force on B is minus the first three of f, the
// torque about n minus r times the fourth: one limit for both, |f| ≤ μ N.
//
//   sticks   x ≤ 1 − w: s = 1, ż = u. A spring with a damper, so a steady load moves nothing once it has settled.
//   slides   ż = 0 after some τ: k z = f, |f| = μ N, along −u.
//   apart    N = 0: s = 0, no force, ż = −z/τ.
//
// It only takes energy beyond what it stores. With y = u − (1 − s) q/σ, which is ż, one has f = k z + σ y, so the power f·u
// taken from the motion is k z·ż, which ½ k z² stores, + σ y² + s (1 − s) q²/σ, neither of them negative, whatever N, n, c and
// r do meanwhile. Where n turns against A, z keeps a component along n: it exerts nothing and fades with τ.
//
// Sources: the elasto-plastic presliding of Dupont, Hayward, Armstrong, Altpeter, "Single state elastoplastic friction
// models", IEEE Trans. Automatic Control 47 (2002) 787: no plastic part below the limit, so no drift under loads that alternate
// (LuGre's bristle drifts). There the plastic part follows |u|; here it is that of a damped slider, which is passive
// with damping. Stiffness: Mindlin, "Compliance of elastic bodies in contact", J. Appl. Mech. 16 (1949) 259.
#pragma once

#include <optional>

#include "contact_nn/contact.h"

namespace quayside::contact_nn {

using Bristle = Eigen::Vector4d;  // z [m]

class BristleFriction {
 public:
  // k over the normal stiffness of a flat contact: Mindlin's 2 (1 − ν)/(2 − ν), ν = 0.3.
  static constexpr double kStiffnessShare = 0.82;
  // τ [s]: a container of 30 t on the usual stiffness, which swings sideways with 7 ms × 2 π, is damped to 0.6 of the critical.
  static constexpr double kRelaxation = 0.01;
  // w: a slope of half a percent less than μ still holds.
  static constexpr double kBlend = 0.004;

  explicit BristleFriction(const ContactSettings& settings)
      : friction_(settings.friction), stiffness_(kStiffnessShare * settings.stiffness) {}

  // Adds friction, the energy it stores and the power it takes to `force`, which is the frictionless contact's, with
  // `pressure_radius2`. Returns dz/dt. Allocates nothing.
  Bristle add(const Bristle& z, const Pose& X_AB, const RelativeVelocity& V_AB, ContactForce& force) const;

  double damping() const { return stiffness_ * kRelaxation; }  // σ [N s/m]

 private:
  double friction_, stiffness_;
};

// None where friction has no state: regularised, or of no coefficient.
std::optional<BristleFriction> bristle_friction(const ContactSettings& settings);

}  // namespace quayside::contact_nn
