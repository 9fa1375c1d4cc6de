// Friction at its limit. The law is regularised: at a sliding speed v it carries μ N v/√(v² + v_t0²), so a steady load of r < 1
// times the limit makes it creep at v_t0 r/√(1 − r²).
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "crane_models/drives.h"
#include "tests/stability/hard_case.h"

namespace quayside::harness {
namespace {

using crane_models::Pose;
using Eigen::Vector3d;

double creep(double transition_speed, double r) { return transition_speed * r / std::sqrt(1 - r * r); }

// A block that slides as one piece: v̇ = g (sin α − μ cos α v/√(v² + v_t0²)). Classical Runge-Kutta at 0.1 ms. Returns
// how far it came.
double slid(double slope, double friction, double transition_speed, double time) {
  constexpr double kStep = 1e-4;
  const auto acceleration = [&](double v) {
    return kGravity * (std::sin(slope) - friction * std::cos(slope) * v / std::hypot(v, transition_speed));
  };
  double x = 0, v = 0;
  for (long i = 0; (i + 0.5) * kStep < time; ++i) {
    const double a1 = acceleration(v), v2 = v + 0.5 * kStep * a1, a2 = acceleration(v2), v3 = v + 0.5 * kStep * a2,
                 a3 = acceleration(v3), v4 = v + kStep * a3, a4 = acceleration(v4);
    x += kStep / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += kStep / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return x;
}

// A container at its resting depth on a slope (tilted gravity).
crane_models::Scene on_slope(double alpha, const contact_nn::ContactSettings& contact) {
  const double stiffness = flat_stiffness(contact, kContainerSize.x() * kContainerSize.y());
  const double sink = kContainerMass * kGravity * std::cos(alpha) / stiffness;
  crane_models::Scene scene = scene_of({ground(), container("box", at(0, 0, kContainerSize.z() / 2 - sink))});
  scene.gravity = kGravity * Vector3d(std::sin(alpha), 0, -std::cos(alpha));
  return scene;
}

std::string at_angle(double r) {
  return r < 0.9 ? " at tan α = 0.5 μ" : r < 1 ? " at tan α = μ − 0.5 %" : " at tan α = μ + 0.5 %";
}

void not_across(Simulation& simulation, const std::string& how, Findings& findings) {
  findings.at_most("drift across the slope" + how, "m", simulation.get("box.position.y"), 1e-5,
                   "symmetric: some ten steps of 1e-6 m");
}

// A slope with tan α = r μ: at r = 1.005 the block slides away with g (sin α − μ cos α), 0.02 m/s², at r =
// 0.995 it creeps at ten times v_t0, at r = 0.5 at 0.58 of it. All of it is the law integrated in one dimension; 1 % of
// that is asked for.
void slope(const HardCaseSettings& settings, Findings& findings) {
  const auto contact = default_contact(settings);
  for (const double r : {0.5, 0.995, 1.005}) {
    const double alpha = std::atan(r * contact.friction);
    Simulation simulation(on_slope(alpha, contact), contact, kDefaultTolerance);
    simulation.run_to(10, 0.1);
    const std::string how = at_angle(r);
    const double expected = slid(alpha, contact.friction, contact.transition_speed, 10);
    findings.near("way in 10 s over the law's in one dimension" + how, "1", simulation.get("box.position.x") / expected, 1, 1e-2,
                  "1 % is asked for");
    if (r < 1) {
      findings.near("speed after 10 s over the creep v_t0 r/√(1 − r²)" + how, "1",
                    simulation.get("box.velocity.x") / creep(contact.transition_speed, r), 1, 1e-2, "1 % is asked for");
    }
    not_across(simulation, how, findings);
  }
}

contact_nn::ContactSettings sticking(contact_nn::ContactSettings contact) {
  contact.friction_law = contact_nn::Friction::bristle;
  return contact;
}

// The same under friction that sticks. It is let go with the bristle relaxed, swings into it, above 0.99 of the limit past
// it, and has settled after some τ; what is asked for are the five seconds after the first five: below the angle nothing,
// above it the acceleration g (sin α − μ cos α).
void slope_sticking(const HardCaseSettings& settings, Findings& findings) {
  const auto contact = sticking(default_contact(settings));
  for (const double r : {0.5, 0.995, 1.005}) {
    const double alpha = std::atan(r * contact.friction);
    Simulation simulation(on_slope(alpha, contact), contact, kDefaultTolerance);
    simulation.run_to(5, 0.1);
    const double x = simulation.get("box.position.x"), v = simulation.get("box.velocity.x");
    simulation.run_to(10, 0.1);
    const std::string how = at_angle(r);
    if (r < 1) {
      findings.at_most("way from 5 to 10 s" + how, "m", simulation.get("box.position.x") - x, 1e-6,
                       "no creep: the solver's tolerance");
      findings.at_most("speed after 10 s" + how, "m/s", simulation.get("box.velocity.x"), 1e-6, "the solver's tolerance");
    } else {
      const double expected = kGravity * (std::sin(alpha) - contact.friction * std::cos(alpha));
      findings.near("acceleration over g (sin α − μ cos α)" + how, "1",
                    (simulation.get("box.velocity.x") - v) / 5 / expected, 1, 1e-2, "1 % is asked for");
    }
    not_across(simulation, how, findings);
  }
}

// A container on a slope with tan α = μ/2 in gusts along it that add and take up to a quarter of the limit, so that the load on
// its friction is r = ½ ± ¼ u² of it, u from 0 to ±1 and back in ramps of a quarter of a second: slow against the container's
// 50 ms. Regularised friction creeps with v_t0 r/√(1 − r²) all the while; friction that sticks stays where it was.
void gusts(const HardCaseSettings& settings, contact_nn::Friction friction, Findings& findings) {
  constexpr double kRamp = 0.25, kGust = 20, kShare = 0.25;  // [s], [m/s], of μ N
  const int swings = settings.whole ? 100 : 10;
  auto contact = default_contact(settings);
  contact.friction_law = friction;
  const double alpha = std::atan(0.5 * contact.friction);
  crane_models::Scene scene = on_slope(alpha, contact);
  crane_models::add_drive(scene, "wind", "m", "way of the air", 0, 1, {2 * kGust, 1000, 0});
  const double largest = kShare * contact.friction * kContainerMass * kGravity * std::cos(alpha);
  scene.wind = {0, Vector3d::UnitX(), largest / (kGust * kGust * kContainerSize.y() * kContainerSize.z())};
  Simulation simulation(scene, contact, kDefaultTolerance);
  const auto swing = [&] {
    for (const double sign : {1, -1, -1, 1}) {
      simulation.set("wind.acceleration", sign * kGust / kRamp);
      simulation.run_to(simulation.time() + kRamp, kRamp);
    }
  };
  for (int i = 0; i < 2; ++i) swing();
  const double start = simulation.get("box.position.x");
  for (int i = 0; i < swings; ++i) swing();
  const double way = simulation.get("box.position.x") - start;
  if (friction == contact_nn::Friction::bristle) {
    findings.at_most(fmt::format("way in {} swings between 0.25 and 0.75 of the limit", swings), "m", way, 1e-6,
                     "no drift: the solver's tolerance");
    return;
  }
  constexpr int kParts = 1000;
  double mean = 0;
  for (int i = 0; i < kParts; ++i) {
    const double u = (i + 0.5) / kParts;
    for (const double side : {-1, 1}) mean += 0.5 / kParts * creep(contact.transition_speed, 0.5 + side * kShare * u * u);
  }
  findings.near("way in swings between 0.25 and 0.75 of the limit over the law's creep", "1",
                way / (mean * 4 * kRamp * swings), 1, 0.01, "quasi-static: the container follows in 1 ms");
}

// A container in a cell guide along its length, its centre of mass `kOffset` off the middle: it tilts by φ until its
// upper corner at one end and its lower corner at the other touch the guides, b apart in height. With the weight W and
// friction up on both sides: N b = W a and 2 f N = W for the friction used f = b/(2 a). So it jams when μ exceeds μ_c =
// b/(2a), whatever the weight, and falls when it does not, since 2 μ N then turns it less than N b turns it back: N
// dies out. Jammed, the law makes it creep down with v_t0 r/√(1 − r²), r = μ_c/μ.
//
// b = h cos φ − L sin φ between the corners; walls that go on for ever along themselves push straight, so the tilt of the ends does
// not matter. The pressure of a wedge of slope φ and depth δ has its centre δ/(9 φ) (p + 1 = 9) from the corner, 14 mm at
// the usual stiffness: half a percent of b at either end, and five of the creep. The contact is taken a hundred times as stiff
// here, which leaves 0.05 % of b, and 0.5 % of the creep, which goes as 1/(1 − r²).
// Friction that sticks holds it.
void jam_in_cell_guide(const HardCaseSettings& settings, contact_nn::Friction friction, Findings& findings) {
  constexpr double kGap = 0.01, kOffset = 3.2, kTime = 5;
  const double length = kContainerSize.x(), height = kContainerSize.z();
  double tilt = kGap / height;
  for (int i = 0; i < 20; ++i) tilt = std::asin((length + kGap - length * std::cos(tilt)) / height);
  const double arm = height * std::cos(tilt) - length * std::sin(tilt);
  const double critical = arm / (2 * kOffset * std::cos(tilt));
  for (const double excess : {0.05, -0.05}) {
    auto contact = default_contact(settings);
    contact.friction_law = friction;
    contact.stiffness *= 100;
    contact.friction = critical * (1 + excess);
    crane_models::Body left = ground(), right = ground();
    left.name = "left";
    right.name = "right";
    left.boxes[0].half = right.boxes[0].half = {0.5, 2, 20};
    left.X_WB = at(-0.5 * (length + kGap) - 0.5, 0, 0);
    right.X_WB = at(0.5 * (length + kGap) + 0.5, 0, 0);
    // Turned a little further than it touches, so that it begins with about the force that holds it.
    crane_models::Body box = container("box", turned(Vector3d::UnitY(), tilt + 4e-5, {0, 0, 0}));
    box.p_BBcm.x() = kOffset;
    Simulation simulation(scene_of({left, right, box}), contact, kDefaultTolerance);
    double before = 0;
    try {
      simulation.run_to(kTime - 1, 0.01);
      before = simulation.get("box.position.z");
      simulation.run_to(kTime, 0.01);
    } catch (const StepFailed&) {
    }
    const double speed = before - simulation.get("box.position.z");  // over one second
    if (excess > 0 && friction == contact_nn::Friction::bristle) {
      findings.at_most("way in a second of a container jammed at μ 5 % over the critical", "m", speed, 1e-6,
                       "no creep: the solver's tolerance");
    } else if (excess > 0) {
      findings.near("creep of a container jammed at μ 5 % over the critical, over the law's", "1",
                    speed / creep(contact.transition_speed, 1 / (1 + excess)), 1, 0.02,
                    "μ_c is known to 0.1 %, the creep goes with ten times that; and settling");
    } else {
      const double fall = -simulation.get("box.position.z") / (0.5 * kGravity * kTime * kTime);
      findings.near("way at μ 5 % under the critical over free fall", "1", fall, 1, 0.05, "N dies out within a tenth of a second, 2 % of the time");
    }
  }
}

}  // namespace

std::vector<HardCase> friction_cases() {
  return {{"slope", "a container on a slope at, just above and just below the friction angle", slope},
          {"slope_sticking", "the same under friction that sticks (`contact.friction.law: bristle`)", slope_sticking},
          {"gusts", "a container on a slope in gusts, together below the limit of friction",
           [](const auto& settings, auto& findings) { gusts(settings, contact_nn::Friction::regularised, findings); }},
          {"gusts_sticking", "the same under friction that sticks",
           [](const auto& settings, auto& findings) { gusts(settings, contact_nn::Friction::bristle, findings); }},
          {"cell_guide_jam", "a container off balance in a cell guide, friction 5 % over and under what jams it",
           [](const auto& settings, auto& findings) { jam_in_cell_guide(settings, contact_nn::Friction::regularised, findings); }},
          {"cell_guide_jam_sticking", "the same under friction that sticks",
           [](const auto& settings, auto& findings) { jam_in_cell_guide(settings, contact_nn::Friction::bristle, findings); }}};
}

}  // namespace quayside::harness
