#include "harness/simbody/simtk_integrator.h"

#include <algorithm>
#include <cassert>
#include <exception>
#include <limits>
#include <utility>

#include <Simbody.h>

#include "harness/simbody/step_quadrature.h"

namespace quayside::harness {
namespace {

// A call may report where it starts, or that it ended at its stop before, and stay there; more than that is no progress.
constexpr int kIdleCalls = 3;
constexpr const char* kStuck = "the step became too short to advance time: forces that jump or are not finite";

// The system as Simbody's integrators take it: a multibody system without bodies, all of y auxiliary state.
class Equations final : public SimTK::Force::Custom::Implementation {
 public:
  Equations(OdeSystem& system, const SimTK::GeneralForceSubsystem& forces, int size)
      : system_(system), forces_(forces), size_(size) {}

  // What was thrown in an evaluation, which Simbody takes for a reason to shorten the step.
  std::exception_ptr exception;

  void realizeTopology(SimTK::State& state) const override { forces_.allocateZ(state, SimTK::Vector(size_, 0.0)); }
  void realizeAcceleration(const SimTK::State& state) const override {
    bool finite = false;
    try {
      finite = system_.derivative(state.getTime(), forces_.getZ(state).getContiguousScalarData(),
                                  forces_.updZDot(state).updContiguousScalarData());
    } catch (...) {
      const_cast<Equations*>(this)->exception = std::current_exception();
    }
    if (!finite) throw std::runtime_error("forces or accelerations are not finite");
  }
  void calcForce(const SimTK::State&, SimTK::Vector_<SimTK::SpatialVec>&, SimTK::Vector_<SimTK::Vec3>&,
                 SimTK::Vector&) const override {}
  SimTK::Real calcPotentialEnergy(const SimTK::State&) const override { return 0; }

 private:
  OdeSystem& system_;
  const SimTK::GeneralForceSubsystem& forces_;
  const int size_;
};

std::unique_ptr<SimTK::Integrator> make(SimtkMethod method, const SimTK::System& system) {
  switch (method) {
    case SimtkMethod::merson: return std::make_unique<SimTK::RungeKuttaMersonIntegrator>(system);
    case SimtkMethod::feldberg: return std::make_unique<SimTK::RungeKuttaFeldbergIntegrator>(system);
    case SimtkMethod::rk3: return std::make_unique<SimTK::RungeKutta3Integrator>(system);
    case SimtkMethod::cpodes: return std::make_unique<SimTK::CPodesIntegrator>(system);
  }
  throw std::logic_error("an integrator of unknown kind");
}

// Dense output is the cubic through values and rates at the ends of a step.
class SimtkIntegrator final : public Integrator {
 public:
  SimtkIntegrator(SimtkMethod method, OdeSystem& system, const IntegratorSettings& settings);

  void restart(double t, const double* y, const double* z, int max_order) override;
  double step(double stop) override;
  double time() const override { return time_; }
  double step_begin() const override { return step_begin_; }
  void interpolate(double t, double* y, double* z) const override;
  std::uint64_t steps() const override { return steps_; }

 private:
  void read();
  void interpolate(double t, double* y) const;

  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_{system_};
  SimTK::GeneralForceSubsystem forces_{system_};
  Equations* equations_;  // owned by `forces_`
  SimTK::State start_;
  std::unique_ptr<SimTK::Integrator> integrator_;
  StepQuadrature quadrature_;
  std::vector<double> y_, y_begin_, rate_, rate_begin_, y_middle_;
  double step_begin_ = 0, time_ = 0;
  std::uint64_t steps_ = 0;
};

SimtkIntegrator::SimtkIntegrator(SimtkMethod method, OdeSystem& system, const IntegratorSettings& settings)
    : equations_(new Equations(system, forces_, static_cast<int>(settings.tolerances.size()))),
      quadrature_(system, settings.quadratures),
      y_(settings.tolerances.size()),
      y_begin_(y_.size()),
      rate_(y_.size()),
      rate_begin_(y_.size()),
      y_middle_(y_.size()) {
  SimTK::Force::Custom(forces_, equations_);
  start_ = system_.realizeTopology();
  system_.realizeModel(start_);
  // A weight is one over what counts as a unit of change; the accuracy is a fraction of that.
  const double accuracy = *std::max_element(settings.tolerances.begin(), settings.tolerances.end());
  SimTK::Vector& weights = start_.updZWeights();
  for (std::size_t i = 0; i < y_.size(); ++i) weights[static_cast<int>(i)] = accuracy / settings.tolerances[i];
  integrator_ = make(method, system_);
  integrator_->setAccuracy(accuracy);
  integrator_->setUseInfinityNorm(false);
  integrator_->setReturnEveryInternalStep(true);
  if (settings.max_step > 0) integrator_->setMaximumStepSize(settings.max_step);
}

void SimtkIntegrator::read() {
  const SimTK::State& state = integrator_->getAdvancedState();
  system_.realize(state, SimTK::Stage::Acceleration);
  std::copy_n(state.getZ().getContiguousScalarData(), y_.size(), y_.begin());
  std::copy_n(state.getZDot().getContiguousScalarData(), y_.size(), rate_.begin());
}

void SimtkIntegrator::restart(double t, const double* y, const double* z, int) {
  SimTK::State state = start_;
  state.setTime(t);
  std::copy_n(y, y_.size(), state.updZ().updContiguousScalarData());
  try {
    integrator_->initialize(state);
    read();
  } catch (const std::exception& error) {
    if (equations_->exception) std::rethrow_exception(std::exchange(equations_->exception, nullptr));
    throw IntegrationFailed(error.what());
  }
  y_begin_ = y_;
  rate_begin_ = rate_;
  step_begin_ = time_ = t;
  quadrature_.restart(t, y, z);
}

double SimtkIntegrator::step(double stop) {
  assert(stop > time_);
  y_begin_.swap(y_);
  rate_begin_.swap(rate_);
  try {
    for (int call = 0; integrator_->getAdvancedTime() <= time_; ++call) {
      if (call == kIdleCalls) throw std::runtime_error(kStuck);
      integrator_->stepTo(std::numeric_limits<double>::infinity(), stop);
      if (equations_->exception) throw std::runtime_error("thrown in an evaluation");
    }
    read();
  } catch (const std::exception& error) {
    y_.swap(y_begin_);
    rate_.swap(rate_begin_);
    if (equations_->exception) std::rethrow_exception(std::exchange(equations_->exception, nullptr));
    throw IntegrationFailed(error.what());
  }
  step_begin_ = time_;
  time_ = integrator_->getAdvancedTime();
  ++steps_;
  interpolate(0.5 * (step_begin_ + time_), y_middle_.data());
  quadrature_.advance(time_, y_middle_.data(), y_.data());
  return time_;
}

void SimtkIntegrator::interpolate(double t, double* y) const {
  interpolate_cubic({step_begin_, time_, y_begin_, rate_begin_, y_, rate_}, t, y);
}

void SimtkIntegrator::interpolate(double t, double* y, double* z) const {
  assert(t >= step_begin_ && t <= time_);
  interpolate(t, y);
  quadrature_.interpolate(t, z);
}

}  // namespace

std::unique_ptr<Integrator> make_simtk_integrator(SimtkMethod method, OdeSystem& system,
                                                  const IntegratorSettings& settings) {
  return std::make_unique<SimtkIntegrator>(method, system, settings);
}

}  // namespace quayside::harness
