// Boxes that meet in the ways that break contact models.
#include <algorithm>
#include <cmath>

#include "contact_nn/restitution.h"
#include "contact_nn/triangle_moments.h"
#include "tests/stability/hard_case.h"

namespace quayside::harness {
namespace {

using contact_nn::ContactForce;
using crane_models::Pose;
using Eigen::Vector3d;

// A box of the size of a container that stays where it is, its top at z = 0.
crane_models::Body fixed_container() {
  crane_models::Body body = ground();
  body.name = "lower";
  body.boxes[0].half = 0.5 * kContainerSize;
  body.X_WB = at(0, 0, -0.5 * kContainerSize.z());
  return body;
}

// --- Landing ---------------------------------------------------------------------------------------------------------

// All four corners at once: what is symmetric stays so. The forces are symmetric to rounding, 1e-9 N m of 1e6 N, which is 1e-15
// rad/s² and moves nothing; the centre of pressure is that of the faces to 1e-16 of their size. But a tilt θ at a depth
// δ moves it by (p − 1) θ L²/(12 δ) (see near_parallel_faces), 0.17 m a microradian at the depth of rest, 0.5 mm. It is
// measured while the contact carries at least the weight.
void flat_landing(const HardCaseSettings& settings, Findings& findings) {
  struct Level {
    double tolerance;
    bool on_container;
  };
  for (const auto& [tolerance, on_container] : {Level{kDefaultTolerance, false}, {kDefaultTolerance, true}, {1e-10, false}}) {
    const crane_models::Body below = on_container ? fixed_container() : ground();
    crane_models::Scene scene = scene_of({below, container("box", at(0, 0, 0.05 + 0.5 * kContainerSize.z()))});
    scene.bodies[1].v_WB.z() = -0.5;
    const auto contact = default_contact(settings);
    const auto module = contact_nn::make_contact_module(contact);
    Simulation simulation(scene, contact, tolerance);
    double spin = 0, tilt = 0, off_centre = 0;
    simulation.run_to(3, 0.001, [&] {
      spin = std::max(spin, simulation.vector("box.angular_velocity").norm());
      tilt = std::max(tilt, simulation.get("box.tilt"));
      const ContactForce force = contact_between(*module, simulation, below.name, 2 * below.boxes[0].half, "box", kContainerSize);
      if (force.normal_force >= 0.9 * kContainerMass * kGravity) {
        off_centre = std::max(off_centre, force.impact_point_A.head<2>().norm());
      }
    });
    const bool tight = tolerance < kDefaultTolerance;
    const std::string where = on_container ? ", on a container" : tight ? ", on the ground at 1e-10" : ", on the ground";
    findings.at_most("largest tilt" + where, "rad", tilt, 1e-9, "symmetric: rounding only");
    findings.at_most("largest spin" + where, "rad/s", spin, 1e-9, "symmetric: rounding only");
    findings.at_most("centre of pressure from the centre" + where, "m", off_centre, 1e-3, "symmetric: rounding only");
  }
}

// --- Edges -----------------------------------------------------------------------------------------------------------

// A container on its long edge, the edge along the world's y: across the lower one, crossing the long edges of that.
Pose on_edge(double slope, const Vector3d& p_W) {
  Pose X_WB = Pose::Identity();
  X_WB.linear() = (Eigen::AngleAxisd(slope, Vector3d::UnitX()) * Eigen::AngleAxisd(kPi / 2, Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(kPi / 4, Vector3d::UnitX())).toRotationMatrix();
  X_WB.translation() = p_W;
  return X_WB;
}

// The edge of the upper box turns from a slope of −0.1 to 0.1: it crosses one edge of the lower box, lies down on its
// face, and crosses the other edge, 5 mm deep at the deepest. Under the potential law the force points up all the way,
// and its change from one pose to the next shrinks with the distance of the poses: no jump. (A jump would give the
// same change at any distance: a ratio of 1; a kink 0.1.)
void edge_on_edge(const HardCaseSettings& settings, Findings& findings) {
  constexpr double kDepth = 5e-3, kSteepest = 0.1;
  const auto contact = elastic(default_contact(settings));
  const auto module = contact_nn::make_contact_module(contact);
  const Vector3d half = 0.5 * kContainerSize;
  const double edge_radius = half.tail<2>().norm() * std::cos(kPi / 4 - std::atan2(half.y(), half.z()));
  double least_upward = 1, largest_change[2];
  for (const int fine : {0, 1}) {
    const int steps = fine ? 20000 : 2000;
    double change = 0, largest = 0;
    Vector3d before = Vector3d::Zero();
    for (int i = 0; i <= steps; ++i) {
      const double slope = kSteepest * (2.0 * i / steps - 1);
      const double middle = std::abs(std::tan(slope)) * half.y() - kDepth;  // height of the edge over the middle
      const Pose X_WB = on_edge(slope, {0, 0, 0});
      // The edge passes through the box's frame at −edge_radius along the direction that `on_edge` turns down.
      const Vector3d down_W = Eigen::AngleAxisd(slope, Vector3d::UnitX()) * Vector3d(0, 0, -1);
      Pose X_AB = X_WB;
      X_AB.translation() = Vector3d(0, 0, half.z() + middle) - edge_radius * down_W;
      contact_nn::ContactCounters counters;
      const Vector3d force = module->force({half}, {half}, X_AB, {}, counters).f_A;
      least_upward = std::min(least_upward, force.z() / force.norm());
      if (i > 0) change = std::max(change, (force - before).norm());
      largest = std::max(largest, force.norm());
      before = force;
    }
    largest_change[fine] = change / largest;
  }
  findings.at_most("force off the vertical at worst, 1 − cos", "1", 1 - least_upward, 0.01,
                   "the common normal of the edges is off by the slope, 0.1 rad: 1 − cos 0.1 = 0.005");
  findings.at_most("largest change between poses 1e-5 rad apart over that at 1e-4 rad", "1",
                   largest_change[1] / largest_change[0], 0.5, "1: a jump; 0.1: none");

  // Falling onto it and turning over the face from the one edge to the other, without losses.
  crane_models::Scene scene = scene_of({fixed_container()}, false);
  crane_models::Body upper = container("box", on_edge(-0.01, {0, 0, edge_radius + 0.02}));
  upper.v_WB = {0, 0.3, -0.5};
  upper.w_WB = {0.3, 0, 0};
  add_body(scene, upper);
  Simulation simulation(scene, contact, kDefaultTolerance);
  const double before = simulation.engine().energy().kinetic;
  simulation.run_to(0.6, 0.001);
  findings.near("kinetic energy after an elastic blow over before", "1", simulation.engine().energy().kinetic / before, 1, 4e-4,
                "nothing takes energy; at most 100 steps of 1e-6 m/s, of 0.58 m/s, and twice that of the energy");
  const auto left = events_of(simulation, EventKind::contact_broken);
  findings.near("blows", "1", static_cast<double>(left.size()), 1, 0, "it comes down once");
}

// Faces almost parallel. For depths δ + θ x over a face of length L the potential ½ K (I/A)^(2/p) is ½ K δ² [1 + (p − 1)
// θ² L²/(12 δ²)], so the centre of pressure is (p − 1) θ L²/(12 δ) off the centre, in proportion to the tilt down to
// rounding, and the force is that of parallel faces. The strip as wide as the depth along the border, 1 mm of 2.4 m
// here, changes both by parts in 1e3.
//
// In a flat blow the same stiffness, (p − 1) K L²/12 against tilting, turns the box: ω_θ² = (p − 1) K L²/(12 I_y), so
// after the half oscillation π √(m/K) the tilt θ₀ has become a spin θ₀ ω_θ |sin(ω_θ π √(m/K))|.
void near_parallel_faces(const HardCaseSettings& settings, Findings& findings) {
  constexpr double kDepth = 1e-3;
  const auto contact = elastic(default_contact(settings));
  const auto module = contact_nn::make_contact_module(contact);
  const Vector3d half = 0.5 * kContainerSize;
  const double length = kContainerSize.x(), p = contact_nn::kNorm;
  const auto force_at = [&](double tilt) {
    Pose X_AB = turned(Vector3d::UnitY(), tilt, {0, 0, 2 * half.z() - kDepth});
    contact_nn::ContactCounters counters;
    return module->force({half}, {half}, X_AB, {}, counters);
  };
  const double parallel = force_at(0).normal_force;
  double force_error = 0, shift_error = 0;
  for (const double tilt : {1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6}) {
    const ContactForce force = force_at(tilt);
    force_error = std::max(force_error, std::abs(force.normal_force / parallel - 1));
    // Of the force as a whole: its torque about A's centre; friction is none.
    const double shift = -force.t_A.y() / force.f_A.z();
    shift_error = std::max(shift_error, std::abs(shift / ((p - 1) * tilt * length * length / (12 * kDepth)) - 1));
  }
  findings.at_most("change of the force up to a tilt of 1e-6 rad", "1", force_error, 1e-3,
                   "(p − 1)(θ L/δ)²/12 of it at most: 9e-5 at 1e-6 rad");
  findings.at_most("centre of pressure over (p − 1) θ L²/(12 δ), less 1, from 1e-12 to 1e-6 rad", "1", shift_error, 1e-2,
                   "the strip along the border: parts in 1e3");

  for (const double tilt : {1e-9, 1e-6}) {
    crane_models::Scene scene = scene_of({ground(), container("box", turned(Vector3d::UnitY(), tilt, Vector3d::Zero()))}, false);
    scene.bodies[1].X_WB.translation().z() = -lowest(kContainerSize, scene.bodies[1].X_WB.linear());
    scene.bodies[1].v_WB.z() = -0.5;
    Simulation simulation(scene, contact, 1e-12);
    simulation.run_to(0.1, 0.01);
    const double inertia = box_inertia(kContainerMass, kContainerSize)(1, 1);
    const double stiffness = flat_stiffness(contact, kContainerSize.x() * kContainerSize.y());
    const double omega = std::sqrt((p - 1) * stiffness * length * length / (12 * inertia));
    const double spin = tilt * omega * std::abs(std::sin(omega * kPi * std::sqrt(kContainerMass / stiffness)));
    findings.near("spin of a flat blow tilted by " + std::string(tilt < 1e-7 ? "1e-9" : "1e-6") + " rad over the linear theory's", "1",
                  simulation.vector("box.angular_velocity").norm() / spin, 1, 2e-2,
                  "3.6 mm deep, the border strip changes (p − 1) K by 1 %, and the phase at the end 1.85 rad ± 0.5 %");
  }
}

// --- Grazing ---------------------------------------------------------------------------------------------------------

// (a) A box thrown up against a beam so that it reaches it with 20 µm to spare (nothing may happen), would pass it by 20 µm
// (it must touch), or by 1 mm: then it comes with v = √(2 g 1 mm), is pushed back and pulled by gravity alike, for T =
// (2/ω) atan(v ω/g), and the impulse is m (2 v − g T).
// (b) A box that comes down with 1 mm/s while it slides at 3 m/s: the normal impulse is (1 + e) m v with the
// restitution e at 1 mm/s, friction takes μ times that.
// (c) A box that flies past another, overlapping it by 0.1 mm: it is lifted over by contacts of that depth, which hold ½ K δ² = 3 J
// of its 137 kJ each. Caught, it would lose metres per second.
void grazing(const HardCaseSettings& settings, Findings& findings) {
  const auto contact = default_contact(settings);
  const double stiffness = flat_stiffness(contact, kContainerSize.x() * kContainerSize.y());
  for (const double reach : {-2e-5, 2e-5, 1e-3}) {
    crane_models::Body beam = fixed_container();
    beam.X_WB = at(0, 0, 0.5 * kContainerSize.z());
    crane_models::Scene scene = scene_of({beam, container("box", at(0, 0, -0.1 - 0.5 * kContainerSize.z()))});
    scene.bodies[1].v_WB.z() = std::sqrt(2 * kGravity * (0.1 + reach));
    Simulation simulation(scene, elastic(contact), kDefaultTolerance);
    simulation.run_to(0.3, 0.01);
    const auto left = events_of(simulation, EventKind::contact_broken);
    const double v = std::sqrt(2 * kGravity * std::max(0.0, reach));
    if (reach < 1e-4) {
      findings.near(reach < 0 ? "touches with 20 µm to spare" : "touches where it would pass by 20 µm", "1",
                    static_cast<double>(left.size()), reach < 0 ? 0 : 1, 0, "the height is right to some ten steps of 1e-6 m");
    } else {
      const double omega = std::sqrt(stiffness / kContainerMass);
      const double impulse = kContainerMass * (2 * v - kGravity * 2 / omega * std::atan(v * omega / kGravity));
      findings.near("impulse where it would pass by 1 mm over m (2 v − g T)", "1",
                    left.size() == 1 ? left[0].impulse / impulse : std::nan(""), 1, 1e-2,
                    "the height is right to some ten steps of 1e-6 m, 1 % of 1 mm, with which the impulse goes");
    }
  }
  {
    crane_models::Scene scene = scene_of({ground(), container("box", at(-3, 0, 0.5 * kContainerSize.z() + 1e-5))}, false);
    scene.bodies[1].v_WB = {3, 0, -1e-3};
    Simulation simulation(scene, contact, 1e-9);
    simulation.run_to(0.2, 0.01);
    const double c = contact_nn::damping_for(contact.restitution, contact.reference_speed);
    const double gained = (1 + contact_nn::restitution_of(c, 1e-3)) * 1e-3;
    findings.near("change of the normal speed over (1 + e) v at 1 mm/s", "1", (simulation.get("box.velocity.z") + 1e-3) / gained,
                  1, 1e-2, "friction turns the box by a thousandth of its depth over its length");
    findings.near("speed taken by friction over μ (1 + e) v", "1", (3 - simulation.get("box.velocity.x")) / (contact.friction * gained),
                  1, 1e-2, "as above; (v_t0/v)²/2 = 6e-8 for the regularisation");
  }
  {
    const double overlap = 1e-4;
    crane_models::Scene scene =
        scene_of({fixed_container(), container("box", at(-13, 0, 0.5 * kContainerSize.z() - overlap))}, false);
    scene.bodies[1].v_WB = {3, 0, 0};
    Simulation simulation(scene, elastic(contact), kDefaultTolerance);
    simulation.run_to(10, 0.01);
    findings.at_most("speed lost in flying past another box, 0.1 mm deep", "m/s", 3 - simulation.get("box.velocity.x"),
                     1e-3, "3 J of 137 kJ a contact is 3e-5 m/s, and it has a few of them");
    findings.at_most("energy missing", "J",
                     simulation.engine().energy().kinetic - 0.5 * kContainerMass * 9, kContainerMass * 3 * 1e-5,
                     "1e-5 m/s of 3 m/s");
    findings.near("boxes apart at the end", "1", simulation.get("contact.lower.box.force"), 0, 0, "10 s at 3 m/s over 12 m");
  }
}

// --- Overlap and speed -----------------------------------------------------------------------------------------------

struct Attitude {
  const char* name;
  Vector3d axis;
  double angle;
};
const Attitude kAttitudes[] = {{"flat", Vector3d::UnitX(), 0}, {"edge", Vector3d::UnitX(), 0.6}, {"corner", {1, 0.3, 0.2}, 0.6}};

// Starts 50 mm inside the ground, at rest, without gravity: what it leaves with is what was stored, elastic exactly and
// else less.
void initial_overlap(const HardCaseSettings& settings, Findings& findings) {
  for (const Attitude& attitude : kAttitudes) {
    for (const bool lossless : {true, false}) {
      crane_models::Body box = container("box", turned(attitude.axis, attitude.angle, Vector3d::Zero()));
      box.X_WB.translation().z() = -lowest(kContainerSize, box.X_WB.linear()) - 0.05;
      const auto contact = lossless ? elastic(default_contact(settings)) : default_contact(settings);
      Simulation simulation(scene_of({ground(), box}, false), contact, kDefaultTolerance);
      const double stored = simulation.engine().energy().potential;
      // Until it is off the ground for the first time; in the other attitudes an end may come down later.
      while (simulation.get("contact.ground.box.force") > 0 && simulation.time() < 1) simulation.run_to(simulation.time() + 0.001, 0.001);
      const double exit = simulation.engine().energy().kinetic / stored;
      if (lossless) {
        findings.near(std::string("exit over stored energy, elastic, ") + attitude.name, "1", exit, 1, 1e-4,
                      "at most 100 steps of 1e-6 m/s, of some 3 m/s, and twice that of the energy");
      } else {
        findings.at_most(std::string("exit over stored energy, restitution 0.3, ") + attitude.name, "1", exit, 1, "losses only");
      }
    }
  }
}

// 10 m/s: a full container stops within 71 mm flat, deeper on an edge or a corner, and must come back: flat with the
// restitution e of the law at that speed, which is the same for any spring; elastic in the other attitudes with its whole energy.
// A plate 0.1 m thick of 10 t would have to be stopped within half its thickness and cannot (v √(m/K) = 41 mm): then
// the run has to end with a complaint.
void fast_impact(const HardCaseSettings& settings, Findings& findings) {
  constexpr double kSpeed = 10;
  for (const Attitude& attitude : kAttitudes) {
    const bool flat = attitude.angle == 0;
    const auto contact = flat ? default_contact(settings) : elastic(default_contact(settings));
    crane_models::Body box = container("box", turned(attitude.axis, attitude.angle, Vector3d::Zero()));
    box.X_WB.translation().z() = -lowest(kContainerSize, box.X_WB.linear()) + 0.1;
    box.v_WB.z() = -kSpeed;
    Simulation simulation(scene_of({ground(), box}, false), contact, kDefaultTolerance);
    double deepest = 0;
    simulation.run_to(0.012, 0.001);
    while (simulation.get("contact.ground.box.force") > 0 && simulation.time() < 1) {
      deepest = std::max(deepest, -simulation.get("box.position.z") - lowest(kContainerSize, pose(simulation, "box").linear()));
      simulation.run_to(simulation.time() + 0.0005, 0.0005);
    }
    const std::string how = std::string(", ") + attitude.name;
    if (flat) {
      const double c = contact_nn::damping_for(contact.restitution, contact.reference_speed);
      findings.near("rebound over approach" + how, "1", simulation.get("box.velocity.z") / kSpeed,
                    contact_nn::restitution_of(c, kSpeed), 1e-4, "the solver's 1e-6 m/s a step");
    } else {
      findings.near("kinetic energy after over before" + how, "1",
                    simulation.engine().energy().kinetic / (0.5 * kContainerMass * kSpeed * kSpeed), 1, 1e-5,
                    "1e-6 m/s of 10 m/s a step");
    }
    findings.at_most("deepest" + how, "m", deepest, 0.25 * kContainerSize.y(), "half way to the middle: where it would come out on the far side");
  }
  const Vector3d plate(12.192, 2.438, 0.1);
  crane_models::Body body = free_box("plate", 10e3, plate, at(0, 0, 0.15));
  body.v_WB.z() = -kSpeed;
  bool refused = false;
  try {
    Simulation simulation(scene_of({ground(), body}, false), elastic(default_contact(settings)), kDefaultTolerance);
    simulation.run_to(0.2, 0.01);
  } catch (const StepFailed& failure) {
    refused = std::string(failure.what()).find("passed through") != std::string::npos;
  }
  findings.near("a plate of 0.1 m that passes through is complained of", "1", refused, 1, 0, "rather than coming out below");
}

// --- Masses ----------------------------------------------------------------------------------------------------------

// Mass ratios up to 1e4. A heavy box strikes a light one at rest: m v of both stays, elastic, so the light one leaves
// with 2 M/(M + m) v and the heavy one keeps (M − m)/(M + m) v. And a heavy box stands on a light one: at rest, sunk in
// by the weight above each contact over its stiffness.
void mass_ratios(const HardCaseSettings& settings, Findings& findings) {
  const Vector3d cube(1, 1, 1);
  const auto contact = default_contact(settings);
  for (const double ratio : {1e2, 1e4}) {
    const double heavy = kContainerMass, light = heavy / ratio;
    const std::string label = ratio > 1e3 ? ", 10,000 : 1" : ", 100 : 1";
    {
      crane_models::Scene scene = scene_of({free_box("heavy", heavy, cube, at(-1.01, 0, 0)), free_box("light", light, cube, at(0, 0, 0))}, false);
      scene.bodies[0].v_WB.x() = 1;
      Simulation simulation(scene, elastic(contact), kDefaultTolerance);
      simulation.run_to(0.2, 0.01);
      findings.near("light box struck by a heavy one, speed over 2 M/(M + m) v" + label, "1",
                    simulation.get("light.velocity.x") / (2 * heavy / (heavy + light)), 1, 1e-4, "1e-6 m/s a step, some tens of steps");
      findings.near("momentum after over before" + label, "1",
                    simulation.get("heavy.velocity.x") + light / heavy * simulation.get("light.velocity.x"), 1, 1e-6,
                    "forces are opposite to the last bit; the solver's error in the heavy one");
    }
    {
      const double area = 1, k = flat_stiffness(contact, area);
      const double sink_light = (heavy + light) * kGravity / k, sink_heavy = heavy * kGravity / k;
      Simulation simulation(scene_of({ground(), free_box("light", light, cube, at(0, 0, 0.5 - sink_light)),
                                      free_box("heavy", heavy, cube, at(0, 0, 1.5 - sink_light - sink_heavy))}),
                            contact, kDefaultTolerance);
      simulation.run_to(10, 0.1);
      // The border strip, as wide as the depth δ, of a face of area A and girth G weakens the contact by (δ G/A)(8/9)/2/4·…,
      // so what is checked is where it rests, not to better than the strip: δ G/A/9 of δ.
      findings.near("height of a heavy box on a light one after 10 s" + label, "m", simulation.get("heavy.position.z"),
                    1.5 - sink_light - sink_heavy, 2e-5, "static depths of 1.2 mm; the strip along the border changes them by 0.3 %");
      findings.at_most("speed left after 10 s" + label, "m/s",
                       std::max(simulation.vector("heavy.velocity").norm(), simulation.vector("light.velocity").norm()), 1e-6,
                       "the solver's tolerance");
    }
  }
}

}  // namespace

std::vector<HardCase> contact_cases() {
  return {{"flat_landing", "a container lands flat at 0.5 m/s: all four corners at once", flat_landing},
          {"edge_on_edge", "an edge turns over another edge, a face and the next edge", edge_on_edge},
          {"near_parallel_faces", "faces tilted by 1e-12 to 1e-6 rad", near_parallel_faces},
          {"grazing", "contacts that nearly are none", grazing},
          {"overlap_50mm", "starts 50 mm inside the ground", initial_overlap},
          {"fast_impact", "10 m/s onto the ground", fast_impact},
          {"mass_ratios", "a heavy box and one 100 and 10,000 times lighter", mass_ratios}};
}

}  // namespace quayside::harness
