// Ropes that go slack and catch, and ropes that are much stiffer than any.
#include <cmath>

#include "tests/acceptance/zero_crossings.h"
#include "tests/stability/hard_case.h"

namespace quayside::harness {
namespace {

// Four groups of two falls of 42 MN at 25 m [N/m].
constexpr double kRopeStiffness = 4 * 2 * 42e6 / 25;

// A load is let go `drop` above the length at which its ropes are taut. It falls freely for √(2 drop/g), the ropes
// catch it at v = √(2 g drop), stretch up to m g + √((m g)² + k m v²), throw it back with v after (2/ω)(π − atan(vω/g)),
// ω = √(k/m), and so on for ever: nothing takes energy. All of it vertical and without any turning.
//
// Each of the solver's steps may err by its tolerance, 1e-6 m/s. Were all of one sign, the n steps of a bounce would change its 1.4
// m/s by n 1e-6 m/s: of the energy twice that share a bounce; of the flights 2 Δv/g each, Δv growing from bounce to bounce, which
// makes 20 n 1e-6 m/s / g by the fifth catch.
void bounce_on_ropes(const HardCaseSettings& settings, Findings& findings, double mass, double stiffness) {
  constexpr double kDrop = 0.1;  // [m]
  constexpr int kBounces = 5;
  crane_models::Scene scene;
  hang_container(scene, {25, 2.5, 0.8, stiffness, 0, mass});
  const double static_stretch = mass * kGravity / stiffness;
  scene.bodies[0].X_WB.translation().z() += static_stretch + kDrop;
  Simulation simulation(scene, default_contact(settings), kDefaultTolerance);

  const double v = std::sqrt(2 * kGravity * kDrop), omega = std::sqrt(stiffness / mass);
  const double fall = v / kGravity, taut = 2 / omega * (kPi - std::atan(v * omega / kGravity));
  const double weight = mass * kGravity;
  double largest_tilt = 0;
  simulation.run_to(fall + 0.5 * taut, 0.01);
  double tension = 0;
  for (int i = 0; i < 4; ++i) tension += simulation.get("rope" + std::to_string(i) + ".tension");
  simulation.run_to(2 * kBounces * fall + kBounces * taut, 0.01,
                    [&] { largest_tilt = std::max(largest_tilt, simulation.get("load.tilt")); });
  const auto caught = events_of(simulation, EventKind::rope_taut);
  const double drift = kDefaultTolerance * static_cast<double>(simulation.engine().statistics().steps) / kBounces;  // [m/s] a bounce

  findings.near("peak tension over m g + √((m g)² + k m v²)", "1",
                tension / (weight + std::sqrt(weight * weight + stiffness * mass * v * v)), 1, 1e-4,
                "half a bounce: some 30 steps of 1e-6 m/s each, 2e-5, and the start of the fall");
  const double last = (2 * kBounces - 1) * fall + (kBounces - 1) * taut;
  findings.near("time of the fifth catch", "s",
                caught.size() == 4 * kBounces ? seconds(caught.back().time) : std::nan(""), last, 20 * drift / kGravity,
                "1e-6 m/s a step, all of one sign");
  findings.at_most("tilt", "rad", largest_tilt, 1e-9, "nothing turns the load: rounding");
  findings.at_most("energy missing, of the largest exchange", "1", simulation.relative_residual(), kBounces * 2 * drift / v,
                   "1e-6 m/s a step, all of one sign");
}

void slack_taut_empty(const HardCaseSettings& s, Findings& f) { bounce_on_ropes(s, f, 500, kRopeStiffness); }
void slack_taut_loaded(const HardCaseSettings& s, Findings& f) { bounce_on_ropes(s, f, 40e3, kRopeStiffness); }
void slack_taut_stiff(const HardCaseSettings& s, Findings& f) { bounce_on_ropes(s, f, 40e3, 100 * kRopeStiffness); }

// A pendulum on ropes a hundred times as stiff, deflected by 5°: T = 2π √(L/g) times 1.000476 (the complete elliptic
// integral), and tension m g (3 cos θ − 2 cos θ₀). The integrator must not follow the heave, 11 Hz there, once that has
// nothing to do with the motion: started stretched as the swing needs them there, the ropes need hardly more
// evaluations than ropes of normal stiffness.
void stiff_pendulum(const HardCaseSettings& settings, Findings& findings) {
  constexpr double kAngle = 5 * kPi / 180, kLength = 25, kFactor = 1.000476;
  double evaluations[2];
  double period = 0, tension = 0;
  for (const int stiff : {0, 1}) {
    const double stiffness = kRopeStiffness * (stiff ? 100 : 1);
    crane_models::Scene scene;
    const double rest_length = hang_container(scene, {kLength, 2.5, 0.8, stiffness});
    const double start_length = rest_length + kContainerMass * kGravity * std::cos(kAngle) / stiffness;
    scene.bodies[0].X_WB.translation() = Eigen::Vector3d(
        start_length * std::sin(kAngle), 0, -start_length * std::cos(kAngle) - kContainerSize.z() / 2);
    Simulation simulation(scene, default_contact(settings), kDefaultTolerance);
    ZeroCrossings crossings;
    const double expected_period = 2 * kPi * std::sqrt(kLength / kGravity) * kFactor;
    simulation.run_to(0.75 * expected_period, 0.01, [&] {
      crossings.add(simulation.time(), simulation.get("load.position.x"), simulation.get("load.velocity.x"));
    });
    tension = 0;
    for (int i = 0; i < 4; ++i) tension += simulation.get("rope" + std::to_string(i) + ".tension");
    simulation.run_to(29, 0.01, [&] {
      crossings.add(simulation.time(), simulation.get("load.position.x"), simulation.get("load.velocity.x"));
    });
    period = crossings.period() / expected_period;
    evaluations[stiff] = static_cast<double>(simulation.engine().statistics().rhs_evaluations);
  }
  findings.near("period over the rigid pendulum's", "1", period, 1, 1e-4,
                "18 s at 1e-6: an error of some 1e-5 m and m/s against an amplitude of 2 m");
  findings.near("tension at the bottom over m g (3 − 2 cos θ₀)", "1",
                tension / (kContainerMass * kGravity * (3 - 2 * std::cos(kAngle))), 1, 2e-2,
                "1e-6 m of a rope's length is 1.3 kN of 300 kN, and quarter of a swing adds up some");
  findings.at_most("evaluations over those with ropes of normal stiffness", "1", evaluations[1] / evaluations[0], 5,
                   "a solver that follows the heave needs ten times as many: its frequency is √100 times higher");
}

}  // namespace

std::vector<HardCase> rope_cases() {
  return {{"slack_taut_0.5t", "an empty hook of 0.5 t falls 0.1 m into slack ropes, five times", slack_taut_empty},
          {"slack_taut_40t", "the same with 40 t", slack_taut_loaded},
          {"slack_taut_stiff", "the same with 40 t on ropes 100 times stiffer", slack_taut_stiff},
          {"stiff_ropes", "three swings of 5° on ropes 100 times stiffer", stiff_pendulum}};
}

}  // namespace quayside::harness
