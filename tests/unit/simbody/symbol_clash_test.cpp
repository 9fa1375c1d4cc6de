// Simbody carries an older SUNDIALS for its own CPODES, under the same function names as ours. Both have to work in
// one process, in turn and with the right answers; linked carelessly, one of them calls into the other and crashes.
#include <cmath>

#include <gtest/gtest.h>

#include <Simbody.h>

#include "tests/unit/simbody/oscillator.h"

namespace quayside::harness {
namespace {

// Local errors of 1e-9 a step add up over some hundred steps of a neutral oscillator.
constexpr double kTolerance = 1e-9;
constexpr double kError = 1e-6;

void integrate_with_cvodes(double duration) {
  Oscillator oscillator;
  const auto integrator = make_integrator("bdf", oscillator, {{kTolerance, kTolerance}, 1, 0});
  double y[] = {1, 0}, z[] = {0};
  integrator->restart(0, y, z, 5);
  while (integrator->time() < duration) integrator->step(1e9);
  integrator->interpolate(duration, y, z);
  EXPECT_NEAR(y[0], std::cos(duration), kError);
  EXPECT_NEAR(y[1], -std::sin(duration), kError);
  EXPECT_NEAR(z[0], std::sin(duration), kError);
}

// A mass of 1 kg on a spring of 1 N/m.
void integrate_with_cpodes(double duration) {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter(system);
  SimTK::GeneralForceSubsystem forces(system);
  const SimTK::Body::Rigid body(SimTK::MassProperties(1, SimTK::Vec3(0), SimTK::Inertia(1)));
  SimTK::MobilizedBody::Slider mass(matter.updGround(), SimTK::Transform(), body, SimTK::Transform());
  SimTK::Force::MobilityLinearSpring(forces, mass, SimTK::MobilizerQIndex(0), 1.0, 0.0);
  SimTK::State state = system.realizeTopology();
  mass.setQ(state, 1.0);
  SimTK::CPodesIntegrator integrator(system, SimTK::CPodes::BDF, SimTK::CPodes::Newton);
  integrator.setAccuracy(kTolerance);
  SimTK::TimeStepper stepper(system, integrator);
  stepper.initialize(state);
  stepper.stepTo(duration);
  // Its error control is relative and looser than ours.
  EXPECT_NEAR(mass.getQ(stepper.getState()), std::cos(duration), 100 * kError);
}

TEST(SymbolClash, CvodesAndCpodesWorkInOneProcess) {
  integrate_with_cvodes(3);
  integrate_with_cpodes(3);
  integrate_with_cvodes(5);
  integrate_with_cpodes(5);
}

}  // namespace
}  // namespace quayside::harness
