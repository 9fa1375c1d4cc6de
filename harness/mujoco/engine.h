// What both MuJoCo engines share: evaluating, stepping, taking a step again. Where forces come from is left to
// `SameLawEngine` and `NativeEngine`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "harness/mujoco/model.h"
#include "harness/mujoco/step_limit.h"
#include "harness/scene_engine.h"

namespace quayside::harness::mujoco {

// The stages of the classical Runge-Kutta method after the first stand at ½, ½ and 1 of the step with the weights 2, 2,
// 1: their mean time, so that what is held constant over them acts as if it moved.
constexpr double kMeanOfLaterStages = 0.6;

class Engine : public SceneEngine {
 public:
  EngineStatistics statistics() const override { return statistics_; }

 protected:
  // `laws` and `bristle`: what `SceneForces` needs; `mjcf`: see to_mjcf.
  Engine(std::string name, const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
         const SolverSettings& solver, std::shared_ptr<const contact_nn::ContactModule> laws, const std::string& mjcf,
         std::optional<contact_nn::BristleFriction> bristle = {});

  // Before an evaluation at `time_` and before the stages of a step of `h` seconds from there.
  virtual void prepare_evaluation() {}
  virtual void prepare_stages(double h) {}
  // After the stages of a step of `h` seconds, before the evaluation at its end: what that needs of `integrals_`.
  virtual void finish_stages(double h, const std::vector<double>& rates_at_begin) {}
  // After an evaluation: `loads_` and `rates_`.
  virtual void read_loads() {}
  // After the stages of a step of `h` seconds and the evaluation at its end: adds ∫ rates dt to `integrals_`.
  virtual void integrate(double h, const std::vector<double>& rates_at_begin) = 0;
  virtual PassiveLaw* law() { return nullptr; }

  void fill_drives(double after);
  void write_rates(double work_in, double dissipated);

  // Whether steps are those of the Runge-Kutta method, with stages between; else one of MuJoCo's Euler methods.
  bool runge_kutta() const { return model_.model()->opt.integrator == mjINT_RK4; }

  ProcessHooks hooks_;
  const SceneForces forces_;
  Model model_;
  EngineStatistics statistics_;

  std::vector<crane_models::DriveMotion> drives_now_;  // at the evaluation at hand
  std::vector<BodyMotion> motions_;
  SceneLoads loads_;
  std::vector<double> rates_;  // of `integrals_`

 private:
  // What a step starts from, so that it can be taken again.
  struct Point {
    Time time = 0;
    std::vector<double> qpos, qvel, qacc, integrals, rates, reactions;
  };

  void place_start() override { model_.set_start(); }
  void evaluate() override;
  void restart() override { keep(point_); }
  StepResult advance_to(Time target) override;
  std::string recover(const std::runtime_error& failure) override;
  void save_motion(ByteWriter& out) const override;
  void restore_motion(ByteReader& in) override;
  const std::vector<BodyMotion>& motions() const override { return motions_; }
  const SceneLoads& loads() const override { return loads_; }
  void indicators(SceneForces::Indicators& out) const override {
    forces_.indicators(motions_, drives_now_, loads_, out);
  }
  double kinetic_energy() const override { return model_.kinetic_energy(); }
  double potential_energy() const override { return model_.potential_energy() + loads_.potential_energy; }

  template <typename Function>
  void run(const Function& function);
  void place_drives();
  void keep(Point& point) const;
  void rewind(const Point& point);
  void take_step(Time step);
  void retake_step(Time end);
  Time next_step(Time target) const;

  const StepLimit step_limit_;
  EventMonitor::SampleAt sample_at_;
  std::vector<double> reactions_;   // force of each driven joint's drive [N or N m]
  Point point_;                     // the last good state; while stepping: where the step at hand starts
};

}  // namespace quayside::harness::mujoco
