#include "contact_nn/paper/patterns.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "contact_nn/law_parameters.h"
#include "contact_nn/potential_law.h"

namespace quayside::contact_nn::paper {

namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

Impact answer(const TouchingPose& pose, const Pose& X_AB, Target target) {
  if (target == Target::vertex) return {pose.impact_A, pose.n_A};
  LawParameters law{};  // no damping, no friction: what is left is the gradient of the potential
  law.stiffness = 1;    // scales the force, not its direction
  const ContactForce force = potential_force(cube(), cube(), X_AB, RelativeVelocity{}, law);
  assert(force.touching);
  return {force.impact_point_A, force.f_A};
}

// Rows are the axes of the turned spherical coordinates: azimuth from the first, elevation towards the third.
Eigen::Matrix3d turned_axes() {
  Eigen::Matrix3d axes;
  axes.row(0) = Vector3d(1, 2, 1).normalized();
  axes.row(2) = Vector3d(1, -1, 1).normalized();
  axes.row(1) = axes.row(2).cross(axes.row(0));
  return axes;
}

Vector3d on_surface(const Vector3d& v) { return v * (kEdge / 2 / v.cwiseAbs().maxCoeff()); }

Spread spread(std::vector<double>& values) {
  Spread s;
  if (values.empty()) return s;
  for (double v : values) s.mean += v;
  s.mean /= static_cast<double>(values.size());
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double q) {
    return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
  };
  s.p95 = quantile(0.95);
  s.p99 = quantile(0.99);
  return s;
}

}  // namespace

Impact impact_of(const Eigen::Ref<const Eigen::VectorXd>& y, Encoding encoding) {
  constexpr double tiny = 1e-12;  // an output of no direction at all
  const auto unit = [&](const Vector3d& v) { return v.norm() > tiny ? v.normalized() : Vector3d(Vector3d::UnitX()); };
  if (encoding == Encoding::vectors) return {on_surface(unit(y.head<3>())), unit(y.tail<3>())};
  const Vector3d point = direction(y[0], y[1]), force = direction(y[2], y[3]);
  if (encoding == Encoding::angles) return {on_surface(point), force};
  const Eigen::Matrix3d back = turned_axes().transpose();
  return {on_surface(back * point), back * force};
}

Vector3d euler_angles(const Eigen::Matrix3d& R) {
  return {std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)), std::atan2(R(1, 0), R(0, 0))};
}

int outputs_of(Encoding encoding) { return encoding == Encoding::vectors ? 6 : 4; }

// atan2 takes −0 for a reason of its own: −0 as y would make the azimuth −π instead of π, at random.
Eigen::Vector2d spherical(const Vector3d& v) {
  return {std::atan2(v[1] + 0.0, v[0] + 0.0), std::atan2(v[2], std::hypot(v[0], v[1]))};
}

Vector3d direction(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

Samples patterns(const std::vector<TouchingPose>& poses, const Coding& coding) {
  const auto count = static_cast<Eigen::Index>(poses.size());
  Samples samples;
  samples.inputs.resize(6, count);
  samples.targets.resize(outputs_of(coding.encoding), count);
  const Eigen::Matrix3d axes = coding.encoding == Encoding::turned ? turned_axes() : Eigen::Matrix3d::Identity();
  for (Eigen::Index i = 0; i < count; ++i) {
    const TouchingPose& pose = poses[static_cast<std::size_t>(i)];
    Pose X_AB = pose.X_AB;
    X_AB.translation() -= coding.depth * pose.n_A;
    samples.inputs.col(i) << X_AB.translation().cast<float>(), pose.euler.cast<float>();
    const Impact y = answer(pose, X_AB, coding.target);
    if (coding.encoding == Encoding::vectors) {
      samples.targets.col(i) << (on_surface(y.point) * (2 / kEdge)).cast<float>(),
          y.direction.normalized().cast<float>();
    } else {
      samples.targets.col(i) << spherical(axes * y.point).cast<float>(), spherical(axes * y.direction).cast<float>();
    }
  }
  return samples;
}

OutputErrors output_errors(const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& targets) {
  const Eigen::ArrayXXd e = outputs - targets;
  return {e.mean(), e.abs().mean(), std::sqrt(e.square().mean())};
}

PhysicalErrors physical_errors(const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& targets, Encoding encoding) {
  std::vector<double> points, forces;
  for (Eigen::Index i = 0; i < outputs.cols(); ++i) {
    const Impact said = impact_of(outputs.col(i), encoding), meant = impact_of(targets.col(i), encoding);
    points.push_back((said.point - meant.point).norm() / kEdge);
    const double angle = std::atan2(said.direction.cross(meant.direction).norm(), said.direction.dot(meant.direction));
    forces.push_back(angle * 180 / M_PI);
  }
  return {spread(points), spread(forces)};
}

Eigen::VectorXd best_constant(const Eigen::MatrixXf& targets) {
  Eigen::VectorXd constant(targets.rows());
  for (Eigen::Index k = 0; k < targets.rows(); ++k) {
    std::vector<float> values(static_cast<std::size_t>(targets.cols()));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = targets(k, static_cast<Eigen::Index>(i));
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    constant[k] = static_cast<double>(*middle);
  }
  return constant;
}

}  // namespace quayside::contact_nn::paper
