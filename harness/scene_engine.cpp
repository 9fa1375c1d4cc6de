#include "harness/scene_engine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "harness/engine_outputs.h"

namespace quayside::harness {
namespace {

using crane_models::DriveMotion;

constexpr double kLargestRelativeTolerance = 1e-2;
constexpr double kLongestStep = 1.0;  // that can be asked for [s]

// Inputs of a drive that differ by less from its present motion do not change it [m or rad, and per second].
constexpr double kSameMotion = 1e-9;

// Inputs beyond this are mistakes, and would overflow further on [m or rad, per second and per second squared].
constexpr double kLargestInput = 1e6;

// A box this far inside another, as a fraction of the smaller of their half extents, would come out on the far side.
constexpr double kAlarmingDepth = 0.5;

double component(const DriveMotion& motion, std::size_t k) {
  const double all[kPerDrive] = {motion.value, motion.rate, motion.acceleration, motion.jerk};
  return all[k];
}
DriveMotion motion_of(const double* all) { return {all[0], all[1], all[2], all[3]}; }

void check(const SolverSettings& solver) {
  if (!(solver.relative_tolerance > 0 && solver.relative_tolerance <= kLargestRelativeTolerance)) {
    throw std::invalid_argument(fmt::format("solver.relative_tolerance is {}: give a value in (0, {}]",
                                            solver.relative_tolerance, kLargestRelativeTolerance));
  }
  for (const auto& [name, value] : {std::pair("max_step", solver.max_step), {"mujoco_step", solver.mujoco_step}}) {
    if (!(value >= 0 && value <= kLongestStep)) {
      throw std::invalid_argument(fmt::format("solver.{} is {}: give a value in [0, {}] s", name, value, kLongestStep));
    }
  }
}

const crane_models::Scene& checked(const crane_models::Scene& scene) {
  crane_models::check(scene);
  return scene;
}

}  // namespace

SceneEngine::SceneEngine(std::string name, const crane_models::Scene& scene, const SolverSettings& solver)
    : name_(std::move(name)), scene_(checked(scene)), monitor_(scene_), drives_(scene_.drives.size()),
      locks_closed_(scene_.locks.size()), integrals_(kImpulses + 3 * monitor_.groups().size()),
      begin_(monitor_.make_sample()), end_(monitor_.make_sample()), variables_(engine_variables(scene_)),
      sampled_contact_(solver.sampled_contact),
      inputs_(kPerDrive * scene_.drives.size() + scene_.commands.size()), input_is_set_(inputs_.size()),
      locks_told_(scene_.locks.size()),
      outputs_(variables_.size() - inputs_.size()) {
  check(solver);
  for (const auto& pair : scene_.pairs) {
    alarming_depths_.push_back(kAlarmingDepth * std::min(scene_.bodies[pair.body_a].boxes[pair.box_a].half.minCoeff(),
                                                         scene_.bodies[pair.body_b].boxes[pair.box_b].half.minCoeff()));
  }
}

const char* SceneEngine::to_string(Mode mode) {
  switch (mode) {
    case Mode::instantiated: return "instantiated";
    case Mode::initialization: return "in initialization mode";
    case Mode::event: return "in event mode";
    case Mode::step: return "in step mode";
    case Mode::terminated: return "terminated";
  }
  return "";
}

void SceneEngine::demand(Mode mode, const char* what) const {
  if (mode_ != mode) {
    throw std::logic_error(fmt::format("{}: {} is not possible while the unit is {}", name_, what, to_string(mode_)));
  }
}

// --- Variables ------------------------------------------------------------------------------------------------------

void SceneEngine::set(ValueReference variable, double value) {
  if (variable >= variables_.size() || variables_[variable].causality != Causality::input) {
    throw std::invalid_argument(fmt::format("{}: variable {} is not an input", name_, variable));
  }
  if (!(std::abs(value) <= kLargestInput)) {
    throw std::invalid_argument(fmt::format("{}: {} cannot be {}: at most {} either way", name_,
                                            variables_[variable].name, value, kLargestInput));
  }
  inputs_[variable] = value;
  input_is_set_[variable] = true;
  if (mode_ == Mode::initialization) begin_simulation();
}

double SceneEngine::get(ValueReference variable) const {
  if (variable >= variables_.size()) {
    throw std::invalid_argument(fmt::format("{}: there is no variable {}", name_, variable));
  }
  if (variable >= inputs_.size()) return outputs_[variable - inputs_.size()];
  if (input_is_set_[variable] || variable >= kPerDrive * drives_.size()) return inputs_[variable];
  return component(drive(variable / kPerDrive, 0), variable % kPerDrive);
}

DriveMotion SceneEngine::drive(std::size_t index, double after) const {
  const DriveInput& input = drives_[index];
  return input.motion.after(seconds(time_ - input.since) + after);
}

// What fails leaves the unit in its last good state.
template <typename Function>
auto SceneEngine::attempt(const Function& function) {
  try {
    return function();
  } catch (const std::runtime_error& failure) {
    const std::string reason = recover(failure);
    throw StepFailed(name_, time_, reason);
  }
}

// --- Life cycle -----------------------------------------------------------------------------------------------------

void SceneEngine::reset() {
  mode_ = Mode::instantiated;
  time_ = 0;
  for (std::size_t i = 0; i < inputs_.size(); ++i) inputs_[i] = variables_[i].start;
  std::fill(input_is_set_.begin(), input_is_set_.end(), false);
  begin_simulation();
}

void SceneEngine::enter_initialization_mode(Time start) {
  demand(Mode::instantiated, "entering initialization mode");
  mode_ = Mode::initialization;
  time_ = start;
  begin_simulation();
}

// Everything from the start values and the inputs as set.
void SceneEngine::begin_simulation() {
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    drives_[i] = {time_, motion_of(&inputs_[kPerDrive * i])};
  }
  for (std::size_t i = 0; i < locks_closed_.size(); ++i) {
    const int command = scene_.locks[i].command;
    locks_closed_[i] = command < 0 ? scene_.locks[i].closed : inputs_[kPerDrive * drives_.size() + command] != 0;
    locks_told_[i] = locks_closed_[i];
  }
  std::fill(integrals_.begin(), integrals_.end(), 0.0);
  place_start();
  try {
    evaluate_contacts_too();
  } catch (const std::runtime_error& failure) {
    throw std::invalid_argument(fmt::format("{} cannot start the scene: {}", name_, failure.what()));
  }
  kinetic_start_ = kinetic_energy();
  potential_start_ = potential_energy();
  ledger_ = EnergyLedger{};
  ledger_.start = kinetic_start_ + potential_start_;
  fill(seconds(time_), integrals_, begin_);
  monitor_.start(begin_);
  publish();
  restart();
}

void SceneEngine::exit_initialization_mode() {
  demand(Mode::initialization, "leaving initialization mode");
  begin_simulation();
  std::fill(input_is_set_.begin(), input_is_set_.end(), false);
  mode_ = Mode::event;
}

void SceneEngine::enter_event_mode() {
  if (mode_ == Mode::event) return;
  demand(Mode::step, "entering event mode");
  mode_ = Mode::event;
}

std::optional<Time> SceneEngine::update_discrete_states() {
  demand(Mode::event, "updating discrete states");
  attempt([this] { apply_inputs(); });
  return std::nullopt;
}

void SceneEngine::enter_step_mode() {
  if (mode_ == Mode::step) return;
  demand(Mode::event, "entering step mode");
  mode_ = Mode::step;
}

// --- Inputs ---------------------------------------------------------------------------------------------------------

// True when the drive's inputs, where they were set, ask for another motion than the one it has.
bool SceneEngine::change_drive(std::size_t index) {
  const DriveMotion now = drive(index, 0);
  double wanted[kPerDrive];
  bool same = true;
  for (std::size_t k = 0; k < kPerDrive; ++k) {
    const std::size_t i = kPerDrive * index + k;
    wanted[k] = input_is_set_[i] ? inputs_[i] : component(now, k);
    same = same && std::abs(wanted[k] - component(now, k)) <= kSameMotion;
  }
  if (same) return false;
  drives_[index] = {time_, motion_of(wanted)};
  return true;
}

// True when the lock's command changes its state. A lock that refuses to close is not asked again before its command
// has gone back to open.
bool SceneEngine::change_lock(std::size_t index) {
  const int command = scene_.locks[index].command;
  if (command < 0) return false;
  const bool closed = inputs_[kPerDrive * drives_.size() + command] != 0;
  if (closed == static_cast<bool>(locks_told_[index])) return false;
  locks_told_[index] = closed;
  if (closed == static_cast<bool>(locks_closed_[index])) return false;  // it had refused
  if (closed && !in_place(index)) {
    monitor_.note(time_, EventKind::lock_refused, static_cast<int>(index));
    return false;
  }
  locks_closed_[index] = closed;
  monitor_.note(time_, closed ? EventKind::lock_closed : EventKind::lock_opened, static_cast<int>(index));
  return true;
}

// Whether every pin is where it can turn.
bool SceneEngine::in_place(std::size_t index) const {
  const spreader::Lock& lock = scene_.locks[index];
  if (lock.reach <= 0) return true;
  const crane_models::Pose& X_WA = motions()[lock.body_a].X_WB;
  const crane_models::Pose& X_WB = motions()[lock.body_b].X_WB;
  return std::all_of(lock.pins.begin(), lock.pins.end(), [&](const spreader::Lock::Pin& pin) {
    return (X_WB * pin.p_B - X_WA * pin.p_A).norm() <= lock.reach;
  });
}

// Energy that jumps is booked: what an opening lock held is lost, and whoever closes a strained lock or moves a drive
// at one stroke has put it in.
void SceneEngine::apply_inputs() {
  if (std::none_of(input_is_set_.begin(), input_is_set_.end(), [](char set) { return set; })) return;
  bool changed = false;
  for (std::size_t i = 0; i < drives_.size(); ++i) changed |= change_drive(i);
  for (std::size_t i = 0; i < locks_closed_.size(); ++i) changed |= change_lock(i);
  std::fill(input_is_set_.begin(), input_is_set_.end(), false);
  if (!changed) return;

  const double before = ledger_.kinetic + ledger_.potential;
  evaluate();
  const double gained = kinetic_energy() + potential_energy() - before;
  integrals_[gained > 0 ? kWorkIn : kDissipated] += std::abs(gained);
  show_anew();
}

// --- Showing --------------------------------------------------------------------------------------------------------

void SceneEngine::fill(double time, const std::vector<double>& integrals, EventMonitor::Sample& sample) const {
  sample.time = time;
  indicators(sample.indicators);
  for (std::size_t i = 0; i < monitor_.groups().size(); ++i) {
    sample.impulses[i] = Eigen::Map<const Eigen::Vector3d>(integrals.data() + kImpulses + 3 * i);
    sample.forces[i] = group_force(monitor_.groups()[i], loads()).norm();
  }
}

void SceneEngine::update_ledger(const std::vector<double>& integrals, double kinetic, double potential) {
  ledger_.kinetic = kinetic;
  ledger_.potential = potential;
  ledger_.work_in = integrals[kWorkIn];
  ledger_.dissipated = integrals[kDissipated];
  ledger_.largest_exchange =
      std::max({ledger_.largest_exchange, std::abs(ledger_.kinetic - kinetic_start_),
                std::abs(ledger_.potential - potential_start_), std::abs(ledger_.work_in), ledger_.dissipated});
}

void SceneEngine::publish() {
  update_ledger(integrals_);
  write_outputs(scene_, motions(), loads(), locks_closed_, monitor_, ledger_, outputs_);
}

// Where contacts are sampled, this is where.
void SceneEngine::evaluate_contacts_too() {
  hold_contacts(false);
  evaluate();
  hold_contacts(sampled_contact_);
}

// After an evaluation of a state that did not follow from the last one.
void SceneEngine::show_anew() {
  fill(seconds(time_), integrals_, begin_);
  publish();
  restart();
}

void SceneEngine::check_depths(const EventMonitor::Sample& sample) const {
  for (std::size_t i = 0; i < alarming_depths_.size(); ++i) {
    if (!(sample.indicators.pairs[i] > alarming_depths_[i])) continue;
    const crane_models::ContactPair& pair = scene_.pairs[i];
    throw std::runtime_error(fmt::format(
        "{} passed through {}: {:.3g} m deep. Lower the speed or raise contact.stiffness",
        crane_models::contact_name(scene_, pair.body_b, pair.box_b),
        crane_models::contact_name(scene_, pair.body_a, pair.box_a), sample.indicators.pairs[i]));
  }
}

// --- Stepping -------------------------------------------------------------------------------------------------------

StepResult SceneEngine::do_step(Time now, Time step) {
  demand(Mode::step, "a step");
  if (now != time_ || step <= 0) {
    throw std::invalid_argument(
        fmt::format("{}: a step of {} ns from {} ns, but the unit is at {} ns", name_, step, now, time_));
  }
  return attempt([&] {
    apply_inputs();
    const StepResult result = advance_to(now + step);
    if (sampled_contact_) {
      evaluate_contacts_too();
      show_anew();
    }
    return result;
  });
}

// --- State ----------------------------------------------------------------------------------------------------------

UnitState SceneEngine::save() {
  ByteWriter out;
  out.put(mode_);
  out.put(time_);
  out.put(inputs_.data(), inputs_.size());
  for (const char set : input_is_set_) out.put(set);
  for (const DriveInput& input : drives_) {
    out.put(input.since);
    for (std::size_t k = 0; k < kPerDrive; ++k) out.put(component(input.motion, k));
  }
  for (const char closed : locks_closed_) out.put(closed);
  for (const char told : locks_told_) out.put(told);
  out.put(integrals_.data(), integrals_.size());
  for (const double energy : {kinetic_start_, potential_start_, ledger_.largest_exchange}) out.put(energy);
  save_motion(out);
  monitor_.save(out);
  restart();
  return out.take();
}

void SceneEngine::restore(const UnitState& state) {
  ByteReader in(state);
  in.get(mode_);
  in.get(time_);
  in.get(inputs_.data(), inputs_.size());
  for (char& set : input_is_set_) in.get(set);
  for (DriveInput& input : drives_) {
    in.get(input.since);
    double motion[kPerDrive];
    in.get(motion, kPerDrive);
    input.motion = motion_of(motion);
  }
  for (char& closed : locks_closed_) in.get(closed);
  for (char& told : locks_told_) in.get(told);
  in.get(integrals_.data(), integrals_.size());
  ledger_ = EnergyLedger{};
  for (double* energy : {&kinetic_start_, &potential_start_, &ledger_.largest_exchange}) in.get(*energy);
  ledger_.start = kinetic_start_ + potential_start_;
  restore_motion(in);
  monitor_.restore(in);
  in.finish();
  evaluate_contacts_too();
  show_anew();
}

}  // namespace quayside::harness
