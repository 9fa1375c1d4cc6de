#include "harness/mujoco/step_limit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact_nn/potential_law.h"
#include "contact_nn/triangle_moments.h"

namespace quayside::harness::mujoco {
namespace {

using crane_models::JointType;
using crane_models::kWorld;

// A body's fastest mode over the square root of (stiffness that acts on it / its mass): ends of a uniform bar swing at
// √3 of its heave; two bodies against each other at √2.
constexpr double kModeFactor = 3;
constexpr double kLeastPhase = 0.01, kMostPhase = 0.5;  // [rad] per step
constexpr double kLockPhaseOverPhase = 3;
constexpr double kDamperPhase = 1, kFrictionPhase = 2;
constexpr double kDepthOfArrival = 1e-4;     // [m]
constexpr double kAccelerationsInG = 3;      // bound of what accelerates bodies before they meet, in gravity
constexpr double kLeastAcceleration = 10;    // the same where there is little gravity [m/s²]
constexpr double kLongestStep = 0.01;        // [s]
constexpr double kShortestStep = 1e-7;       // [s]

double largest_face(const Eigen::Vector3d& half) {
  const Eigen::Vector3d s = 2 * half;
  return std::max({s.x() * s.y(), s.y() * s.z(), s.z() * s.x()});
}

}  // namespace

double flat_stiffness(const crane_models::Scene& scene, const crane_models::ContactPair& pair,
                      const contact_nn::ContactSettings& contact) {
  if (contact.law == contact_nn::Law::points) return contact.stiffness;
  if (contact.law == contact_nn::Law::pads) return 2 * contact.stiffness;  // eight points of crossed faces
  const double area = std::min(largest_face(scene.bodies[pair.body_a].boxes[pair.box_a].half),
                               largest_face(scene.bodies[pair.body_b].boxes[pair.box_b].half));
  return contact.stiffness * std::pow(area / contact_nn::kReferenceArea, 2.0 / contact_nn::kNorm);
}

StepLimit::StepLimit(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
                     const SolverSettings& solver)
    : scene_(scene), contact_(contact), bristle_(contact_nn::bristle_friction(contact)), fixed_(solver.mujoco_step),
      max_step_(solver.max_step > 0 ? std::min(solver.max_step, kLongestStep) : kLongestStep),
      phase_(std::clamp(std::pow(120 * solver.relative_tolerance, 0.25), kLeastPhase, kMostPhase)),
      lock_phase_(std::min(kLockPhaseOverPhase * phase_, kMostPhase)),
      rotation_(12 * solver.relative_tolerance),
      gravity_(std::max(kAccelerationsInG * scene.gravity.norm(), kLeastAcceleration)),
      inverse_mass_(scene.bodies.size()), spring_(scene.bodies.size()), damper_(scene.bodies.size()) {
  // Welded bodies share the sum of their masses; what is welded to the world or to a driven body cannot give way.
  const int count = static_cast<int>(scene.bodies.size());
  std::vector<int> root(count);
  std::vector<double> mass(count, 0.0);
  for (int i = 0; i < count; ++i) {
    const auto& joint = scene.bodies[i].joint;
    root[i] = joint.type == JointType::fixed ? (joint.parent == kWorld ? kWorld : root[joint.parent]) : i;
    if (root[i] != kWorld) mass[root[i]] += scene.bodies[i].mass;
  }
  for (int i = 0; i < count; ++i) {
    const bool moves_freely = root[i] != kWorld && scene.bodies[root[i]].joint.drive < 0;
    inverse_mass_[i] = moves_freely ? 1 / mass[root[i]] : 0;
  }
  for (const auto& pair : scene.pairs) {
    pair_stiffness_.push_back(flat_stiffness(scene, pair, contact));
    const double inverse = inverse_mass(pair.body_a) + inverse_mass(pair.body_b);
    if (inverse == 0) continue;
    const double step = phase_ / std::sqrt(kModeFactor * pair_stiffness_.back() * inverse);
    arrival_step_ = arrival_step_ == 0 ? step : std::min(arrival_step_, step);
  }
}

double StepLimit::contact_step(const std::vector<BodyMotion>& bodies, const SceneLoads& loads) const {
  double step = arrival_step_;
  std::fill(spring_.begin(), spring_.end(), 0.0);
  for (std::size_t i = 0; i < scene_.pairs.size(); ++i) {
    const auto& pair = scene_.pairs[i];
    const double stiffness = pair_stiffness_[i];
    const double inverse = inverse_mass(pair.body_a) + inverse_mass(pair.body_b);
    if (inverse == 0) continue;
    if (loads.pairs[i].contact.touching) {
      spring_[pair.body_a] += stiffness;
      spring_[pair.body_b] += stiffness;
    }
    if (bristle_) {  // its spring is softer than the normal one
      step = std::min(step, kDamperPhase / (kModeFactor * bristle_->damping() * inverse));
    } else if (contact_.friction > 0) {
      // (μ/(m v_t)) (N + K v h) h = 1 for the step h.
      const BodyMotion &a = bodies[pair.body_a], &b = bodies[pair.body_b];
      const double speed = (b.v_WB - a.v_WB).norm();
      const double half = 0.5 * loads.pairs[i].contact.normal_force;
      const double budget = kFrictionPhase * contact_.transition_speed / (kModeFactor * contact_.friction * inverse);
      step = std::min(step, budget / (half + std::sqrt(half * half + stiffness * speed * budget)));
    }
  }
  for (std::size_t i = 0; i < spring_.size(); ++i) {
    const double square = kModeFactor * spring_[i] * inverse_mass_[i];
    if (square > 0) step = std::min(step, phase_ / std::sqrt(square));
  }
  return step;
}

double StepLimit::operator()(const SceneForces& forces, const std::vector<BodyMotion>& bodies,
                             const std::vector<crane_models::DriveMotion>& drives,
                             const std::vector<char>& locks_closed, const SceneLoads& loads) const {
  if (fixed_ > 0) return fixed_;
  double step = max_step_;

  std::fill(spring_.begin(), spring_.end(), 0.0);
  std::fill(damper_.begin(), damper_.end(), 0.0);
  for (const auto& rope : scene_.ropes) {
    const double rest_length = crane_models::rest_length(rope, drives).value;
    if (rest_length <= 0) continue;
    for (const int body : {rope.upper.body, rope.lower.body}) {
      if (body == kWorld) continue;
      spring_[body] += rope.axial_stiffness / rest_length;
      damper_[body] += rope.damping_time * rope.axial_stiffness / rest_length;
    }
  }
  const auto bound = [&](double phase) {
    for (std::size_t i = 0; i < spring_.size(); ++i) {
      const double square = kModeFactor * spring_[i] * inverse_mass_[i];
      if (square > 0) step = std::min(step, phase / std::sqrt(square));
      const double rate = kModeFactor * damper_[i] * inverse_mass_[i];
      if (rate > 0) step = std::min(step, kDamperPhase / rate);
    }
  };
  bound(phase_);
  for (std::size_t i = 0; i < scene_.locks.size(); ++i) {
    if (!locks_closed[i]) continue;
    const auto& lock = scene_.locks[i];
    const double pins = static_cast<double>(lock.pins.size());
    for (const int body : {lock.body_a, lock.body_b}) {
      spring_[body] += pins * lock.stiffness;
      damper_[body] += pins * lock.damping;
    }
  }
  bound(lock_phase_);

  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double spin = bodies[i].w_WB.norm();
    if (spin > 0) step = std::min(step, std::sqrt(rotation_ / (spin * spin * spin)));
  }

  if (arrival_step_ > 0) {
    bool touching = false;
    for (const auto& pair : loads.pairs) touching = touching || pair.contact.touching;
    const double flight = touching ? 0 : forces.time_to_contact(bodies, kDepthOfArrival, gravity_, locks_closed);
    if (flight < step) step = std::min(step, std::max(flight, contact_step(bodies, loads)));
  }
  return std::max(step, kShortestStep);
}

}  // namespace quayside::harness::mujoco
