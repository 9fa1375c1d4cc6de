// From poses to what a network sees and says, and back.
//
// In: p_AB [m] and the Euler angles α, β, γ [rad], 6 numbers. Out: the spherical angles of the impact point, seen from
// A's centre, and of the force on B: azimuth in (−π, π] and elevation in [−π/2, π/2], 4 numbers. The distance of the
// impact point follows, since it lies on A's surface.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "contact_nn/paper/trihedra.h"
#include "contact_nn/training.h"

namespace quayside::contact_nn::paper {

// Whose impact point and force direction.
//   vertex    where the touching features meet, and the normal there: the paper's
//   pressure  the centre of pressure and the direction of the elastic force of the potential law (p = 8), for the same
//             pose with B pushed into A by `depth` along the normal at the vertex. Both are continuous in the pose
enum class Target { vertex, pressure };

// How points and directions are told.
//   angles   spherical about A's z axis, as in the paper: 4 numbers. The azimuth jumps at ±π and, worse, means nothing
//            on the axis, which goes through the middle of the face z = 1 and is its force direction
//   turned   spherical about (1, −1, 1), from (1, 2, 1): for the impact point both poles and the line of ±π are outside
//            A's trihedron or on its border; for the force direction, which reaches farther, there are no poles and a
//            jump only where it passes −y. So the same 4 numbers, nearly without these jumps
//   vectors  the point divided by the half edge, and the unit direction: 6 numbers without any jump
enum class Encoding { angles, turned, vectors };
int outputs_of(Encoding encoding);

struct Coding {
  Target target = Target::vertex;
  Encoding encoding = Encoding::angles;
  double depth = 0;  // how far B was pushed into A along the normal before the network sees the pose [m]; at most 0.5
};

Samples patterns(const std::vector<TouchingPose>& poses, const Coding& coding);

// Azimuth and elevation of a vector that is not zero, about the z axis [rad]; the inverse.
Eigen::Vector2d spherical(const Eigen::Vector3d& v);
Eigen::Vector3d direction(double azimuth, double elevation);

// What outputs mean: the impact point, on A's surface [m], and the direction of the force on B, a unit vector.
struct Impact {
  Eigen::Vector3d point, direction;
};
Impact impact_of(const Eigen::Ref<const Eigen::VectorXd>& outputs, Encoding encoding);

// α, β, γ of R_z(γ) R_y(β) R_x(α), with β in [−π/2, π/2] [rad].
Eigen::Vector3d euler_angles(const Eigen::Matrix3d& R_AB);

// What is left on the output side: errors in the outputs' own units over all outputs and patterns …
struct OutputErrors {
  double mean = 0;      // ME, output − target
  double absolute = 0;  // MAE
  double square = 0;    // RMSE
};
OutputErrors output_errors(const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& targets);

// … and in space. The impact points of output and target are both put on A's surface along their directions.
struct Spread {
  double mean = 0, p95 = 0, p99 = 0;
};
struct PhysicalErrors {
  Spread point;  // distance of the impact points [edges]
  Spread force;  // angle between the force directions [degrees]
};
PhysicalErrors physical_errors(const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& targets, Encoding encoding);

// The best constant for the absolute error: every output's median over the targets.
Eigen::VectorXd best_constant(const Eigen::MatrixXf& targets);

}  // namespace quayside::contact_nn::paper
