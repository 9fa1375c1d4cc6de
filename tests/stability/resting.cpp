// Coming to rest, and staying there.
#include <algorithm>
#include <cmath>

#include "contact_nn/restitution.h"
#include "contact_nn/triangle_moments.h"
#include "tests/stability/hard_case.h"

namespace quayside::harness {
namespace {

using Eigen::Vector3d;

constexpr int kHigh = 9;

// Nine containers, all of them moving bodies, each at the depth at which it rests.
crane_models::Scene stack(double stiffness, const Vector3d& offset) {
  crane_models::Scene scene = scene_of({ground()});
  double top = 0;
  for (int i = 0; i < kHigh; ++i) {
    top -= (kHigh - i) * kContainerMass * kGravity / stiffness;
    add_body(scene, container("box" + std::to_string(i), at(i * offset.x(), i * offset.y(), top + kContainerSize.z() / 2)));
    top += kContainerSize.z();
  }
  return scene;
}

// It settles and then stands for 60 s. Aligned it stands straight: nothing moves. Offset by 30 and 20 mm from box to box it leans, by
// parts of a milliradian; it rocks for two minutes, since the law damps in proportion to the force and a tower's rocking presses
// little; and then friction creeps for ever, as the law says, at v_t0/μ times the share of the load that pushes sideways. That is
// the lean of a contact, half that of either box; and, since the potential ½ K δ² (A/A_f)^(2/p) falls when the overlap A of
// two offset faces shrinks, δ/(p L) towards more offset, L the length of the overlap.
//
// Friction that sticks holds such loads without creep: what is left is the rocking.
void stack_of_nine(const HardCaseSettings& settings, contact_nn::Friction friction, Findings& findings) {
  auto contact = default_contact(settings);
  contact.friction_law = friction;
  const bool sticks = friction == contact_nn::Friction::bristle;
  for (const bool offset : {false, true}) {
    if (offset && !settings.whole) continue;
    const double settled = offset ? 200 : 20;
    Simulation simulation(stack(contact.stiffness, offset ? Vector3d(0.03, 0.02, 0) : Vector3d::Zero()), contact, kDefaultTolerance);
    simulation.run_to(settled, 0.1);
    std::vector<Vector3d> start;
    for (int i = 0; i < kHigh; ++i) start.push_back(simulation.vector("box" + std::to_string(i) + ".position"));
    double drift = 0, speed = 0;
    simulation.run_to(settled + 60, 0.1, [&] {
      for (int i = 0; i < kHigh; ++i) {
        const std::string box = "box" + std::to_string(i);
        drift = std::max(drift, (simulation.vector(box + ".position") - start[i]).norm());
        speed = std::max(speed, simulation.vector(box + ".velocity").norm());
      }
    });
    const std::string how = offset ? " (offset by 30 and 20 mm each)" : " (aligned)";
    const char* const why = offset ? "Creep of the regularised friction, see the next line: the law, not the solver"
                                   : "The solver's steps at rest grow until their errors are the tolerance";
    auto& seen = findings.at_most("drift in 60 s" + how, "m", drift, 1e-4, "a tenth of a millimetre is what a user can see");
    if (!sticks) seen.short_of(1e-3, why);
    auto& moving = findings.at_most("largest speed in that time" + how, "m/s", speed, 1e-6, "the solver's tolerance");
    if (!sticks) moving.short_of(2e-5, why);
    if (!offset || sticks) continue;
    // Sliding in each contact between boxes against that creep; at the worst contact.
    double worst = 0;
    for (int i = 1; i < kHigh; ++i) {
      const auto motion = [&](int index, double end) {  // of the middle of a box' bottom or top
        const std::string box = "box" + std::to_string(index);
        const Vector3d z_W = pose(simulation, box).linear().col(2);
        const Vector3d v = simulation.vector(box + ".velocity") +
                           simulation.vector(box + ".angular_velocity").cross(end * 0.5 * kContainerSize.z() * z_W);
        return std::pair(z_W, v);
      };
      const auto [z_lower, v_lower] = motion(i - 1, 1);
      const auto [z_upper, v_upper] = motion(i, -1);
      const double depth = (kHigh - i) * kContainerMass * kGravity / contact.stiffness;
      const Eigen::Array2d overlap = kContainerSize.head<2>().array() - Eigen::Array2d(0.03, 0.02);
      const Eigen::Array2d sideways = 0.5 * (z_lower + z_upper).head<2>().array() + depth / (contact_nn::kNorm * overlap);
      const Eigen::Vector2d creep = contact.transition_speed / contact.friction * sideways;
      worst = std::max(worst, ((v_upper - v_lower).head<2>() - creep).norm() / creep.norm());
    }
    findings.at_most("sliding of a contact over the law's creep, less 1, at worst", "1", worst, 0.05,
                     "small angles and depths: parts in 100; rocking is over to 1 %");
  }
}

// One dimension: a flat face at depth d that moves in at s is pushed with K d (1 + c s)₊ against gravity. Classical
// Runge-Kutta at 1 µs, whose error is far below everything here. Returns the times at which contacts are made, the last one of
// which lasts.
std::vector<double> bounces(double height, double stiffness, double c) {
  constexpr double kStep = 1e-6, kEnd = 4;
  const auto acceleration = [&](double z, double v) {
    return -kGravity + (z < 0 ? stiffness / kContainerMass * -z * std::max(0.0, 1 - c * v) : 0);
  };
  std::vector<double> made;
  double z = height, v = 0;
  for (long i = 0; i * kStep < kEnd; ++i) {
    const double h = kStep;
    const double a1 = acceleration(z, v), v2 = v + 0.5 * h * a1;
    const double a2 = acceleration(z + 0.5 * h * v, v2), v3 = v + 0.5 * h * a2;
    const double a3 = acceleration(z + 0.5 * h * v2, v3), v4 = v + h * a3;
    const double a4 = acceleration(z + h * v3, v4);
    const double next = z + h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    if (z >= 0 && next < 0) made.push_back((i + z / (z - next)) * kStep);
    z = next;
  }
  return made;
}

// A container dropped flat from 0.1 m bounces until a blow is too weak to throw it off again; the time of that last
// touch is the end of the bouncing. Three answers: the unit's, the one-dimensional law integrated on its own, and impacts
// of no duration, v → e(v) v with a flight of 2 v/g each, to which the contacts' own durations, at most 2 π √(m/K) each,
// have to be added.
void bounce_to_rest(const HardCaseSettings& settings, Findings& findings) {
  constexpr double kHeight = 0.1;
  auto contact = default_contact(settings);
  contact.restitution = 0.5;
  const double c = contact_nn::damping_for(contact.restitution, contact.reference_speed);
  const double stiffness = flat_stiffness(contact, kContainerSize.x() * kContainerSize.y());
  const auto last_touch = [&](double tolerance) {
    Simulation simulation(scene_of({ground(), container("box", at(0, 0, kHeight + kContainerSize.z() / 2))}), contact, tolerance);
    simulation.run_to(4, 0.05);
    const auto made = events_of(simulation, EventKind::contact_made);
    return std::pair(seconds(made.back().time), made.size());
  };
  const auto [time, touches] = last_touch(kDefaultTolerance);
  const auto [converged, converged_touches] = last_touch(1e-11);
  const auto reference = bounces(kHeight, stiffness, c);
  findings.near("touches until it rests, as in one dimension", "1", static_cast<double>(touches), static_cast<double>(reference.size()), 0,
                "none is close to the limit");
  findings.near("last touch over the converged one", "1", time / converged, 1, 1e-3, "the solver leaves some 1e-5 s");
  findings.near("last touch over the one-dimensional law's", "1", time / reference.back(), 1, 1e-3,
                "the strip along the border: 0.1 % of the stiffness, and so of contacts of 22 ms each");
  double v = std::sqrt(2 * kGravity * kHeight), impulsive = v / kGravity;
  for (std::size_t i = 1; i < touches; ++i) {
    v *= contact_nn::restitution_of(c, v);
    impulsive += 2 * v / kGravity;
  }
  findings.near("last touch after that with impacts of no duration", "s", time - impulsive,
                0.5 * (touches - 1) * 2 * kPi * std::sqrt(kContainerMass / stiffness),
                0.5 * (touches - 1) * 2 * kPi * std::sqrt(kContainerMass / stiffness),
                "between none and a whole oscillation, 2 π √(m/K) = 45 ms, for each contact");
  Simulation resting(scene_of({ground(), container("box", at(0, 0, kHeight + kContainerSize.z() / 2))}), contact, kDefaultTolerance);
  resting.run_to(10, 0.1);
  findings.at_most("speed after 10 s", "m/s", resting.vector("box.velocity").norm(), 1e-6, "the solver's tolerance");
}

}  // namespace

std::vector<HardCase> resting_cases() {
  return {{"stack_of_9", "nine containers stand on one another for a minute",
           [](const auto& settings, auto& findings) { stack_of_nine(settings, contact_nn::Friction::regularised, findings); }},
          {"stack_of_9_sticking", "the same under friction that sticks (`contact.friction.law: bristle`)",
           [](const auto& settings, auto& findings) { stack_of_nine(settings, contact_nn::Friction::bristle, findings); }},
          {"bounce_to_rest", "a container dropped flat from 0.1 m", bounce_to_rest}};
}

}  // namespace quayside::harness
