#include "harness/coupling/sampled_study.h"

#include <algorithm>
#include <cmath>

#include "contact_nn/restitution.h"
#include "harness/compare.h"
#include "harness/run.h"

namespace quayside::harness {

namespace {

constexpr double kMass = 30480;                    // of a full container [kg]
const Eigen::Vector3d kSize{12.192, 2.438, 2.591};  // its footprint is the contact law's reference area [m]
constexpr double kArrival = 0.5;                   // [m/s]
constexpr double kGravity = 9.81;                  // [m/s²]

// Every communication step restarts the integrator, whose first steps may each be wrong by this [m]; at the default of 1e-6
// hundreds of them in one impact add up to 2 % of the speed.
constexpr double kTolerance = 1e-9;

// A body at rest is pushed by so little that all is linear; what it does then dies away or grows in so many steps.
constexpr double kPush = 1e-5;  // [m/s], [rad/s]
constexpr int kRestSteps = 120;
constexpr int kHalvings = 9;

cases::Case container_on_ground(double step) {
  cases::Case description;
  description.file = "container_on_ground";
  description.output_interval = step;
  description.sampled_contact = true;
  description.solver.relative_tolerance = kTolerance;
  description.allow_overlap = true;
  description.contact.model = "exact";
  description.contact.friction = 0;
  cases::BodySpec container;
  container.name = "container";
  container.mass = kMass;
  container.size = kSize;
  container.position = {0, 0, 0.5 * kSize.z()};
  description.bodies.push_back(container);
  return description;
}

EngineRun run_once(const cases::Case& description, const std::string& engine) {
  RunOptions options;
  options.engines = {engine};
  return std::move(run_case(description, options).engines.front());
}

const std::vector<double>& column(const EngineRun& run, const std::string& name) {
  return run.trajectory.columns[run.trajectory.index(name)];
}

double bounce_by_theory(double step, double stiffness) {
  const double a = stiffness / kMass;
  double x = 0, v = kArrival;  // depth and its rate
  do {
    const double held = std::max(0.0, x) * a;
    x += step * v - 0.5 * step * step * held;
    v -= step * held;
  } while (x > 0);
  return -v / kArrival;
}

bool rests(const std::string& engine, const std::string& direction, double step) {
  cases::Case description = container_on_ground(step);
  description.duration = kRestSteps * step;
  cases::BodySpec& container = description.bodies.front();
  container.position.z() -= kMass * kGravity / description.contact.stiffness;
  std::string signal = "container.velocity.z";
  if (direction == "vertical") container.velocity.z() = -kPush;
  if (direction == "rocking") {
    container.angular_velocity.x() = kPush;
    signal = "container.angular_velocity.x";
  }
  if (direction == "sideways") {
    description.contact.friction = cases::ContactSpec{}.friction;
    container.velocity.y() = kPush;
    signal = "container.velocity.y";
  }
  const EngineRun run = run_once(description, engine);
  if (run.failure) return false;
  const auto& speed = column(run, signal);
  const auto largest = [&](std::size_t first, std::size_t last) {
    double largest = 0;
    for (std::size_t i = first; i < last; ++i) largest = std::max(largest, std::abs(speed[i]));
    return largest;
  };
  return largest(2 * speed.size() / 3, speed.size()) < largest(0, speed.size() / 3);
}

}  // namespace

std::vector<SampledBounce> sampled_bounces(const std::vector<double>& steps) {
  std::vector<SampledBounce> bounces;
  for (const std::string& engine : kSampledEngines) {
    for (const double step : steps) {
      cases::Case description = container_on_ground(step);
      description.gravity.setZero();
      description.contact.restitution = 1;
      const double omega = std::sqrt(description.contact.stiffness / kMass);
      description.duration = std::ceil((M_PI / omega + 5 * step) / step) * step;
      description.bodies.front().velocity.z() = -kArrival;
      const EngineRun run = run_once(description, engine);
      const double leaving = run.failure ? std::nan("") : column(run, "container.velocity.z").back();
      bounces.push_back({engine, step, bounce_by_theory(step, description.contact.stiffness), leaving / kArrival});
    }
  }
  return bounces;
}

std::vector<SampledRest> sampled_rests() {
  const cases::ContactSpec contact;
  const double depth = kMass * kGravity / contact.stiffness;
  const double vertical = 2 * contact_nn::damping_for(contact.restitution, contact.reference_speed) * depth;
  // Friction acts half a height below the middle, on 1/m + (H/2)²/I with I = m (W² + H²)/12 for a reciprocal mass.
  const double height = kSize.z() * kSize.z(), width = kSize.y() * kSize.y();
  const double sideways = 2 * contact.transition_speed / (contact.friction * kGravity * (1 + 3 * height / (width + height)));
  std::vector<SampledRest> limits;
  for (const std::string& engine : kSampledEngines) {
    for (const auto& [direction, theory] : {std::pair("vertical", vertical), {"rocking", vertical}, {"sideways", sideways}}) {
      double low = 0, high = 2 * theory;
      for (int i = 0; i < kHalvings; ++i) (rests(engine, direction, 0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
      limits.push_back({engine, direction, theory, low});
    }
  }
  return limits;
}

std::vector<SampledRun> sampled_runs(const cases::Case& description, const std::vector<double>& steps) {
  constexpr std::string_view kSuffix = ".position";
  std::vector<SampledRun> runs;
  for (const std::string& engine : kSampledEngines) {
    for (const double step : steps) {
      cases::Case changed = description;
      changed.output_interval = step;
      const EngineRun continuous = run_once(changed, engine);
      changed.sampled_contact = true;
      const EngineRun sampled = run_once(changed, engine);
      SampledRun result{engine, step, 0, 0, sampled.energy.residual(), sampled.wall_s / continuous.wall_s, sampled.failure};
      if (continuous.failure) result.failure = continuous.failure;
      for (const SignalDifference& signal : compare_trajectories(continuous.trajectory, sampled.trajectory).signals) {
        const std::string& name = signal.signal;
        if (name.size() < kSuffix.size() || name.compare(name.size() - kSuffix.size(), kSuffix.size(), kSuffix) != 0) continue;
        result.rms = std::max(result.rms, signal.rms);
        result.max = std::max(result.max, signal.max);
      }
      runs.push_back(std::move(result));
    }
  }
  return runs;
}

}  // namespace quayside::harness
