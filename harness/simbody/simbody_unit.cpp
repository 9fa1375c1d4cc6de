#include "harness/simbody/simbody_unit.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "harness/engine_outputs.h"
#include "harness/event_monitor.h"
#include "harness/simbody/bdf_integrator.h"
#include "harness/simbody/multibody_model.h"
#include "harness/state_bytes.h"

namespace quayside::harness {
namespace {

using crane_models::DriveMotion;

// What the local error of a coordinate may be, per unit of relative tolerance: the sizes of motions that matter in
// crane handling. Absolute, so that a result does not depend on where the world's origin lies.
constexpr double kPositionScale = 1.0;          // [m]
constexpr double kAngleScale = 0.2;             // [rad]: 1 m at the end of a 40 ft container and its spreader
constexpr double kQuaternionScale = 0.1;        // half an angle
constexpr double kVelocityScale = 1.0;          // [m/s]
constexpr double kAngularVelocityScale = 0.2;   // [rad/s]
constexpr double kLargestRelativeTolerance = 1e-2;

// A step is bounded so that it ends at most this deep inside a box it has not seen [m]: at a stiffness of 6e8 N/m the
// contact then holds twice the weight of a full container, an error that the integrator sees and cuts.
constexpr double kBlindDepth = 1e-3;
constexpr double kAccelerationBound = 30.0;  // of what is not in contact: three times gravity [m/s²]
constexpr double kShortestBound = 1e-6;      // so that bounding cannot stall a step [s]

// BDF of order three and more is unstable for stiff oscillations without damping and rings in a contact at rest. While
// bodies touch, the integrator watches its own stability; where a contact has lasted for kRestingTime and what still
// moves is hardly more than the tolerance, order two, which is stable, is cheaper. The mean speed has to rise by a
// factor to leave it again: each change is a restart.
constexpr double kRestingTime = 1.0;       // [s]
constexpr double kRestingSpeed = 1e4;      // root of the mean square over all mass, per relative tolerance [m/s]
constexpr double kRestlessFactor = 4;
constexpr int kOrderInMotion = 5;
constexpr int kOrderAtRest = 2;

// A box this far inside another, as a fraction of the smaller of their half extents, would come out on the far side.
constexpr double kAlarmingDepth = 0.5;

// Inputs of a drive that differ by less from its present motion do not change it [m or rad, and per second].
constexpr double kSameMotion = 1e-9;

// Inputs of drives beyond this are mistakes, and would overflow further on [m or rad, per second and per second
// squared].
constexpr double kLargestInput = 1e6;

// Steps shrink before the moment at which a rope's rest length is used up, to fail at last within this of it [s].
constexpr double kSpentRopeOutlook = 1e-3;

constexpr double kFarAway = 1e12;  // a stop time that is none [s]

// Quadratures: work in, dissipated, then three components of impulse per contact group.
constexpr int kWorkIn = 0, kDissipated = 1, kImpulses = 2;

double scale(MultibodyModel::Quantity quantity) {
  switch (quantity) {
    case MultibodyModel::Quantity::position: return kPositionScale;
    case MultibodyModel::Quantity::angle: return kAngleScale;
    case MultibodyModel::Quantity::quaternion: return kQuaternionScale;
    case MultibodyModel::Quantity::velocity: return kVelocityScale;
    case MultibodyModel::Quantity::angular_velocity: return kAngularVelocityScale;
  }
  return 1;
}

std::vector<double> tolerances(const MultibodyModel& model, double relative_tolerance) {
  if (!(relative_tolerance > 0 && relative_tolerance <= kLargestRelativeTolerance)) {
    throw std::invalid_argument(fmt::format("solver.relative_tolerance is {}: give a value in (0, {}]",
                                            relative_tolerance, kLargestRelativeTolerance));
  }
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
    if (model_.has_driven_joints()) {
      scratch_.resize(model_.size());
      model_.derivative(t, y, scratch_.data());
    } else {
      model_.evaluate(t, y);
    }
    z_dot[kWorkIn] = model_.work_power();
    z_dot[kDissipated] = model_.dissipated_power();
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      Eigen::Map<Eigen::Vector3d>(z_dot + kImpulses + 3 * i) = group_force(groups_[i], model_.loads());
    }
    return finite(z_dot, kImpulses + 3 * groups_.size());
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
  MultibodyModel& model_;
  const std::vector<crane_models::ContactGroup>& groups_;
  std::vector<double> scratch_;
  Caller last_caller_ = Caller::unit;
};

enum class Mode : std::uint8_t { instantiated, initialization, event, step, terminated };

const char* to_string(Mode mode) {
  switch (mode) {
    case Mode::instantiated: return "instantiated";
    case Mode::initialization: return "in initialization mode";
    case Mode::event: return "in event mode";
    case Mode::step: return "in step mode";
    case Mode::terminated: return "terminated";
  }
  return "";
}

// The integrator runs ahead: it takes its own steps, at most one beyond the communication time, and the unit's state
// there is dense output. History is dropped only where the motion has a corner: at inputs that change a drive or a
// lock, when a contact comes to rest (see kRestingTime), and at a save. Where the integrator had run ahead under
// inputs that change now, the restart at the communication time is also what takes it back.
class SimbodyUnit final : public EngineUnit {
 public:
  SimbodyUnit(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
              const SolverSettings& solver)
      : scene_(scene),
        variables_(engine_variables(scene_)),
        relative_tolerance_(solver.relative_tolerance),
        model_(scene_, contact_nn::make_contact_module(contact)),
        monitor_(scene_),
        dynamics_(model_, monitor_.groups()),
        integrator_(dynamics_, tolerances(model_, solver.relative_tolerance),
                    kImpulses + 3 * static_cast<int>(monitor_.groups().size()), solver.max_step),
        inputs_(3 * scene_.drives.size() + scene_.commands.size()),
        input_is_set_(inputs_.size()),
        y_(model_.size()),
        z_(kImpulses + 3 * monitor_.groups().size()),
        y_then_(y_.size()),
        z_then_(z_.size()),
        begin_(monitor_.make_sample()),
        end_(monitor_.make_sample()) {
    for (const auto& pair : scene_.pairs) {
      alarming_depths_.push_back(kAlarmingDepth *
                                 std::min(scene_.bodies[pair.body_a].boxes[pair.box_a].half.minCoeff(),
                                          scene_.bodies[pair.body_b].boxes[pair.box_b].half.minCoeff()));
    }
    sample_at_ = [this](double t, EventMonitor::Sample& sample) { look(t, sample); };
    reset();
  }

  const std::string& name() const override { return name_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  double get(ValueReference variable) const override;
  void set(ValueReference variable, double value) override;
  void enter_initialization_mode(Time start) override;
  void exit_initialization_mode() override;
  void enter_event_mode() override;
  std::optional<Time> update_discrete_states() override;
  void enter_step_mode() override;
  StepResult do_step(Time now, Time step) override;
  UnitState save() override;
  void restore(const UnitState& state) override;
  void terminate() override { mode_ = Mode::terminated; }
  void reset() override;
  std::vector<Event> take_events() override { return monitor_.take_events(); }
  std::vector<Event> open_contacts() const override { return monitor_.open_contacts(begin_); }
  EnergyLedger energy() const override { return ledger_; }
  EngineStatistics statistics() const override;

 private:
  void demand(Mode mode, const char* what) const;
  void begin_simulation();
  void apply_inputs();
  bool change_drive(std::size_t drive);
  int order_now() const;
  void integrate_once();
  void settle(Time time);
  void look(double t, EventMonitor::Sample& sample);
  void fill(double t, const double* z, EventMonitor::Sample& sample) const;
  void update_ledger(const std::vector<double>& z);
  void check_depths(const EventMonitor::Sample& sample) const;
  void publish();

  const std::string name_ = "simbody";
  const crane_models::Scene scene_;
  const std::vector<Variable> variables_;
  const double relative_tolerance_;
  MultibodyModel model_;
  EventMonitor monitor_;
  Dynamics dynamics_;
  BdfIntegrator integrator_;
  std::vector<double> alarming_depths_;  // per pair [m]
  EventMonitor::SampleAt sample_at_;

  Mode mode_ = Mode::instantiated;
  Time time_ = 0;
  std::vector<double> inputs_;       // as last set
  std::vector<char> input_is_set_;   // since they were last applied
  std::vector<double> y_, z_;        // at time_
  std::vector<double> y_then_, z_then_;
  std::vector<double> outputs_;
  EnergyLedger ledger_;
  double kinetic_start_ = 0, potential_start_ = 0;  // [J]
  EventMonitor::Sample begin_, end_;  // begin_: where the monitor stands
  bool running_ = false;             // the integrator's history holds time_
  int max_order_ = kOrderInMotion;   // now and, for the hysteresis of kRestlessFactor, in saved states
};

void SimbodyUnit::demand(Mode mode, const char* what) const {
  if (mode_ != mode) {
    throw std::logic_error(fmt::format("simbody: {} is not possible while the unit is {}", what, to_string(mode_)));
  }
}

void SimbodyUnit::reset() {
  mode_ = Mode::instantiated;
  time_ = 0;
  for (std::size_t i = 0; i < inputs_.size(); ++i) inputs_[i] = variables_[i].start;
  std::fill(input_is_set_.begin(), input_is_set_.end(), false);
  for (std::size_t i = 0; i < scene_.locks.size(); ++i) model_.set_lock(static_cast<int>(i), scene_.locks[i].closed);
  begin_simulation();
}

// --- Variables ------------------------------------------------------------------------------------------------------

void SimbodyUnit::set(ValueReference variable, double value) {
  if (variable >= variables_.size() || variables_[variable].causality != Causality::input) {
    throw std::invalid_argument(fmt::format("simbody: variable {} is not an input", variable));
  }
  if (!(std::abs(value) <= kLargestInput)) {
    throw std::invalid_argument(fmt::format("simbody: {} cannot be {}: at most {} either way",
                                            variables_[variable].name, value, kLargestInput));
  }
  inputs_[variable] = value;
  input_is_set_[variable] = true;
  if (mode_ == Mode::initialization) begin_simulation();
}

double SimbodyUnit::get(ValueReference variable) const {
  if (variable >= variables_.size()) {
    throw std::invalid_argument(fmt::format("simbody: there is no variable {}", variable));
  }
  const std::size_t i = variable;
  if (i < inputs_.size()) {
    if (input_is_set_[i] || i >= 3 * scene_.drives.size()) return inputs_[i];
    const DriveMotion now = model_.drive(static_cast<int>(i / 3), seconds(time_));
    return i % 3 == 0 ? now.value : i % 3 == 1 ? now.rate : now.acceleration;
  }
  return outputs_[i - inputs_.size()];
}

// What the interface shows, from the model's last evaluation and the ledger.
void SimbodyUnit::publish() {
  write_outputs(scene_, model_.motions(), model_.loads(), monitor_, ledger_, outputs_);
}

EngineStatistics SimbodyUnit::statistics() const {
  EngineStatistics statistics;
  statistics.steps = integrator_.steps();
  statistics.rhs_evaluations = model_.evaluations;
  statistics.jacobians = integrator_.jacobians();
  statistics.contact = model_.contact_counters;
  return statistics;
}

// --- Life cycle -----------------------------------------------------------------------------------------------------

void SimbodyUnit::enter_initialization_mode(Time start) {
  demand(Mode::instantiated, "entering initialization mode");
  mode_ = Mode::initialization;
  time_ = start;
  begin_simulation();
}

// Everything from the start values and the inputs as set.
void SimbodyUnit::begin_simulation() {
  const double t = seconds(time_);
  for (std::size_t i = 0; i < scene_.drives.size(); ++i) {
    model_.set_drive(static_cast<int>(i), t, {inputs_[3 * i], inputs_[3 * i + 1], inputs_[3 * i + 2]});
  }
  for (std::size_t i = 0; i < scene_.locks.size(); ++i) {
    const int command = scene_.locks[i].command;
    if (command >= 0) model_.set_lock(static_cast<int>(i), inputs_[3 * scene_.drives.size() + command] != 0);
  }
  model_.start(t, y_.data());
  std::fill(z_.begin(), z_.end(), 0.0);
  running_ = false;
  dynamics_.evaluate(t, y_.data());
  fill(t, z_.data(), begin_);
  monitor_.start(begin_);
  max_order_ = kOrderInMotion;
  ledger_ = EnergyLedger{};
  kinetic_start_ = model_.kinetic_energy();
  potential_start_ = model_.potential_energy();
  ledger_.start = kinetic_start_ + potential_start_;
  update_ledger(z_);
  publish();
}

void SimbodyUnit::exit_initialization_mode() {
  demand(Mode::initialization, "leaving initialization mode");
  begin_simulation();
  std::fill(input_is_set_.begin(), input_is_set_.end(), false);
  mode_ = Mode::event;
}

void SimbodyUnit::enter_event_mode() {
  if (mode_ == Mode::event) return;
  demand(Mode::step, "entering event mode");
  mode_ = Mode::event;
}

std::optional<Time> SimbodyUnit::update_discrete_states() {
  demand(Mode::event, "updating discrete states");
  apply_inputs();
  return std::nullopt;
}

void SimbodyUnit::enter_step_mode() {
  if (mode_ == Mode::step) return;
  demand(Mode::event, "entering step mode");
  mode_ = Mode::step;
}

// --- Inputs ---------------------------------------------------------------------------------------------------------

// True when the drive's inputs, where they were set, ask for another motion than the one it has.
bool SimbodyUnit::change_drive(std::size_t drive) {
  const double t = seconds(time_);
  const DriveMotion now = model_.drive(static_cast<int>(drive), t);
  const auto wanted = [&](std::size_t component, double present) {
    const std::size_t i = 3 * drive + component;
    return std::exchange(input_is_set_[i], false) ? inputs_[i] : present;
  };
  const DriveMotion motion{wanted(0, now.value), wanted(1, now.rate), wanted(2, now.acceleration)};
  const bool same = std::abs(motion.value - now.value) <= kSameMotion &&
                    std::abs(motion.rate - now.rate) <= kSameMotion &&
                    std::abs(motion.acceleration - now.acceleration) <= kSameMotion;
  if (!same) model_.set_drive(static_cast<int>(drive), t, motion);
  return !same;
}

// Energy that jumps is booked: what an opening lock held is lost, and whoever closes a strained lock or moves a drive
// at one stroke has put it in.
void SimbodyUnit::apply_inputs() {
  if (std::none_of(input_is_set_.begin(), input_is_set_.end(), [](char set) { return set; })) return;
  bool changed = false;
  for (std::size_t i = 0; i < scene_.drives.size(); ++i) changed |= change_drive(i);
  for (std::size_t i = 0; i < scene_.locks.size(); ++i) {
    const int command = scene_.locks[i].command;
    if (command < 0) continue;
    const bool closed = inputs_[3 * scene_.drives.size() + command] != 0;
    if (closed == model_.lock_closed(static_cast<int>(i))) continue;
    model_.set_lock(static_cast<int>(i), closed);
    monitor_.note_lock(time_, static_cast<int>(i), closed);
    changed = true;
  }
  std::fill(input_is_set_.begin(), input_is_set_.end(), false);
  if (!changed) return;

  const double before = ledger_.kinetic + ledger_.potential;
  dynamics_.evaluate(seconds(time_), y_.data());
  const double gained = model_.kinetic_energy() + model_.potential_energy() - before;
  z_[gained > 0 ? kWorkIn : kDissipated] += std::abs(gained);
  fill(seconds(time_), z_.data(), begin_);
  update_ledger(z_);
  publish();
  running_ = false;
}

// --- Stepping -------------------------------------------------------------------------------------------------------

void SimbodyUnit::fill(double t, const double* z, EventMonitor::Sample& sample) const {
  sample.time = t;
  model_.indicators(sample.indicators);
  for (std::size_t i = 0; i < monitor_.groups().size(); ++i) {
    sample.impulses[i] = Eigen::Map<const Eigen::Vector3d>(z + kImpulses + 3 * i);
    sample.forces[i] = group_force(monitor_.groups()[i], model_.loads()).norm();
  }
}

// Fills `sample` from the dense output at t, where the model is evaluated unless it stands there already.
void SimbodyUnit::look(double t, EventMonitor::Sample& sample) {
  integrator_.interpolate(t, y_then_.data(), z_then_.data());
  if (dynamics_.last_caller() == Dynamics::Caller::integrator || model_.time() != t) {
    dynamics_.evaluate(t, y_then_.data());
  }
  fill(t, z_then_.data(), sample);
}

// Makes the dense output at `time` the state on the interface. What the unit shows there comes from that state alone,
// so that a restored unit shows the same.
void SimbodyUnit::settle(Time time) {
  time_ = time;
  if (dynamics_.last_caller() == Dynamics::Caller::unit && model_.time() == seconds(time)) {  // by `look`
    y_ = y_then_;
    z_ = z_then_;
  } else {
    // An event's whole nanosecond, or that of the last good step, may lie just outside of the integrator's step.
    const double t = std::clamp(seconds(time), integrator_.step_begin(), integrator_.time());
    integrator_.interpolate(t, y_.data(), z_.data());
    dynamics_.evaluate(seconds(time), y_.data());
  }
  fill(seconds(time), z_.data(), begin_);
  update_ledger(z_);
  publish();
}

// From the model's last evaluation and the quadratures there.
void SimbodyUnit::update_ledger(const std::vector<double>& z) {
  ledger_.kinetic = model_.kinetic_energy();
  ledger_.potential = model_.potential_energy();
  ledger_.work_in = z[kWorkIn];
  ledger_.dissipated = z[kDissipated];
  ledger_.largest_exchange =
      std::max({ledger_.largest_exchange, std::abs(ledger_.kinetic - kinetic_start_),
                std::abs(ledger_.potential - potential_start_), std::abs(ledger_.work_in), ledger_.dissipated});
}

// The highest order to use now.
int SimbodyUnit::order_now() const {
  const double speed_limit = kRestingSpeed * relative_tolerance_ * (max_order_ == kOrderAtRest ? kRestlessFactor : 1);
  if (ledger_.kinetic > 0.5 * model_.moving_mass() * speed_limit * speed_limit) return kOrderInMotion;
  for (std::size_t i = 0; i < monitor_.groups().size(); ++i) {
    const int group = static_cast<int>(i);
    if (monitor_.touching(group) && begin_.time - monitor_.touching_since(group) > kRestingTime) return kOrderAtRest;
  }
  return kOrderInMotion;
}

// The integrator's next step, from where the monitor stands.
void SimbodyUnit::integrate_once() {
  const double t = integrator_.time();
  const int order = order_now();
  if (order != max_order_ || model_.time() != t) look(t, end_);
  if (order != max_order_) {
    integrator_.restart(t, y_then_.data(), z_then_.data(), max_order_ = order);
  }
  bool touching = false;
  for (std::size_t i = 0; i < monitor_.groups().size(); ++i) touching |= monitor_.touching(static_cast<int>(i));
  integrator_.watch_stability(touching);
  const double free_flight = model_.time_to_contact(kBlindDepth, kAccelerationBound);
  integrator_.step(t + std::clamp(free_flight, kShortestBound, kFarAway));
}

// Integrator steps and communication steps know nothing of each other: the monitor goes along the dense output in
// pieces that end where either of them does.
StepResult SimbodyUnit::do_step(Time now, Time step) {
  demand(Mode::step, "a step");
  if (now != time_) {
    throw std::invalid_argument(fmt::format("simbody: a step from {} ns, but the unit is at {} ns", now, time_));
  }
  if (step <= 0) throw std::invalid_argument(fmt::format("simbody: a step of {} ns", step));
  apply_inputs();
  const Time target = now + step;
  try {
    while (begin_.time < seconds(target)) {
      if (!running_) {
        integrator_.restart(seconds(time_), y_.data(), z_.data(), max_order_ = order_now());
        running_ = true;
      }
      if (integrator_.time() <= begin_.time) integrate_once();
      look(std::min(integrator_.time(), seconds(target)), end_);
      check_depths(end_);
      update_ledger(z_then_);
      const auto flip = monitor_.advance(begin_, end_, sample_at_);
      if (flip && *flip <= target) {
        settle(*flip);
        return {time_, true, false};
      }
      std::swap(begin_, end_);
    }
  } catch (const IntegrationFailed& failure) {
    settle(std::max(time_, static_cast<Time>(std::floor(begin_.time / kNanosecond))));
    running_ = false;
    const int rope = model_.spent_rope(integrator_.time() + kSpentRopeOutlook);
    throw StepFailed(name_, time_, rope < 0 ? failure.what() : scene_.ropes[rope].name + " is hoisted in to its end");
  }
  settle(target);
  return {time_, false, false};
}

// --- State ----------------------------------------------------------------------------------------------------------

UnitState SimbodyUnit::save() {
  ByteWriter out;
  out.put(mode_);
  out.put(time_);
  out.put(inputs_.data(), inputs_.size());
  for (const char set : input_is_set_) out.put(set);
  for (std::size_t i = 0; i < scene_.drives.size(); ++i) {
    const double reference = model_.drive_reference(static_cast<int>(i));
    const DriveMotion motion = model_.drive(static_cast<int>(i), reference);
    out.put(reference);
    out.put(motion.value);
    out.put(motion.rate);
    out.put(motion.acceleration);
  }
  for (std::size_t i = 0; i < scene_.locks.size(); ++i) out.put(model_.lock_closed(static_cast<int>(i)));
  out.put(y_.data(), y_.size());
  out.put(z_.data(), z_.size());
  out.put(kinetic_start_);
  out.put(potential_start_);
  out.put(ledger_.largest_exchange);
  out.put(max_order_);
  monitor_.save(out);
  running_ = false;
  return out.take();
}

void SimbodyUnit::restore(const UnitState& state) {
  ByteReader in(state);
  in.get(mode_);
  in.get(time_);
  in.get(inputs_.data(), inputs_.size());
  for (char& set : input_is_set_) in.get(set);
  for (std::size_t i = 0; i < scene_.drives.size(); ++i) {
    const double reference = in.get<double>();
    DriveMotion motion;
    in.get(motion.value);
    in.get(motion.rate);
    in.get(motion.acceleration);
    model_.set_drive(static_cast<int>(i), reference, motion);
  }
  for (std::size_t i = 0; i < scene_.locks.size(); ++i) model_.set_lock(static_cast<int>(i), in.get<bool>());
  in.get(y_.data(), y_.size());
  in.get(z_.data(), z_.size());
  in.get(kinetic_start_);
  in.get(potential_start_);
  ledger_ = EnergyLedger{};
  ledger_.start = kinetic_start_ + potential_start_;
  in.get(ledger_.largest_exchange);
  in.get(max_order_);
  monitor_.restore(in);
  in.finish();

  dynamics_.evaluate(seconds(time_), y_.data());
  fill(seconds(time_), z_.data(), begin_);
  update_ledger(z_);
  publish();
  running_ = false;
}

void SimbodyUnit::check_depths(const EventMonitor::Sample& sample) const {
  for (std::size_t i = 0; i < alarming_depths_.size(); ++i) {
    if (!(sample.indicators.pairs[i] > alarming_depths_[i])) continue;
    const crane_models::ContactPair& pair = scene_.pairs[i];
    throw IntegrationFailed(fmt::format(
        "{} passed through {}: {:.3g} m deep. Lower the speed or raise contact.stiffness",
        crane_models::contact_name(scene_, pair.body_b, pair.box_b),
        crane_models::contact_name(scene_, pair.body_a, pair.box_a), sample.indicators.pairs[i]));
  }
}

}  // namespace

std::unique_ptr<EngineUnit> make_simbody_engine(const crane_models::Scene& scene,
                                                const contact_nn::ContactSettings& contact,
                                                const SolverSettings& solver) {
  return std::make_unique<SimbodyUnit>(scene, contact, solver);
}

}  // namespace quayside::harness
