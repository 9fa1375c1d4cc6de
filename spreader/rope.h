// A tension-only rope between two bodies, its rest length set by drives.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace quayside::spreader {

// A point fixed on a body: index of the body in the scene (−1: the world) and the point in the body's frame [m].
struct Attachment {
  int body = -1;
  Eigen::Vector3d p_B = Eigen::Vector3d::Zero();
};

// A drive's part in a rope's rest length: share × its value. Hoist, trim, list and skew of one crane share its ropes.
struct RopeDrive {
  int drive;
  double share = 1;
};

// One rope group: `falls` parallel parts lumped into one line. Its stiffness at rest length L0 is EA / L0, so it
// softens as it is paid out.
struct Rope {
  std::string name;
  Attachment upper, lower;
  double axial_stiffness = 0;  // EA of all falls together [N]
  double damping_time = 0;     // damping over stiffness, c = damping_time · EA / L0 [s]
  std::vector<RopeDrive> drives;  // their parts add up to the rest length
  double rest_length = 0;         // what of it no drive sets [m]
};

// Tension [N] and its energy balance for one rope: stretch x = l − L0 and rates.
//   T = max(0, k x + c s(x) (l̇ − L̇0)) for x > 0, else 0, with k = EA/L0, c = damping_time · k and s a ramp from
//   0 to 1 over the first `kDampingRamp` of stretch, so that the tension is continuous when a slack rope catches.
struct RopeTension {
  double tension = 0;           // [N]
  double stretch = 0;           // l − L0; negative when slack [m]
  double energy = 0;            // ½ k x² [J]
  double work_in = 0;           // power that the drive puts in, −(T + ½ EA x²/L0²) L̇0 [W]
  double dissipated_power = 0;  // (T − k x)(l̇ − L̇0), never negative [W]
};

// Stretch over which the damping of a rope that catches grows from nothing to its full value [m]: short against the
// stretch under a load (centimetres), long against what an integrator resolves.
inline constexpr double kDampingRamp = 2e-3;

// `length` not negative [m], rates in [m/s]. A rest length that is not positive gives NaN throughout: a drive has
// hoisted the rope away, and whoever integrates must notice.
RopeTension rope_tension(const Rope& rope, double length, double length_rate, double rest_length,
                         double rest_length_rate);

}  // namespace quayside::spreader
