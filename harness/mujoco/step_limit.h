// How far a Runge-Kutta step of order four may go: the stiffest time constant of a scene as it is now.
#pragma once

#include <vector>

#include "contact_nn/contact.h"
#include "harness/engine_unit.h"
#include "harness/scene_forces.h"

namespace quayside::harness::mujoco {

// Stiffness of a flat contact of two boxes [N/m]: that of the reference area under the law `points`; under `potential`
// it grows with the fourth root of the area, here the smaller box's largest face.
double flat_stiffness(const crane_models::Scene& scene, const crane_models::ContactPair& pair,
                      const contact_nn::ContactSettings& contact);

// With ω² or λ the frequency or rate that a group of springs, dampers or friction gives to a body, bounded by the sum
// of what acts on it over its mass times `kModeFactor`, the step is the least of
//
//   ropes, contacts   ω h ≤ (120 ε)^¼      relative error of RK4 per radian: (ω h)⁴/120
//   locks             three times that     their vibrations are small and die soon
//   dampers           λ h ≤ 1              RK4 is stable up to 2.78
//   friction          λ h ≤ 2, λ = μ N/(m v_t), N the normal force at the end of the step at the present approach
//                     where it sticks: λ h ≤ 1, λ = σ/m, σ the damping of its bristle
//   rotation          |ω|³ h² ≤ 12 ε       MuJoCo's RK4 is of order two in the rotation of bodies that tumble
//   flight            no pair that is apart sinks deeper than `kDepthOfArrival` (but no less than the contact step)
//
// ε the relative tolerance. Contacts count while they touch or are about to.
class StepLimit {
 public:
  // The scene must outlive this object.
  StepLimit(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact, const SolverSettings& solver);

  double operator()(const SceneForces& forces, const std::vector<BodyMotion>& bodies,
                    const std::vector<crane_models::DriveMotion>& drives, const std::vector<char>& locks_closed,
                    const SceneLoads& loads) const;

 private:
  double inverse_mass(int body) const { return body < 0 ? 0 : inverse_mass_[body]; }
  double contact_step(const std::vector<BodyMotion>& bodies, const SceneLoads& loads) const;

  const crane_models::Scene& scene_;
  contact_nn::ContactSettings contact_;
  std::optional<contact_nn::BristleFriction> bristle_;
  double fixed_, max_step_;
  double phase_, lock_phase_, rotation_;
  double gravity_;
  std::vector<double> inverse_mass_;     // of all that is welded together; 0 where it cannot give way [1/kg]
  std::vector<double> pair_stiffness_;   // [N/m]
  double arrival_step_ = 0;              // contact step at a first touch [s]
  mutable std::vector<double> spring_;   // per body, scratch [N/m]
  mutable std::vector<double> damper_;   // per body, scratch [N s/m]
};

}  // namespace quayside::harness::mujoco
