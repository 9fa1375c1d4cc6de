#include "harness/impacts/impact_response.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace quayside::harness {
namespace {

using Eigen::Vector3d;

constexpr double kLongestBlow = 1;    // [s]: the slowest, on a vertex, takes a tenth of it
constexpr double kRestingSpeed = 1e-3;  // of the whole mass, by its kinetic energy: below it a box is at rest [m/s]
constexpr double kLimitSpread = 0.02;
constexpr double kLongestUnrest = 20;  // [s]
constexpr double kQuiet = 2;           // how long it has to stay at rest [s]

class Stepper {
 public:
  Stepper(const ImpactScene& impact, const ImpactSetup& setup)
      : engine_(make_engine(setup.engine, impact.scene, setup.contact, SolverSettings{setup.relative_tolerance})) {
    engine_->enter_initialization_mode(0);
    engine_->exit_initialization_mode();
    engine_->update_discrete_states();
    engine_->enter_step_mode();
  }
  void run_to(Time end) {
    while (time_ < end) time_ = engine_->do_step(time_, end - time_).time;
  }
  Time time() const { return time_; }
  EngineUnit& engine() { return *engine_; }
  double get(const std::string& name) const {
    const auto& variables = engine_->variables();
    const auto found = std::find_if(variables.begin(), variables.end(), [&](const Variable& v) { return v.name == name; });
    return engine_->get(static_cast<ValueReference>(found - variables.begin()));
  }
  Vector3d vector(const std::string& name) const { return {get(name + ".x"), get(name + ".y"), get(name + ".z")}; }

 private:
  std::unique_ptr<EngineUnit> engine_;
  Time time_ = 0;
};

Event first_blow(const ImpactScene& scene, const ImpactSetup& setup) {
  Stepper stepper(scene, setup);
  const Time step = nanoseconds(1e-3), end = nanoseconds(kLongestBlow);
  while (stepper.time() < end) {
    stepper.run_to(stepper.time() + step);
    for (const Event& event : stepper.engine().take_events()) {
      if (event.kind == EventKind::contact_broken) return event;
    }
  }
  throw std::runtime_error("no blow that ends within a second: " + scene.scene.title);
}

// The last time at which the box' kinetic energy fell below that of kRestingSpeed. A box that rocks does so again and again, less
// each time: one more or one less may count when its energy comes close to the limit.
ResponseValue time_to_rest(ImpactScene scene, const ImpactSetup& setup) {
  scene.scene.gravity = {0, 0, -9.81};
  Stepper stepper(scene, setup);
  const double limit = 0.5 * scene.scene.bodies[1].mass * kRestingSpeed * kRestingSpeed;
  const Time step = nanoseconds(1e-3);
  struct Rest {
    double factor;      // of the limit
    double before = 0;  // logarithm of the energy over it: between samples a straight line
    double last = 0;
  };
  Rest rests[] = {{1}, {1 + kLimitSpread}, {1 - kLimitSpread}};
  for (Time t = step; t <= nanoseconds(kLongestUnrest); t += step) {
    stepper.run_to(t);
    for (Rest& rest : rests) {
      const double now = std::log(std::max(1e-300, stepper.engine().energy().kinetic / (rest.factor * limit)));
      if (now > 0) rest.last = seconds(t);
      else if (rest.before > 0) rest.last = seconds(t) - seconds(step) * now / (now - rest.before);
      rest.before = now;
    }
    if (seconds(t) - rests[2].last > kQuiet) {
      return {"time_to_rest", "s", rests[0].last - scene.time_of_touch, 1, rests[2].last - rests[1].last};
    }
  }
  throw std::runtime_error("does not come to rest: " + scene.scene.title);
}

}  // namespace

std::vector<ResponseValue> impact_response(const Impact& impact, const ImpactSetup& given) {
  ImpactSetup setup = given;
  setup.contact.friction = impact.friction;
  const ImpactScene scene = impact_scene(impact);
  const Event blow = first_blow(scene, setup);
  Stepper stepper(scene, setup);
  const EnergyLedger before = stepper.engine().energy();
  stepper.run_to(blow.time);
  const EnergyLedger after = stepper.engine().energy();
  const Vector3d v = stepper.vector("box.velocity"), w = stepper.vector("box.angular_velocity");

  const double radius = scene.scene.bodies[1].boxes[0].half.norm();
  std::vector<ResponseValue> values = {{"impulse", "N s", blow.impulse, impact.mass * impact.speed},
                                       {"peak_force", "N", blow.peak_force, blow.peak_force},
                                       {"duration", "s", blow.duration, blow.duration}};
  for (int i = 0; i < 3; ++i) values.push_back({std::string("velocity.") + "xyz"[i], "m/s", v[i], impact.speed});
  for (int i = 0; i < 3; ++i) values.push_back({std::string("angular_velocity.") + "xyz"[i], "rad/s", w[i], impact.speed / radius});
  values.push_back({"energy_lost", "J", after.dissipated - before.dissipated, before.kinetic});
  if (setup.until_rest && impact.struck == Struck::ground && impact.friction > 0) {
    values.push_back(time_to_rest(scene, setup));
  }
  return values;
}

}  // namespace quayside::harness
