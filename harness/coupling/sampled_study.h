// Contact forces that are evaluated at communication points only and held in between, against what held forces do by theory
// and against contact in the dynamics.
//
// On a flat contact of stiffness k a held force is the explicit step of an oscillator, x' = x + h v − ½ h² ω² x,
// v' = v − h ω² x with ω² = k/m: its amplitude grows by √(1 + ω²h²/2) a step, so a body leaves faster than it came, by
// about exp(π ω h / 4). Damping that grows with the load, k x (1 + c v), makes a body of static depth δ rest as long as
// h < 2 c δ, in heaving and in rocking; friction that grows to μ N over a speed v_s holds it as long as h < 2 v_s m'/(μ m g),
// where m' is the mass of the body as friction feels it at the contact, below the centre of mass.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/case.h"

namespace quayside::harness {

inline const std::vector<std::string> kSampledEngines{"simbody", "mujoco_same_law"};  // those that obey our laws

// A full 40 ft container meets the ground flat at 0.5 m/s, without gravity, damping and friction.
struct SampledBounce {
  std::string engine;
  double step = 0;         // communication step [s]
  double theory = 0;       // speed of leaving over speed of arrival
  double restitution = 0;  // as found
};
std::vector<SampledBounce> sampled_bounces(const std::vector<double>& steps);

// The container rests on the ground; the longest step with which it still does.
struct SampledRest {
  std::string engine, direction;  // "vertical", "rocking" (about the length), "sideways" (along the width)
  double theory = 0, found = 0;   // [s]
};
std::vector<SampledRest> sampled_rests();

// A case with sampled contact against the same case with contact in the dynamics, at the same communication step.
struct SampledRun {
  std::string engine;
  double step = 0;                      // communication step [s]
  double rms = 0, max = 0;              // of the positions of all frames the one farthest off [m]
  double residual = 0;                  // of the energy balance at the end [J]
  double wall_ratio = 0;                // to contact in the dynamics
  std::optional<std::string> failure;
};
std::vector<SampledRun> sampled_runs(const cases::Case& description, const std::vector<double>& steps);

}  // namespace quayside::harness
