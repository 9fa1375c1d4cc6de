// Loads on ropes.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/acceptance/scenes.h"
#include "tests/acceptance/zero_crossings.h"

namespace quayside::harness {
namespace {

using crane_models::Scene;

// Four groups of two falls of 42 MN at 25 m, and a hundred times that, where stretch does not matter any more [N/m].
constexpr double kRopeStiffness = 4 * 2 * 42e6 / 25;
constexpr double kStiffRopes = 100 * kRopeStiffness;
constexpr double kTight = 1e-9;  // relative tolerance of the solver: its error is far below the physics'

// 2/π K(sin θ₀/2) by the arithmetic-geometric mean: K(k) = π / (2 agm(1, √(1−k²))).
double amplitude_factor(double theta) {
  double a = 1, b = std::cos(theta / 2);
  for (int i = 0; i < 10; ++i) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return 1 / a;
}

TEST(Reference, AmplitudeFactors) {
  EXPECT_NEAR(amplitude_factor(5 * kPi / 180), 1.000476, 5e-7);
  EXPECT_NEAR(amplitude_factor(10 * kPi / 180), 1.001907, 5e-7);
  EXPECT_NEAR(amplitude_factor(20 * kPi / 180), 1.007669, 5e-7);
}

// On four parallel ropes of equal length a load moves in pure translation, so every point of it moves as a
// mathematical pendulum of the ropes' length: T = 2π √(L/g) · 2/π K(sin θ₀/2), 10.0303 s times the factor for L = 25
// m.
//
// Ropes stretch with their tension, m g (3 cos θ − 2 cos θ₀) in a rigid pendulum, on average by θ₀²/4 of the static
// stretch (0.2 mm) more than at rest: a relative 1e-7 in the period at 20°. Their pull passes the centre of mass, half
// a container below them, on one side, which tilts the load by some 1e-4 of θ: parts in 1e6 of the period. The bound
// is the 1e-5 that is asked for.
class SwayPeriod : public ::testing::TestWithParam<double> {};

TEST_P(SwayPeriod, IsThatOfAPendulumOfTheRopesLength) {
  const double theta = GetParam() * kPi / 180, length = 25;
  Scene scene;
  const double rest_length = hang_container(scene, {length, 2.5, 0.8, kStiffRopes});
  // Released from rest, the ropes stretched as the swing needs them there: heaving would blur the zero crossings.
  const double start_length = rest_length + kContainerMass * kGravity * std::cos(theta) / kStiffRopes;
  scene.bodies[0].X_WB.translation() =
      Eigen::Vector3d(start_length * std::sin(theta), 0, -start_length * std::cos(theta) - kContainerSize.z() / 2);
  Simulation simulation(scene, exact_contact(), kTight);
  ZeroCrossings crossings;
  double largest_tilt = 0;
  simulation.run_to(29, 0.01, [&] {
    crossings.add(simulation.time(), simulation.get("load.position.x"), simulation.get("load.velocity.x"));
    largest_tilt = std::max(largest_tilt, simulation.get("load.tilt"));
  });
  const double expected = 2 * kPi * std::sqrt(length / kGravity) * amplitude_factor(theta);
  ASSERT_EQ(crossings.times().size(), 3u);
  EXPECT_NEAR(crossings.period() / expected, 1, 1e-5);
  EXPECT_LT(largest_tilt, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Degrees, SwayPeriod, ::testing::Values(0.5, 5, 10, 20));

// Quadrifilar: turned by a small ψ about the vertical, rope ends at radius r move r ψ sideways on ropes of length h,
// so the restoring moment is m g r²/h ψ and T = 2π √(I_z h / (m g r²)): 12.6494 s for a uniform 40 ft box, h = 25 m,
// rectangles of ±0.9 × ±2.7 m. The lifting of the load adds relative terms of (r ψ / h)² = 1e-8 at ψ = 1e-3; the
// static stretch is in h.
TEST(Ropes, SkewPeriodIsQuadrifilar) {
  Scene scene;
  hang_container(scene, {25, 2.7, 0.9, kStiffRopes});
  scene.bodies[0].X_WB.linear() = Eigen::AngleAxisd(1e-3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Simulation simulation(scene, exact_contact(), kTight);
  ZeroCrossings crossings;
  simulation.run_to(38, 0.01, [&] {
    crossings.add(simulation.time(), 2 * simulation.get("load.orientation.z"),
                  simulation.get("load.angular_velocity.z"));
  });
  const double inertia = box_inertia(kContainerMass, kContainerSize)(2, 2);
  const double expected = 2 * kPi * std::sqrt(inertia * 25 / (kContainerMass * kGravity * (2.7 * 2.7 + 0.9 * 0.9)));
  EXPECT_NEAR(expected, 12.6494, 5e-5);
  ASSERT_GE(crossings.times().size(), 2u);
  EXPECT_NEAR(crossings.period() / expected, 1, 1e-5);
}

// 65 t on 1.8 MN/m: stretch m g / k = 0.354 m, heave √(k/m) / 2π = 0.838 Hz. The ropes are linear while they are taut,
// so both are exact.
TEST(Ropes, StretchAndHeaveAreThoseOfASpring) {
  const double mass = 65000, stiffness = 1.8e6;
  Scene scene;
  hang_container(scene, {25, 2.5, 0.8, stiffness, 0, mass});
  Simulation at_rest(scene, exact_contact(), kTight);
  const double stretch = mass * kGravity / stiffness;
  EXPECT_NEAR(stretch, 0.354, 5e-4);
  at_rest.run_to(1, 0.1);
  EXPECT_NEAR(at_rest.get("rope0.stretch"), stretch, 1e-8);
  EXPECT_NEAR(at_rest.get("rope0.tension"), mass * kGravity / 4, 1e-2);

  const double middle = scene.bodies[0].X_WB.translation().z();
  scene.bodies[0].X_WB.translation().z() -= 0.1;
  Simulation heaving(scene, exact_contact(), kTight);
  ZeroCrossings crossings;
  heaving.run_to(7, 0.002, [&] {
    crossings.add(heaving.time(), heaving.get("load.position.z") - middle, heaving.get("load.velocity.z"));
  });
  const double frequency = std::sqrt(stiffness / mass) / (2 * kPi);
  EXPECT_NEAR(frequency, 0.838, 5e-4);
  EXPECT_NEAR(1 / crossings.period(), frequency, 1e-6);
}

// A trolley on rails along y, driven, with a load on ropes.
Scene trolley_scene() {
  Scene scene;
  scene.drives.push_back({"trolley", "m", "position", 0, 1, 4, 0.6});
  crane_models::Body trolley;
  trolley.name = "trolley";
  trolley.mass = 12000;
  trolley.joint.type = crane_models::JointType::slider;
  trolley.joint.drive = 0;
  // The slider moves along F's x axis, which is turned to the world's y; M is turned alike, so that B is not.
  trolley.joint.X_PF.linear() = Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  trolley.joint.X_BM.linear() = trolley.joint.X_PF.linear();
  add_body(scene, trolley);
  Hoist hoist{25, 2.5, 0.8, kStiffRopes};
  hoist.upper = 0;
  hang_container(scene, hoist);
  return scene;
}

// In the frame of a trolley with acceleration a, gravity leans back by atan(a/g): a load released there stays there,
// 3.50° at 0.6 m/s². What the drive puts in is then exactly the kinetic energy of both and the work of pulling the
// load along.
TEST(Ropes, LoadLagsBehindAnAcceleratingTrolley) {
  const double acceleration = 0.6, lag = std::atan(acceleration / kGravity);
  EXPECT_NEAR(lag * 180 / kPi, 3.50, 5e-3);
  Scene scene = trolley_scene();
  const double tension = kContainerMass * std::hypot(kGravity, acceleration);
  const double rest_length = 25 - kContainerMass * kGravity / kStiffRopes;
  // All of its mass at the height of the ropes' ends, so that their pull does not tilt it.
  scene.bodies[1].p_BBcm.z() = kContainerSize.z() / 2;
  const double length = rest_length + tension / kStiffRopes;
  scene.bodies[1].X_WB.translation() =
      Eigen::Vector3d(0, -length * std::sin(lag), -length * std::cos(lag) - kContainerSize.z() / 2);
  Simulation simulation(scene, exact_contact(), kTight);
  simulation.set("trolley.acceleration", acceleration);
  double largest_error = 0;
  simulation.run_to(6, 0.05, [&] {
    const Eigen::Vector3d p = simulation.vector("load.position") - simulation.vector("trolley.position");
    largest_error = std::max(largest_error, std::abs(std::atan2(-p.y(), -p.z() - kContainerSize.z() / 2) - lag));
  });
  EXPECT_LT(largest_error, 1e-7);
  EXPECT_NEAR(simulation.get("trolley.position.y"), 0.5 * acceleration * 36, 1e-12);
  EXPECT_NEAR(simulation.get("trolley.velocity.y"), acceleration * 6, 1e-12);
  const EnergyLedger energy = simulation.engine().energy();
  const double speed = acceleration * 6;
  EXPECT_NEAR(energy.work_in / (0.5 * (kContainerMass + 12000) * speed * speed), 1, 1e-6);
  EXPECT_LT(std::abs(simulation.relative_residual()), 1e-6);
}

// A move without jerk limit, from rest to rest: sway left after one ramp 2 (a/g) |sin(ω t_a/2)|, after the whole
// move 4 (a/g) |sin(ω t_a/2) · sin(ω (t_c + t_a)/2)|, both as angles for small ones: the pendulum's own amplitude
// factor at 4° changes ω by 3e-4 and the angle by some 1e-3 of it.
TEST(Ropes, SwayLeftByATrolleyMove) {
  const double acceleration = 0.3, ramp = 4, cruise = 3, length = 25;
  const double omega = std::sqrt(kGravity / length);
  Scene scene = trolley_scene();
  Simulation simulation(scene, exact_contact(), 1e-8);
  simulation.set("trolley.acceleration", acceleration);
  simulation.run_to(ramp, 0.1);
  simulation.set("trolley.acceleration", 0);
  simulation.run_to(ramp + cruise, 0.1);
  simulation.set("trolley.acceleration", -acceleration);
  simulation.run_to(2 * ramp + cruise, 0.1);
  simulation.set("trolley.acceleration", 0);
  simulation.set("trolley.rate", 0);
  double amplitude = 0;
  simulation.run_to(2 * ramp + cruise + 11, 0.02, [&] {
    const double lag = simulation.get("load.position.y") - simulation.get("trolley.position.y");
    amplitude = std::max(amplitude, std::abs(lag) / length);
  });
  const double expected = 4 * acceleration / kGravity * std::abs(std::sin(omega * ramp / 2)) *
                          std::abs(std::sin(omega * (cruise + ramp) / 2));
  EXPECT_NEAR(amplitude / expected, 1, 5e-3);
  EXPECT_LT(std::abs(simulation.relative_residual()), 1e-5);
}

// A pendulum whose length shrinks as L = L₀ − v t obeys L θ'' − 2 v θ' + g θ = 0, with the solution
// θ = (A J₁(x) + B Y₁(x)) / x, x = 2 √(g L) / v; dx/dt = −√(g/L), and (Z₁/x)' = −Z₂/x for both kinds. From 25 m to 10 m at
// 0.5 m/s the angle grows twofold, the swing of the load by a quarter. Amplitudes of 0.5° to 1° lengthen the period by 5e-6 to
// 2e-5, and so shift a phase of 25 rad by 3e-4 and the doubled angle by 6e-4 of its start.
TEST(Ropes, SwayGrowsOnHoistingUp) {
  const double speed = 0.5, from = 25, theta = 0.5 * kPi / 180;
  Scene scene;
  scene.drives.push_back({"hoist", "m", "rest length", 0, -1, 1, 0.5});
  Hoist hoist{from, 2.5, 0.8, kStiffRopes};
  hoist.drive = 0;
  hang_container(scene, hoist);
  crane_models::Body& load = scene.bodies[0];
  const Eigen::Vector3d along(0, std::sin(theta), -std::cos(theta));  // the ropes, downward
  load.X_WB.translation() += from * (along + Eigen::Vector3d::UnitZ());
  load.v_WB = -speed * along;
  Simulation simulation(scene, exact_contact(), kTight);
  simulation.set("hoist.rate", -speed);

  const auto x_at = [&](double time) { return 2 * std::sqrt(kGravity * (from - speed * time)) / speed; };
  const double x0 = x_at(0);  // θ = theta and θ' = 0 there: A J₁ + B Y₁ = theta x, A J₂ + B Y₂ = 0
  const double wronskian = std::cyl_bessel_j(1, x0) * std::cyl_neumann(2, x0) - std::cyl_bessel_j(2, x0) * std::cyl_neumann(1, x0);
  const double a = theta * x0 * std::cyl_neumann(2, x0) / wronskian;
  const double b = -theta * x0 * std::cyl_bessel_j(2, x0) / wronskian;
  double largest_error = 0, largest_angle = 0;
  simulation.run_to(30, 0.05, [&] {
    const double x = x_at(simulation.time());
    const double expected = (a * std::cyl_bessel_j(1, x) + b * std::cyl_neumann(1, x)) / x;
    const double angle = std::atan2(simulation.get("load.position.y"), -simulation.get("load.position.z") - kContainerSize.z() / 2);
    largest_error = std::max(largest_error, std::abs(angle - expected));
    largest_angle = std::max(largest_angle, std::abs(angle));
  });
  EXPECT_LT(largest_error / theta, 1e-3);
  EXPECT_NEAR(largest_angle / theta, std::pow(25.0 / 10.0, 0.75), 0.1);  // the adiabatic law, of slow hoisting
}

}  // namespace
}  // namespace quayside::harness
