// MuJoCo's dynamics and Runge-Kutta integrator under our own laws.
#pragma once

#include "harness/mujoco/engine.h"

namespace quayside::harness::mujoco {

// Ropes, locks and contacts act through MuJoCo's passive-force callback at every stage of the integrator; its own
// constraints and contacts are off. Work, dissipation and impulses are integrated with the stages and weights of the
// motion, so that they are of its order. So are the bristles of friction that sticks: they follow the contact groups'
// impulses among the integrals.
class SameLawEngine final : public Engine, private PassiveLaw {
 public:
  SameLawEngine(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
                const SolverSettings& solver);

 private:
  PassiveLaw* law() override { return this; }
  void hold_contacts(bool hold) override { loads_.contacts_held = hold; }
  void add_passive_forces(const mjModel* model, mjData* data) override;
  void prepare_evaluation() override { place_bristles(0); }
  void prepare_stages(double h) override;
  void finish_stages(double h, const std::vector<double>& rates_at_begin) override;
  void integrate(double h, const std::vector<double>& rates_at_begin) override;
  void place_bristles(double after);

  const std::size_t first_bristle_;  // of the integrals
  int stage_;                        // to come, 2 to 4 within a step
  double step_ = 0;                  // [s]
  std::vector<double> stage_sum_;   // weighted rates of the stages after the first
};

}  // namespace quayside::harness::mujoco
