#include "harness/simbody/simbody_unit.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "harness/scene_engine.h"
#include "harness/simbody/integrator.h"
#include "harness/simbody/multibody_model.h"

namespace quayside::harness {
namespace {

// What the local error of a coordinate may be, per unit of relative tolerance: the sizes of motions that matter in
// crane handling. Absolute, so that a result does not depend on where the world's origin lies.
constexpr double kPositionScale = 1.0;          // [m]
constexpr double kAngleScale = 0.2;             // [rad]: 1 m at the end of a 40 ft container and its spreader
constexpr double kQuaternionScale = 0.1;        // half an angle
constexpr double kVelocityScale = 1.0;          // [m/s]
constexpr double kAngularVelocityScale = 0.2;   // [rad/s]

// A step is bounded so that it ends at most this deep inside a box it has not seen [m]: at a stiffness of 6e8 N/m the
// contact then holds two fifths of the weight of a full container, an error that the integrator sees and cuts. What grazes
// a box less deeply may be missed.
constexpr double kBlindDepth = 2e-4;
constexpr double kAccelerationBound = 30.0;  // of what is not in contact: three times gravity [m/s²]
constexpr double kShortestBound = 1e-6;      // so that bounding cannot stall a step [s]

// BDF of order three and more is unstable for stiff oscillations without damping and rings in a contact at rest: what
// rounding leaves grows up to the tolerance. While bodies touch, the integrator watches its own stability; where a contact
// has lasted for kRestingTime, some periods, undisturbed by inputs, and what still moves is hardly more than the tolerance,
// order two, which is stable, is cheaper. The mean speed has to rise by a factor to leave it again: each change is a
// restart.
constexpr double kRestingTime = 0.1;       // [s]
constexpr double kRestingSpeed = 1e3;      // root of the mean square over all mass, per relative tolerance [m/s]
constexpr double kRestlessFactor = 4;
constexpr int kOrderInMotion = Integrator::kHighestOrder;
constexpr int kOrderAtRest = 2;

// Friction's rate, μ N/(m v), goes with the normal force, which an impact changes a hundredfold within some steps. With
// the Jacobian of another force an iteration of Newton's leaves a part of every error in the directions that friction
// damps; where prediction, which multiplies rounding by 2^(order + 1) − 1 a step, outdoes that, rounding grows up to the
// tolerance, a flat landing turns, and steps shrink. So the Jacobian, as far as speeds are concerned, is renewed where that
// part would exceed this.
constexpr double kLargestRemainder = 0.12;
constexpr double kImplicitPart = 0.4;  // of a step that its new rate contributes: 60/137 at order five

// Steps shrink before the moment at which a rope's rest length is used up, to fail at last within this of it [s].
constexpr double kSpentRopeOutlook = 1e-3;

constexpr double kFarAway = 1e12;  // a stop time that is none [s]

double scale(MultibodyModel::Quantity quantity) {
  switch (quantity) {
    case MultibodyModel::Quantity::position: return kPositionScale;
    case MultibodyModel::Quantity::angle: return kAngleScale;
    case MultibodyModel::Quantity::quaternion: return kQuaternionScale;
    case MultibodyModel::Quantity::velocity: return kVelocityScale;
    case MultibodyModel::Quantity::angular_velocity: return kAngularVelocityScale;
    case MultibodyModel::Quantity::deflection: return kPositionScale;
  }
  return 1;
}

std::vector<double> tolerances(const MultibodyModel& model, double relative_tolerance) {
  std::vector<double> result;
  for (const auto quantity : model.quantities()) result.push_back(relative_tolerance * scale(quantity));
  return result;
}

bool finite(const double* values, std::size_t count) {
  // A sum is finite only if all its terms are (or overflow, which is as bad): one test, and it vectorizes.
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += std::abs(values[i]);
  return std::isfinite(sum);
}

// The model as the integrator sees it.
class Dynamics final : public OdeSystem {
 public:
  Dynamics(MultibodyModel& model, const std::vector<crane_models::ContactGroup>& groups)
      : model_(model), groups_(groups) {}

  bool derivative(double t, const double* y, double* y_dot) override {
    last_caller_ = Caller::integrator;
    if (!finite(y, model_.size()) || model_.spent_rope(t) >= 0) return false;
    model_.derivative(t, y, y_dot);
    return finite(y_dot, model_.size());
  }

  bool quadrature(double t, const double* y, double* z_dot) override {
    last_caller_ = Caller::integrator_at_step_end;
    if (model_.driven_joints_move(t)) {
      scratch_.resize(model_.size());
      model_.derivative(t, y, scratch_.data());
    } else {
      model_.evaluate(t, y);
    }
    note_forces(at_step_end_);
    z_dot[kWorkIn] = model_.work_power();
    z_dot[kDissipated] = model_.dissipated_power();
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      Eigen::Map<Eigen::Vector3d>(z_dot + kImpulses + 3 * i) = group_force(groups_[i], model_.loads());
    }
    return finite(z_dot, kImpulses + 3 * groups_.size());
  }

  bool jacobian(double t, const double* y, const double* y_dot, double* jacobian) override {
    last_caller_ = Caller::integrator;
    if (model_.time() != t) model_.evaluate(t, y);
    // Other forces between the same pairs: stiffness is as it was, friction is not.
    forces_before_.swap(at_jacobian_);
    note_forces(at_jacobian_);
    const bool partly = std::exchange(renewal_, false) && same_pairs_touch(forces_before_, at_jacobian_);
    jacobian_.resize(static_cast<std::size_t>(model_.size()) * model_.size());
    model_.jacobian(t, y, y_dot, jacobian_.data(), partly ? MultibodyModel::Columns::speeds : MultibodyModel::Columns::all);
    std::copy(jacobian_.begin(), jacobian_.end(), jacobian);
    damping_rate_ = 0;
    for (int i = 0; i < model_.size(); ++i) {
      damping_rate_ = std::max(damping_rate_, -jacobian[static_cast<std::size_t>(i) * (model_.size() + 1)]);
    }
    return finite(jacobian, static_cast<std::size_t>(model_.size()) * model_.size());
  }

  // Whether steps as long as this one want another Jacobian, since contacts press otherwise than at the last one: see
  // kLargestRemainder. Forces below the weight of all that moves count as that weight.
  bool jacobian_is_old(double step) const {
    const double z = kImplicitPart * step * damping_rate_, stiff = z / (1 + z);
    for (std::size_t i = 0; i < at_jacobian_.size() && i < at_step_end_.size(); ++i) {
      const double before = at_jacobian_[i], now = at_step_end_[i];
      const double change = std::abs(now - before) / std::max(before, model_.moving_weight());
      if (change * (before > model_.moving_weight() ? stiff : 1) > kLargestRemainder) return true;
    }
    return false;
  }
  // Whether that is why the next Jacobian is asked for.
  void expect_renewal(bool expected) { renewal_ = expected; }

  // After a restart: the next step begins with a Jacobian anyhow.
  void forget_jacobian() {
    at_jacobian_.clear();
    renewal_ = false;
  }

  // Quaternions: onto the unit sphere, and errors onto its tangent.
  void project(const double* y, double* correction, double* error) override {
    std::fill_n(correction, model_.size(), 0.0);
    for (const int at : model_.quaternions()) {
      const Eigen::Map<const Eigen::Vector4d> quaternion(y + at);
      const Eigen::Vector4d unit = quaternion.normalized();
      Eigen::Map<Eigen::Vector4d>(correction + at) = unit - quaternion;
      if (error) {
        Eigen::Map<Eigen::Vector4d> e(error + at);
        e -= unit * unit.dot(e);
      }
    }
  }

  // Who evaluated the model last: the integrator (at the end of an accepted step or anywhere) or the unit.
  enum class Caller { integrator, integrator_at_step_end, unit };
  Caller last_caller() const { return last_caller_; }
  void evaluate(double t, double* y) {
    last_caller_ = Caller::unit;
    for (const int at : model_.quaternions()) Eigen::Map<Eigen::Vector4d>(y + at).normalize();
    model_.evaluate(t, y);
  }

 private:
  void note_forces(std::vector<double>& forces) const {
    forces.clear();
    for (const PairLoad& load : model_.loads().pairs) forces.push_back(load.contact.normal_force);
  }

  static bool same_pairs_touch(const std::vector<double>& a, const std::vector<double>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) { return (x > 0) == (y > 0); });
  }

  MultibodyModel& model_;
  const std::vector<crane_models::ContactGroup>& groups_;
  std::vector<double> scratch_;
  std::vector<double> jacobian_;                                   // the last one
  std::vector<double> at_jacobian_, at_step_end_, forces_before_;  // normal force of each pair [N]
  bool renewal_ = false;
  double damping_rate_ = 0;      // the highest of a speed, there [1/s]
  Caller last_caller_ = Caller::unit;
};

// The integrator runs ahead: it takes its own steps, at most one beyond the communication time, and the unit's state
// there is dense output. History is dropped only where the motion has a corner: at inputs that change a drive or a
// lock, when a contact comes to rest (see kRestingTime), and at a save. Where the integrator had run ahead under
// inputs that change now, the restart at the communication time is also what takes it back.
class SimbodyUnit final : public SceneEngine {
 public:
  SimbodyUnit(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
              const SolverSettings& solver)
      : SceneEngine("simbody", scene, solver),
        relative_tolerance_(solver.relative_tolerance),
        model_(scene_, contact_nn::make_contact_module(contact), contact_nn::bristle_friction(contact),
               solver.free_bodies == "direct"),
        dynamics_(model_, monitor_.groups()),
        integrator_(make_integrator(solver.integrator, dynamics_,
                                    {tolerances(model_, solver.relative_tolerance),
                                     static_cast<int>(integrals_.size()), solver.max_step, model_.blocks()})),
        y_(model_.size()),
        y_then_(y_.size()),
        integrals_then_(integrals_.size()),
        step_end_{monitor_.make_sample(), integrals_then_} {
    sample_at_ = [this](double t, EventMonitor::Sample& sample) { look(t, sample); };
    reset();
  }

  EngineStatistics statistics() const override;

 private:
  void place_start() override;
  void evaluate() override;
  void hold_contacts(bool hold) override { model_.hold_contacts(hold); }
  void restart() override { running_ = false; }
  StepResult advance_to(Time target) override;
  std::string recover(const std::runtime_error& failure) override;
  void save_motion(ByteWriter& out) const override;
  void restore_motion(ByteReader& in) override;
  const std::vector<BodyMotion>& motions() const override { return model_.motions(); }
  const SceneLoads& loads() const override { return model_.loads(); }
  void indicators(SceneForces::Indicators& out) const override { model_.indicators(out); }
  double kinetic_energy() const override { return model_.kinetic_energy(); }
  double potential_energy() const override { return model_.potential_energy(); }

  void take_inputs();
  int order_now() const;
  void restart_integrator(double t, int max_order, const std::vector<double>& y, const std::vector<double>& integrals);
  void integrate_once();
  void look_ahead();
  void settle(Time time);
  void look(double t, EventMonitor::Sample& sample);

  const double relative_tolerance_;
  MultibodyModel model_;
  Dynamics dynamics_;
  const std::unique_ptr<Integrator> integrator_;
  EventMonitor::SampleAt sample_at_;

  std::vector<double> y_;                        // at time_
  std::vector<double> y_then_, integrals_then_;  // where `look` looked last
  // Where the integrator stands, noted while the model stands there too: output rows within the step move the model.
  struct StepEnd {
    EventMonitor::Sample sample;
    std::vector<double> integrals;
    double kinetic = 0, potential = 0;  // [J]
    double free_flight = 0;             // until a contact may be made [s]
  } step_end_;
  bool running_ = false;             // the integrator's history holds time_
  double disturbed_at_ = 0;          // when it was started last: at inputs, a save, a restore [s]
  int max_order_ = kOrderInMotion;
};

EngineStatistics SimbodyUnit::statistics() const {
  EngineStatistics statistics;
  statistics.steps = integrator_->steps();
  statistics.rhs_evaluations = model_.evaluations;
  statistics.jacobians = integrator_->jacobians();
  statistics.contact = model_.contact_counters;
  return statistics;
}

// --- State ----------------------------------------------------------------------------------------------------------

void SimbodyUnit::take_inputs() {
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    model_.set_drive(static_cast<int>(i), seconds(drives_[i].since), drives_[i].motion);
  }
  for (std::size_t i = 0; i < locks_closed_.size(); ++i) model_.set_lock(static_cast<int>(i), locks_closed_[i]);
}

void SimbodyUnit::place_start() {
  take_inputs();
  model_.start(seconds(time_), y_.data());
}

void SimbodyUnit::evaluate() {
  take_inputs();
  dynamics_.evaluate(seconds(time_), y_.data());
}

void SimbodyUnit::save_motion(ByteWriter& out) const {
  out.put(y_.data(), y_.size());
}

void SimbodyUnit::restore_motion(ByteReader& in) {
  in.get(y_.data(), y_.size());
}

// --- Stepping -------------------------------------------------------------------------------------------------------

// Fills `sample` from the dense output at t, where the model is evaluated unless it stands there already.
void SimbodyUnit::look(double t, EventMonitor::Sample& sample) {
  integrator_->interpolate(t, y_then_.data(), integrals_then_.data());
  if (dynamics_.last_caller() == Dynamics::Caller::integrator || model_.time() != t) {
    dynamics_.evaluate(t, y_then_.data());
  }
  fill(t, integrals_then_, sample);
}

// Makes the dense output at `time` the state on the interface. What the unit shows there comes from that state alone,
// so that a restored unit shows the same.
void SimbodyUnit::settle(Time time) {
  time_ = time;
  if (dynamics_.last_caller() == Dynamics::Caller::unit && model_.time() == seconds(time)) {  // by `look`
    y_ = y_then_;
    integrals_ = integrals_then_;
    if (begin_.time == seconds(time)) return publish();
  } else {
    // An event's whole nanosecond, or that of the last good step, may lie just outside of the integrator's step.
    const double t = std::clamp(seconds(time), integrator_->step_begin(), integrator_->time());
    integrator_->interpolate(t, y_.data(), integrals_.data());
    dynamics_.evaluate(seconds(time), y_.data());
  }
  fill(seconds(time), integrals_, begin_);
  publish();
}

// The highest order to use now.
int SimbodyUnit::order_now() const {
  const double speed_limit = kRestingSpeed * relative_tolerance_ * (max_order_ == kOrderAtRest ? kRestlessFactor : 1);
  if (ledger_.kinetic > 0.5 * model_.moving_mass() * speed_limit * speed_limit) return kOrderInMotion;
  for (std::size_t i = 0; i < monitor_.groups().size(); ++i) {
    const int group = static_cast<int>(i);
    const double since = std::max(monitor_.touching_since(group), disturbed_at_);
    if (monitor_.touching(group) && begin_.time - since > kRestingTime) return kOrderAtRest;
  }
  return kOrderInMotion;
}

void SimbodyUnit::restart_integrator(double t, int max_order, const std::vector<double>& y,
                                     const std::vector<double>& integrals) {
  max_order_ = max_order;
  integrator_->restart(t, y.data(), integrals.data(), max_order);
  dynamics_.forget_jacobian();
}

// The integrator's next step, from where the monitor stands.
void SimbodyUnit::integrate_once() {
  const double t = integrator_->time();
  const int order = order_now();
  if (order != max_order_) {
    look(t, step_end_.sample);
    restart_integrator(t, order, y_then_, integrals_then_);
  }
  bool touching = false;
  for (std::size_t i = 0; i < monitor_.groups().size(); ++i) touching |= monitor_.touching(static_cast<int>(i));
  integrator_->watch_stability(touching);
  dynamics_.expect_renewal(dynamics_.jacobian_is_old(t - integrator_->step_begin()) && integrator_->renew_jacobian());
  integrator_->step(t + std::clamp(step_end_.free_flight, kShortestBound, kFarAway));
  look_ahead();
}

void SimbodyUnit::look_ahead() {
  look(integrator_->time(), step_end_.sample);
  step_end_.integrals = integrals_then_;
  step_end_.kinetic = model_.kinetic_energy();
  step_end_.potential = model_.potential_energy();
  step_end_.free_flight = model_.time_to_contact(kBlindDepth, kAccelerationBound);
}

// Integrator steps and communication steps know nothing of each other: the monitor goes along the dense output in
// pieces that end where either of them does.
StepResult SimbodyUnit::advance_to(Time target) {
  while (begin_.time < seconds(target)) {
    if (!running_) {
      disturbed_at_ = seconds(time_);
      restart_integrator(disturbed_at_, kOrderInMotion, y_, integrals_);
      look_ahead();
      running_ = true;
    }
    if (integrator_->time() <= begin_.time) integrate_once();
    if (integrator_->time() <= seconds(target)) {
      end_ = step_end_.sample;
      update_ledger(step_end_.integrals, step_end_.kinetic, step_end_.potential);
    } else {
      look(seconds(target), end_);
      update_ledger(integrals_then_);
    }
    check_depths(end_);
    const auto flip = monitor_.advance(begin_, end_, sample_at_);
    if (flip && *flip <= target) {
      settle(*flip);
      return {time_, true, false};
    }
    std::swap(begin_, end_);
  }
  settle(target);
  return {time_, false, false};
}

std::string SimbodyUnit::recover(const std::runtime_error& failure) {
  settle(std::max(time_, static_cast<Time>(std::floor(begin_.time / kNanosecond))));
  running_ = false;
  const int rope = model_.spent_rope(integrator_->time() + kSpentRopeOutlook);
  return rope < 0 ? failure.what() : scene_.ropes[rope].name + " is hoisted in to its end";
}

}  // namespace

std::unique_ptr<EngineUnit> make_simbody_engine(const crane_models::Scene& scene,
                                                const contact_nn::ContactSettings& contact,
                                                const SolverSettings& solver) {
  return std::make_unique<SimbodyUnit>(scene, contact, solver);
}

}  // namespace quayside::harness
