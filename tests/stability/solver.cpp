// What the solver has to get right whatever the scene: rotations, communication steps, tolerances.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tests/stability/hard_case.h"

namespace quayside::harness {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Euler's equations have no solution that stays about the middle axis: the box turns over again and again. Energy and
// angular momentum stay.
void free_spin(const HardCaseSettings& settings, Findings& findings) {
  const Vector3d size(3, 2, 1);
  constexpr double kMass = 1000, kSpin = 2;
  struct Level {
    double tolerance, threshold;
    const char* reason;
  };
  const Level levels[] = {{kDefaultTolerance, 1e-4, "default tolerance: 100 s of steps with 1e-6 each, most of one sign"},
                          {1e-12, 1e-8, "asked for, at the tightest tolerance"}};
  for (const auto& [tolerance, threshold, reason] : levels) {
    if (!settings.whole && tolerance < 1e-10) continue;
    crane_models::Body box = free_box("box", kMass, size, at(0, 0, 0));
    box.w_WB = {0.01, kSpin, 0.01};
    Simulation simulation(scene_of({box}, false), default_contact(settings), tolerance);
    const auto momentum = [&]() -> Vector3d {
      const Matrix3d R = simulation.quaternion("box.orientation").toRotationMatrix();
      return R * box_inertia(kMass, size) * R.transpose() * simulation.vector("box.angular_velocity");
    };
    const Vector3d start = momentum();
    const double energy = simulation.engine().energy().kinetic;
    double momentum_error = 0, energy_error = 0;
    int turns = 0;
    bool upright = true;
    simulation.run_to(100, 0.1, [&] {
      momentum_error = std::max(momentum_error, (momentum() - start).norm() / start.norm());
      energy_error = std::max(energy_error, std::abs(simulation.engine().energy().kinetic / energy - 1));
      const double w_y = (simulation.quaternion("box.orientation").conjugate() * simulation.vector("box.angular_velocity")).y();
      if (std::abs(w_y) > 0.9 * kSpin && (w_y > 0) != upright) upright = !upright, ++turns;
    });
    const std::string how = fmt::format(" (tolerance {:g})", tolerance);
    findings.at_most("energy, relative change in 100 s" + how, "1", energy_error, threshold, reason);
    findings.at_most("angular momentum, relative change in 100 s" + how, "1", momentum_error, threshold, reason);
    findings.near("turned over at least five times" + how, "1", std::min(turns, 5), 5, 0, "or it was no test");
  }
}

// About a principal axis the attitude is known: R(t) = R₀ exp(ω t). Started where some set of Euler angles is singular (pitch
// ±90°, in all orders of axes) and turned through the others, nothing may happen: the coordinates are quaternions.
void euler_singularities(const HardCaseSettings& settings, Findings& findings) {
  double largest = 0;
  for (int first = 0; first < 3; ++first) {
    for (const double pitch : {-kPi / 2, 0.0, kPi / 2, kPi}) {
      for (int axis = 0; axis < 3; ++axis) {
        crane_models::Body box = free_box("box", 1000, {3, 2, 1}, turned(Vector3d::Unit(first), pitch, {0, 0, 0}));
        const Matrix3d R = box.X_WB.linear();
        box.w_WB = R.col(axis) * 2 * kPi / 4;  // five turns in 20 s
        Simulation simulation(scene_of({box}, false), default_contact(settings), kDefaultTolerance);
        simulation.run_to(20, 1, [&] {
          const Matrix3d expected = R * Eigen::AngleAxisd(2 * kPi / 4 * simulation.time(), Vector3d::Unit(axis)).toRotationMatrix();
          const Eigen::AngleAxisd error(simulation.quaternion("box.orientation").toRotationMatrix() * expected.transpose());
          largest = std::max(largest, std::abs(std::remainder(error.angle(), 2 * kPi)));
        });
      }
    }
  }
  findings.at_most("attitude after up to five turns, worst of 36 starts", "rad", largest, 6e-4,
                   "2,700 steps that may err by the tolerance of a quaternion each, 1e-7 of half an angle, all alike");

  // And a motion in all directions does not depend on how the world is turned.
  Eigen::Quaterniond reference;
  double difference = 0;
  for (int turn = 0; turn < 4; ++turn) {
    const Matrix3d Q = turn == 0 ? Matrix3d(Matrix3d::Identity())
                                 : Matrix3d(Eigen::AngleAxisd(kPi / 2, Vector3d::Unit(turn - 1)).toRotationMatrix());
    crane_models::Body box = free_box("box", 1000, {3, 2, 1}, turned({1, 2, 3}, 1, {0, 0, 0}));
    box.X_WB.linear() = Q * box.X_WB.linear();
    box.w_WB = Q * Vector3d(0.3, 1.5, 0.7);
    Simulation simulation(scene_of({box}, false), default_contact(settings), kDefaultTolerance);
    simulation.run_to(20, 1);
    const Eigen::Quaterniond q = Eigen::Quaterniond(Q).conjugate() * simulation.quaternion("box.orientation");
    if (turn == 0) reference = q;
    difference = std::max(difference, q.angularDistance(reference));
  }
  findings.at_most("tumbling in a world turned by 90°, difference after 20 s", "rad", difference, 1e-3,
                   "the quaternions differ, so steps may: some thousand of 2e-7 rad each");
}

// A container comes down on a corner, sliding, rocks and lies: two seconds with every kind of contact.
crane_models::Scene corner_landing() {
  crane_models::Body box = container("box", at(0, 0, 0.1 + kContainerSize.z() / 2));
  box.X_WB.linear() = (Eigen::AngleAxisd(0.03, Vector3d::UnitX()) * Eigen::AngleAxisd(0.02, Vector3d::UnitY())).toRotationMatrix();
  box.X_WB.translation().z() = 0.1 - lowest(kContainerSize, box.X_WB.linear());
  box.v_WB = {0.2, 0, -0.5};
  return scene_of({ground(), box});
}
constexpr double kCornerTime = 2;  // [s]

struct Path {
  std::vector<Vector3d> positions;  // every 0.1 s
  double peak_force = 0;
};

Path corner_path(const HardCaseSettings& settings, double tolerance, double communication_step) {
  Simulation simulation(corner_landing(), default_contact(settings), tolerance);
  Path path;
  for (int i = 1; i <= 20; ++i) {
    simulation.run_to(0.05 * kCornerTime * i, communication_step);
    path.positions.push_back(pose(simulation, "box") * Vector3d(0.5 * kContainerSize));  // a corner: turning counts too
  }
  for (const Event& event : simulation.engine().take_events()) path.peak_force = std::max(path.peak_force, event.peak_force);
  return path;
}

double largest_distance(const Path& a, const Path& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) largest = std::max(largest, (a.positions[i] - b.positions[i]).norm());
  return largest;
}

// The integrator runs ahead of the communication and answers from its dense output, so how often it is asked must not matter but
// for the moments at which its order changes, which it looks at there as well.
void communication_steps(const HardCaseSettings& settings, Findings& findings) {
  const Path reference = corner_path(settings, kDefaultTolerance, 1e-2);
  for (const double step : {1e-5, 1e-4, 1e-3, 1e-1}) {
    if (!settings.whole && step < 1e-4) continue;
    const Path path = corner_path(settings, kDefaultTolerance, step);
    findings.at_most(fmt::format("corner with steps of {:g} s, from that with 0.01 s", step), "m", largest_distance(path, reference), 1e-6,
                     "a step at the tolerance of 1e-6 m");
  }
}

// Every tolerance from 1e-3 to 1e-12 must run, and the error go down with it: the corner's way against the converged
// one, at most a hundred times the tolerance: some hundred steps of blows and rocking, whose errors are of the tolerance each.
void tolerances(const HardCaseSettings& settings, Findings& findings) {
  const Path reference = corner_path(settings, settings.whole ? 1e-13 : 1e-11, 1e-1);
  for (int exponent = 3; exponent <= (settings.whole ? 12 : 8); ++exponent) {
    const double tolerance = std::pow(10, -exponent);
    double error = std::nan("");
    try {
      error = largest_distance(corner_path(settings, tolerance, 1e-1), reference);
    } catch (const StepFailed&) {
    }
    findings.at_most(fmt::format("largest error of a corner in a rough landing at tolerance 1e-{:02}", exponent), "m", error, 100 * tolerance,
                     "a hundred times the tolerance");
  }
}

}  // namespace

std::vector<HardCase> solver_cases() {
  return {{"free_spin", "a free box about its middle axis for 100 s", free_spin},
          {"euler_singularities", "attitudes through every singularity of Euler angles", euler_singularities},
          {"communication_steps", "a rough landing asked for every 1e-5 to 1e-1 s", communication_steps},
          {"tolerances", "a rough landing at tolerances from 1e-3 to 1e-12", tolerances}};
}

}  // namespace quayside::harness
