#include "harness/mujoco/engine.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace quayside::harness::mujoco {

using crane_models::DriveMotion;

namespace {

int integrator(const std::string& name) {
  if (name == "rk4") return mjINT_RK4;
  if (name == "implicit") return mjINT_IMPLICIT;
  if (name == "euler") return mjINT_EULER;
  throw std::invalid_argument("solver.mujoco_integrator: no \"" + name + "\"; expected one of rk4, implicit, euler");
}

}  // namespace

Engine::Engine(std::string name, const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
               const SolverSettings& solver, std::shared_ptr<const contact_nn::ContactModule> laws,
               const std::string& mjcf, std::optional<contact_nn::BristleFriction> bristle)
    : SceneEngine(std::move(name), scene, solver), forces_(scene_, std::move(laws), bristle), model_(scene_, mjcf),
      drives_now_(scene_.drives.size()), motions_(scene_.bodies.size()), loads_(forces_.make_loads()),
      rates_(integrals_.size()), step_limit_(scene_, contact, solver), reactions_(model_.driven_joints().size()) {
  model_.model()->opt.integrator = integrator(solver.mujoco_integrator);
  sample_at_ = [this](double time, EventMonitor::Sample& sample) {
    retake_step(std::max(nanoseconds(time), point_.time));
    fill(seconds(time_), integrals_, sample);
  };
}

void Engine::fill_drives(double after) {
  for (std::size_t i = 0; i < drives_now_.size(); ++i) drives_now_[i] = drive(i, after);
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

// One step of MuJoCo's integrator from `point_`, where the unit stands evaluated, and the evaluation at its
// end.
//
// The work of a drive at a joint: its rate is linear in time but for a jerk, which is small over a step, so that with
// v = v_m + a (t − t_m) about its middle ∫ F v dt = v_m J + a h² (F₁ − F₀)/12 + O(h⁵). The impulse J is what the
// armature was held back by: with the force armature × a it would have gained a h.
void Engine::take_step(Time step) {
  mjModel* m = model_.model();
  mjData* d = model_.data();
  const double h = seconds(step);
  m->opt.timestep = h;
  d->time = 0;
  prepare_stages(h);
  for (const auto& joint : model_.driven_joints()) {
    d->qfrc_applied[joint.dof] = joint.armature * drive(joint.drive, kMeanOfLaterStages * h).acceleration;
  }
  run([m, d, this] {
    if (runge_kutta()) mj_RungeKutta(m, d, 4);
    else mj_step2(m, d);
  });

  for (const auto& joint : model_.driven_joints()) {
    const DriveMotion motion = drive(joint.drive, 0);
    const double rate_then = motion.after(h).rate;
    integrals_[kWorkIn] += 0.5 * (motion.rate + rate_then) * joint.armature * (rate_then - d->qvel[joint.dof]);
  }
  time_ += step;
  finish_stages(h, point_.rates);
  evaluate();
  for (std::size_t i = 0; i < reactions_.size(); ++i) {
    const double acceleration = drive(model_.driven_joints()[i].drive, -0.5 * h).acceleration;
    integrals_[kWorkIn] += acceleration * h * h * (reactions_[i] - point_.reactions[i]) / 12;
  }
  integrate(h, point_.rates);
}

// From `point_` again, to another end.
void Engine::retake_step(Time end) {
  rewind(point_);
  if (end > time_) {
    take_step(end - time_);
  } else {
    evaluate();
  }
}

// What is left to `target` in equal parts that the limit allows.
Time Engine::next_step(Time target) const {
  const Time left = target - time_;
  const double limit = step_limit_(forces_, motions_, drives_now_, locks_closed_, loads_);
  const double parts = std::ceil(seconds(left) / limit);
  return std::max<Time>(1, static_cast<Time>(static_cast<double>(left) / parts));
}

// Steps end on whole nanoseconds, the last one exactly at the communication time. An event is located by taking the
// step again with other lengths, so that what is seen at a time within the step is as exact as its end.
StepResult Engine::advance_to(Time target) {
  std::optional<Time> flip;
  while (time_ < target && !flip) {
    keep(point_);
    const Time aim = time_ + next_step(target);
    take_step(aim - time_);
    fill(seconds(time_), integrals_, end_);
    check_depths(end_);
    ++statistics_.steps;
    flip = monitor_.advance(begin_, end_, sample_at_);
    const Time reached = flip ? std::clamp(*flip, point_.time, aim) : aim;
    if (reached != time_) retake_step(reached);  // from where the search for an event left the unit
    if (reached != aim) fill(seconds(time_), integrals_, end_);
    std::swap(begin_, end_);
    update_ledger(integrals_);
  }
  publish();
  keep(point_);
  return {time_, flip.has_value(), false};
}

// Back to the last good state, whatever MuJoCo left behind.
std::string Engine::recover(const std::runtime_error& failure) {
  std::string reason = failure.what();
  mj_resetData(model_.model(), model_.data());
  rewind(point_);
  try {
    evaluate();
    fill(seconds(time_), integrals_, begin_);
    publish();
  } catch (const std::runtime_error&) {
    // The state is good but its accelerations are not: the failure that is being reported.
    mj_resetData(model_.model(), model_.data());
    rewind(point_);
  }
  return reason;
}

// --- State ----------------------------------------------------------------------------------------------------------

void Engine::save_motion(ByteWriter& out) const {
  out.put(model_.data()->qpos, model_.model()->nq);
  out.put(model_.data()->qvel, model_.model()->nv);
}

void Engine::restore_motion(ByteReader& in) {
  in.get(model_.data()->qpos, model_.model()->nq);
  in.get(model_.data()->qvel, model_.model()->nv);
}

}  // namespace quayside::harness::mujoco
