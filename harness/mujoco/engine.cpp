#include "harness/mujoco/engine.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "harness/mujoco/mjcf.h"
#include "harness/state_bytes.h"

namespace quayside::harness::mujoco {
namespace {

using crane_models::DriveMotion;

// Inputs of a drive that differ by less from its present motion do not change it [m or rad, and per second].
constexpr double kSameMotion = 1e-9;

// A box this far inside another, as a fraction of the smaller of their half extents, would come out on the far side.
constexpr double kAlarmingDepth = 0.5;

constexpr double kLargestRelativeTolerance = 1e-2;

SolverSettings checked(const SolverSettings& solver) {
  if (!(solver.relative_tolerance > 0 && solver.relative_tolerance <= kLargestRelativeTolerance)) {
    throw std::invalid_argument(fmt::format("solver.relative_tolerance is {}: give a value in (0, {}]",
                                            solver.relative_tolerance, kLargestRelativeTolerance));
  }
  for (const auto& [name, value] : {std::pair("max_step", solver.max_step), {"mujoco_step", solver.mujoco_step}}) {
    if (!(value >= 0 && value <= 1)) {
      throw std::invalid_argument(fmt::format("solver.{} is {}: give a value in [0, 1] s", name, value));
    }
  }
  return solver;
}

const crane_models::Scene& checked(const crane_models::Scene& scene) {
  crane_models::check(scene);
  return scene;
}

}  // namespace

Engine::Engine(std::string name, const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
               const SolverSettings& solver, std::shared_ptr<const contact_nn::ContactModule> laws,
               const std::string& mjcf)
    : name_(std::move(name)), scene_(checked(scene)), forces_(scene_, std::move(laws)), model_(scene_, mjcf),
      monitor_(scene_), locks_closed_(scene_.locks.size()), drives_(scene_.drives.size()),
      motions_(scene_.bodies.size()), loads_(forces_.make_loads()), rates_(kImpulses + 3 * monitor_.groups().size()),
      integrals_(rates_.size()), variables_(engine_variables(scene_)),
      step_limit_(scene_, contact, checked(solver)), inputs_(3 * scene_.drives.size() + scene_.commands.size()),
      input_is_set_(inputs_.size()), drive_inputs_(scene_.drives.size()),
      outputs_(variables_.size() - inputs_.size()), reactions_(model_.driven_joints().size()),
      begin_(monitor_.make_sample()), end_(monitor_.make_sample()) {
  sample_at_ = [this](double time, EventMonitor::Sample& sample) {
    rewind(point_);
    advance_to(std::max(nanoseconds(time), point_.time));
    fill(sample);
  };
}

const char* Engine::to_string(Mode mode) {
  switch (mode) {
    case Mode::instantiated: return "instantiated";
    case Mode::initialization: return "in initialization mode";
    case Mode::event: return "in event mode";
    case Mode::step: return "in step mode";
    case Mode::terminated: return "terminated";
  }
  return "";
}

void Engine::demand(Mode mode, const char* what) const {
  if (mode_ != mode) {
    throw std::logic_error(fmt::format("{}: {} is not possible while the unit is {}", name_, what, to_string(mode_)));
  }
}

void Engine::reset() {
  mode_ = Mode::instantiated;
  time_ = 0;
  for (std::size_t i = 0; i < inputs_.size(); ++i) inputs_[i] = variables_[i].start;
  std::fill(input_is_set_.begin(), input_is_set_.end(), false);
  statistics_ = {};
  begin_simulation();
}

// --- Variables ------------------------------------------------------------------------------------------------------

void Engine::set(ValueReference variable, double value) {
  if (variable >= variables_.size() || variables_[variable].causality != Causality::input) {
    throw std::invalid_argument(fmt::format("{}: variable {} is not an input", name_, variable));
  }
  if (!std::isfinite(value)) {
    throw std::invalid_argument(fmt::format("{}: {} cannot be {}", name_, variables_[variable].name, value));
  }
  inputs_[variable] = value;
  input_is_set_[variable] = true;
  if (mode_ == Mode::initialization) begin_simulation();
}

double Engine::get(ValueReference variable) const {
  if (variable >= variables_.size()) {
    throw std::invalid_argument(fmt::format("{}: there is no variable {}", name_, variable));
  }
  if (variable >= inputs_.size()) return outputs_[variable - inputs_.size()];
  if (input_is_set_[variable] || variable >= 3 * scene_.drives.size()) return inputs_[variable];
  const DriveMotion now = drive(variable / 3, 0);
  return variable % 3 == 0 ? now.value : variable % 3 == 1 ? now.rate : now.acceleration;
}

DriveMotion Engine::drive(std::size_t index, double after) const {
  const DriveInput& input = drive_inputs_[index];
  return input.motion.after(seconds(time_ - input.since) + after);
}

void Engine::fill_drives(double after) {
  for (std::size_t i = 0; i < drives_.size(); ++i) drives_[i] = drive(i, after);
}

// --- Life cycle -----------------------------------------------------------------------------------------------------

void Engine::enter_initialization_mode(Time start) {
  demand(Mode::instantiated, "entering initialization mode");
  mode_ = Mode::initialization;
  time_ = start;
  begin_simulation();
}

// Everything from the start values and the inputs as set.
void Engine::begin_simulation() {
  for (std::size_t i = 0; i < drive_inputs_.size(); ++i) {
    drive_inputs_[i] = {time_, {inputs_[3 * i], inputs_[3 * i + 1], inputs_[3 * i + 2]}};
  }
  for (std::size_t i = 0; i < scene_.locks.size(); ++i) {
    const int command = scene_.locks[i].command;
    locks_closed_[i] = command < 0 ? scene_.locks[i].closed : inputs_[3 * scene_.drives.size() + command] != 0;
  }
  model_.set_start();
  std::fill(integrals_.begin(), integrals_.end(), 0.0);
  ledger_ = {};
  try {
    evaluate();
  } catch (const MujocoError& e) {
    throw std::invalid_argument(fmt::format("{} cannot start the scene: {}", name_, e.what()));
  }
  fill(begin_);
  monitor_.start(begin_);
  start_kinetic_ = model_.kinetic_energy();
  start_potential_ = model_.potential_energy() + loads_.potential_energy;
  ledger_.start = start_kinetic_ + start_potential_;
  publish();
  keep(point_);
}

void Engine::exit_initialization_mode() {
  demand(Mode::initialization, "leaving initialization mode");
  begin_simulation();
  std::fill(input_is_set_.begin(), input_is_set_.end(), false);
  mode_ = Mode::event;
}

void Engine::enter_event_mode() {
  if (mode_ == Mode::event) return;
  demand(Mode::step, "entering event mode");
  mode_ = Mode::event;
}

std::optional<Time> Engine::update_discrete_states() {
  demand(Mode::event, "updating discrete states");
  apply_inputs();
  return std::nullopt;
}

void Engine::enter_step_mode() {
  if (mode_ == Mode::step) return;
  demand(Mode::event, "entering step mode");
  mode_ = Mode::step;
}

// True when the drive's inputs, where they were set, ask for another motion than the one it has.
bool Engine::change_drive(std::size_t index) {
  const DriveMotion now = drive(index, 0);
  const auto wanted = [&](std::size_t component, double present) {
    const std::size_t i = 3 * index + component;
    return input_is_set_[i] ? inputs_[i] : present;
  };
  const DriveMotion motion{wanted(0, now.value), wanted(1, now.rate), wanted(2, now.acceleration)};
  if (std::abs(motion.value - now.value) <= kSameMotion && std::abs(motion.rate - now.rate) <= kSameMotion &&
      std::abs(motion.acceleration - now.acceleration) <= kSameMotion) {
    return false;
  }
  drive_inputs_[index] = {time_, motion};
  return true;
}

// Energy that jumps is booked: what an opening lock held is lost, and whoever closes a strained lock or moves a drive
// at one stroke has put it in.
void Engine::apply_inputs() {
  if (std::none_of(input_is_set_.begin(), input_is_set_.end(), [](char set) { return set; })) return;
  bool changed = false;
  for (std::size_t i = 0; i < drive_inputs_.size(); ++i) changed |= change_drive(i);
  for (std::size_t i = 0; i < scene_.locks.size(); ++i) {
    const int command = scene_.locks[i].command;
    if (command < 0) continue;
    const bool closed = inputs_[3 * scene_.drives.size() + command] != 0;
    if (closed == static_cast<bool>(locks_closed_[i])) continue;
    locks_closed_[i] = closed;
    monitor_.note_lock(time_, static_cast<int>(i), closed);
    changed = true;
  }
  std::fill(input_is_set_.begin(), input_is_set_.end(), false);
  if (!changed) return;

  const double before = ledger_.kinetic + ledger_.potential;
  evaluate();
  const double gained =
      model_.kinetic_energy() + model_.potential_energy() + loads_.potential_energy - before;
  integrals_[gained > 0 ? kWorkIn : kDissipated] += std::abs(gained);
  fill(begin_);
  publish();
}

// --- Evaluating -----------------------------------------------------------------------------------------------------

// Calls MuJoCo; its warnings are failures.
template <typename Function>
void Engine::run(const Function& function) {
  guarded(law(), model_.data(), function);
  for (int i = 0; i < mjNWARNING; ++i) {
    const mjWarningStat& warning = model_.data()->warning[i];
    if (warning.number > 0) throw MujocoError(mju_warningText(i, warning.lastinfo));
  }
}

// Driven joints exactly where their drives are; their armature times acceleration makes them stay there (see
// drive_armature).
void Engine::place_drives() {
  mjData* d = model_.data();
  for (const auto& joint : model_.driven_joints()) {
    const DriveMotion motion = drive(joint.drive, 0);
    d->qpos[joint.qpos] = motion.value;
    d->qvel[joint.dof] = motion.rate;
    d->qfrc_applied[joint.dof] = joint.armature * motion.acceleration;
  }
}

// Accelerations and loads at `time_`.
void Engine::evaluate() {
  mjModel* m = model_.model();
  mjData* d = model_.data();
  d->time = 0;  // within a step it counts from the step's begin
  place_drives();
  fill_drives(0);
  prepare_evaluation();
  run([m, d] {
    mj_checkPos(m, d);
    mj_checkVel(m, d);
    mj_forward(m, d);
    mj_checkAcc(m, d);
  });
  model_.read_motions(motions_);
  read_loads();
  for (std::size_t i = 0; i < reactions_.size(); ++i) {
    const auto& joint = model_.driven_joints()[i];
    reactions_[i] = joint.armature * (drive(joint.drive, 0).acceleration - d->qacc[joint.dof]);
  }
}

void Engine::write_rates(double work_in, double dissipated) {
  rates_[kWorkIn] = work_in;
  rates_[kDissipated] = dissipated;
  for (std::size_t i = 0; i < monitor_.groups().size(); ++i) {
    Eigen::Map<Eigen::Vector3d>(rates_.data() + kImpulses + 3 * i) = group_force(monitor_.groups()[i], loads_);
  }
}

void Engine::fill(EventMonitor::Sample& sample) const {
  sample.time = seconds(time_);
  forces_.indicators(motions_, drives_, loads_, sample.indicators);
  for (std::size_t i = 0; i < monitor_.groups().size(); ++i) {
    sample.impulses[i] = Eigen::Map<const Eigen::Vector3d>(integrals_.data() + kImpulses + 3 * i);
    sample.forces[i] = group_force(monitor_.groups()[i], loads_).norm();
  }
}

void Engine::update_ledger() {
  ledger_.kinetic = model_.kinetic_energy();
  ledger_.potential = model_.potential_energy() + loads_.potential_energy;
  ledger_.work_in = integrals_[kWorkIn];
  ledger_.dissipated = integrals_[kDissipated];
  ledger_.largest_exchange =
      std::max({ledger_.largest_exchange, std::abs(ledger_.kinetic - start_kinetic_),
                std::abs(ledger_.potential - start_potential_), std::abs(ledger_.work_in), ledger_.dissipated});
}

// What the interface shows.
void Engine::publish() {
  update_ledger();
  write_outputs(scene_, motions_, loads_, monitor_, ledger_, outputs_);
}

// --- Stepping -------------------------------------------------------------------------------------------------------

void Engine::keep(Point& point) const {
  const mjModel* m = model_.model();
  const mjData* d = model_.data();
  point.time = time_;
  point.qpos.assign(d->qpos, d->qpos + m->nq);
  point.qvel.assign(d->qvel, d->qvel + m->nv);
  point.qacc.assign(d->qacc, d->qacc + m->nv);
  point.integrals = integrals_;
  point.rates = rates_;
  point.reactions = reactions_;
}

void Engine::rewind(const Point& point) {
  mjData* d = model_.data();
  time_ = point.time;
  std::copy(point.qpos.begin(), point.qpos.end(), d->qpos);
  std::copy(point.qvel.begin(), point.qvel.end(), d->qvel);
  std::copy(point.qacc.begin(), point.qacc.end(), d->qacc);
  integrals_ = point.integrals;
  rates_ = point.rates;
  reactions_ = point.reactions;
}

// One step of MuJoCo's Runge-Kutta method from `point_`, where the unit stands evaluated, and the evaluation at its
// end.
//
// The work of a drive at a joint: its rate is linear in time, v = v_m + a (t − t_m) about the middle of the step, so
// that ∫ F v dt = v_m J + a h² (F₁ − F₀)/12 + O(h⁵). The impulse J is what the armature was held back by: with the
// force armature × a it would have gained a h.
void Engine::advance(Time step) {
  mjModel* m = model_.model();
  mjData* d = model_.data();
  const double h = seconds(step);
  m->opt.timestep = h;
  d->time = 0;
  prepare_stages(h);
  run([m, d] { mj_RungeKutta(m, d, 4); });

  for (const auto& joint : model_.driven_joints()) {
    const DriveMotion motion = drive(joint.drive, 0);
    const double impulse = joint.armature * (motion.rate + motion.acceleration * h - d->qvel[joint.dof]);
    integrals_[kWorkIn] += (motion.rate + 0.5 * motion.acceleration * h) * impulse;
  }
  time_ += step;
  evaluate();
  for (std::size_t i = 0; i < reactions_.size(); ++i) {
    const double acceleration = drive(model_.driven_joints()[i].drive, 0).acceleration;
    integrals_[kWorkIn] += acceleration * h * h * (reactions_[i] - point_.reactions[i]) / 12;
  }
  integrate(h, point_.rates);
}

// From `point_`.
void Engine::advance_to(Time time) {
  if (time > point_.time) {
    advance(time - point_.time);
  } else {
    evaluate();
  }
}

void Engine::check_depths() const {
  for (std::size_t i = 0; i < scene_.pairs.size(); ++i) {
    const auto& pair = scene_.pairs[i];
    const double thickness = std::min(scene_.bodies[pair.body_a].boxes[pair.box_a].half.minCoeff(),
                                      scene_.bodies[pair.body_b].boxes[pair.box_b].half.minCoeff());
    if (end_.indicators.pairs[i] <= kAlarmingDepth * thickness) continue;
    throw MujocoError(fmt::format("{} passed through {}: {:.3g} m deep. Lower the speed or raise contact.stiffness",
                                  crane_models::contact_name(scene_, pair.body_b, pair.box_b),
                                  crane_models::contact_name(scene_, pair.body_a, pair.box_a),
                                  end_.indicators.pairs[i]));
  }
}

// What is left to `end` in equal parts that the limit allows.
Time Engine::next_step(Time end) const {
  const Time left = end - time_;
  const double limit = step_limit_(forces_, motions_, drives_, locks_closed_, loads_);
  const double parts = std::ceil(seconds(left) / limit);
  return std::max<Time>(1, static_cast<Time>(static_cast<double>(left) / parts));
}

// Steps end on whole nanoseconds, the last one exactly at the communication time. An event is located by taking the
// step again with other lengths, so that what is seen at a time within the step is as exact as its end.
StepResult Engine::do_step(Time now, Time step) {
  demand(Mode::step, "a step");
  if (now != time_ || step <= 0) {
    throw std::invalid_argument(
        fmt::format("{}: a step of {} ns from {} ns, but the unit is at {} ns", name_, step, now, time_));
  }
  const Time end = now + step;
  try {
    keep(point_);
    apply_inputs();
    while (time_ < end) {
      keep(point_);
      const Time aim = time_ + next_step(end);
      advance_to(aim);
      fill(end_);
      check_depths();
      ++statistics_.steps;
      const auto flip = monitor_.advance(begin_, end_, sample_at_);
      const Time reached = flip ? std::clamp(*flip, point_.time, aim) : aim;
      if (reached != time_) {  // where the search for an event left the unit
        rewind(point_);
        advance_to(reached);
      }
      if (reached != aim) fill(end_);
      std::swap(begin_, end_);
      update_ledger();
      if (flip) {
        publish();
        return {time_, true, false};
      }
    }
    publish();
  } catch (const std::runtime_error& e) {
    recover();
    throw StepFailed(name_, time_, e.what());
  }
  return {time_, false, false};
}

// Back to the last good state, whatever MuJoCo left behind.
void Engine::recover() {
  mj_resetData(model_.model(), model_.data());
  rewind(point_);
  try {
    evaluate();
    fill(begin_);
    publish();
  } catch (const std::runtime_error&) {
    // The state is good but its accelerations are not: the failure that is being reported.
    mj_resetData(model_.model(), model_.data());
    rewind(point_);
  }
}

// --- State ----------------------------------------------------------------------------------------------------------

UnitState Engine::save() {
  const mjModel* m = model_.model();
  const mjData* d = model_.data();
  ByteWriter out;
  out.put(mode_);
  out.put(time_);
  out.put(inputs_.data(), inputs_.size());
  for (const char set : input_is_set_) out.put(set);
  for (const DriveInput& input : drive_inputs_) {
    out.put(input.since);
    for (const double x : {input.motion.value, input.motion.rate, input.motion.acceleration}) out.put(x);
  }
  for (const char closed : locks_closed_) out.put(closed);
  out.put(d->qpos, m->nq);
  out.put(d->qvel, m->nv);
  out.put(integrals_.data(), integrals_.size());
  for (const double e : {start_kinetic_, start_potential_, ledger_.largest_exchange}) out.put(e);
  monitor_.save(out);
  return out.take();
}

void Engine::restore(const UnitState& state) {
  const mjModel* m = model_.model();
  mjData* d = model_.data();
  ByteReader in(state);
  in.get(mode_);
  in.get(time_);
  in.get(inputs_.data(), inputs_.size());
  for (char& set : input_is_set_) in.get(set);
  for (DriveInput& input : drive_inputs_) {
    in.get(input.since);
    for (double* x : {&input.motion.value, &input.motion.rate, &input.motion.acceleration}) in.get(*x);
  }
  for (char& closed : locks_closed_) in.get(closed);
  in.get(d->qpos, m->nq);
  in.get(d->qvel, m->nv);
  in.get(integrals_.data(), integrals_.size());
  for (double* e : {&start_kinetic_, &start_potential_, &ledger_.largest_exchange}) in.get(*e);
  ledger_.start = start_kinetic_ + start_potential_;
  monitor_.restore(in);
  in.finish();
  evaluate();
  fill(begin_);
  publish();
  keep(point_);
}

}  // namespace quayside::harness::mujoco
