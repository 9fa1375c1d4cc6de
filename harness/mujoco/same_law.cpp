#include "harness/mujoco/same_law.h"

#include <algorithm>

#include "harness/mujoco/mjcf.h"

namespace quayside::harness::mujoco {
namespace {

constexpr int kLastStage = 4;
// Weights of the classical method.
constexpr double kOuterWeight = 1.0 / 6, kInnerWeight = 1.0 / 3;

std::string bodies_alone(const crane_models::Scene& scene) {
  MjcfOptions options;
  options.native = false;
  return to_mjcf(scene, options);
}

}  // namespace

SameLawEngine::SameLawEngine(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
                             const SolverSettings& solver)
    : Engine("mujoco_same_law", scene, contact, solver, contact_nn::make_contact_module(contact), bodies_alone(scene),
             contact_nn::bristle_friction(contact)),
      first_bristle_(integrals_.size()), stage_(kLastStage + 1) {
  integrals_.resize(first_bristle_ + contact_nn::Bristle::SizeAtCompileTime * loads_.bristles.size());
  rates_.resize(integrals_.size());
  stage_sum_.resize(integrals_.size());
  reset();
}

// What the bristles are `after` seconds from `time_`, at the rates of the last evaluation.
void SameLawEngine::place_bristles(double after) {
  const double *z = integrals_.data() + first_bristle_, *rate = rates_.data() + first_bristle_;
  for (contact_nn::Bristle& bristle : loads_.bristles) {
    for (double& component : bristle) component = *z++ + after * *rate++;
  }
}

void SameLawEngine::prepare_stages(double h) {
  if (!runge_kutta()) return;
  step_ = h;
  stage_ = 2;
  std::fill(stage_sum_.begin(), stage_sum_.end(), 0.0);
}

void SameLawEngine::add_passive_forces(const mjModel*, mjData* data) {
  ++statistics_.rhs_evaluations;
  fill_drives(data->time);
  model_.read_motions(motions_);
  if (stage_ <= kLastStage) place_bristles(stage_ == kLastStage ? step_ : 0.5 * step_);
  forces_.evaluate(motions_, drives_now_, locks_closed_, loads_, statistics_.contact);
  model_.add_forces(loads_.bodies, data->qfrc_passive);
  write_rates(loads_.rope_work_in, loads_.dissipated_power + model_.joint_damping_power());
  double* bristle_rate = rates_.data() + first_bristle_;
  for (const contact_nn::Bristle& rate : loads_.bristle_rates) {
    bristle_rate = std::copy(rate.begin(), rate.end(), bristle_rate);
  }
  if (stage_ > kLastStage) return;
  const double weight = stage_++ == kLastStage ? kOuterWeight : kInnerWeight;
  for (std::size_t i = 0; i < rates_.size(); ++i) stage_sum_[i] += weight * rates_[i];
}

// Runge-Kutta's integrals are complete without the end of the step, and its bristles are wanted there; Euler's method takes
// these at the rates of the begin.
void SameLawEngine::finish_stages(double h, const std::vector<double>& rates_at_begin) {
  if (!runge_kutta()) {
    for (std::size_t i = first_bristle_; i < rates_.size(); ++i) integrals_[i] += h * rates_at_begin[i];
    return;
  }
  if (stage_ != kLastStage + 1) throw MujocoError("the passive-force callback was replaced while a unit was stepping");
  for (std::size_t i = 0; i < rates_.size(); ++i) {
    integrals_[i] += h * (kOuterWeight * rates_at_begin[i] + stage_sum_[i]);
  }
}

void SameLawEngine::integrate(double h, const std::vector<double>& rates_at_begin) {
  if (runge_kutta()) return;
  for (std::size_t i = 0; i < first_bristle_; ++i) integrals_[i] += 0.5 * h * (rates_at_begin[i] + rates_[i]);
}

}  // namespace quayside::harness::mujoco
