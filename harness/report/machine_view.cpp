#include "harness/report/machine_view.h"

#include <algorithm>

namespace quayside::harness::report {
namespace {

using crane_models::Body;
using crane_models::Joint;
using crane_models::JointType;
using crane_models::kWorld;
using crane_models::Pose;
using crane_models::Scene;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Axes of hinges within this sine of one another tell no turn about themselves.
constexpr double kParallel = 1e-6;

// X_PB over a joint whose coordinate is known.
std::optional<Pose> over_joint(const Joint& joint, const std::vector<double>& drive_values) {
  Pose X_FM = Pose::Identity();
  if (joint.type != JointType::fixed) {
    if (joint.drive < 0) return std::nullopt;
    const double q = drive_values[joint.drive];
    if (joint.type == JointType::slider) X_FM.translation().x() = q;
    if (joint.type == JointType::hinge) X_FM.rotate(Eigen::AngleAxisd(q, Vector3d::UnitZ()));
  }
  return joint.X_PF * X_FM * joint.X_BM.inverse();
}

bool is_passive_hinge(const Joint& joint) { return joint.type == JointType::hinge && joint.drive < 0; }

std::optional<Matrix3d> basis(const Vector3d& a, const Vector3d& b) {
  const Vector3d normal = a.cross(b);
  if (normal.norm() < kParallel) return std::nullopt;
  Matrix3d axes;
  axes << a, normal.normalized(), a.cross(normal.normalized());
  return axes;
}

Pose of_parent(const Joint& joint, const Poses& poses) { return joint.parent == kWorld ? Pose::Identity() : *poses[joint.parent]; }
bool parent_known(const Joint& joint, const Poses& poses) { return joint.parent == kWorld || poses[joint.parent]; }

// The body turns about an axis of its parent's, and `child` about one of the body's: the neighbours know both.
std::optional<Pose> between_hinges(const Body& body, const Body& child, const Pose& X_WC, const Poses& poses) {
  const Pose X_WF = of_parent(body.joint, poses) * body.joint.X_PF;
  const auto axes_B = basis(body.joint.X_BM.linear().col(2), child.joint.X_PF.linear().col(2));
  const auto axes_W = basis(X_WF.linear().col(2), (X_WC * child.joint.X_BM).linear().col(2));
  if (!axes_B || !axes_W) return std::nullopt;
  Pose X_WB = Pose::Identity();
  X_WB.linear() = *axes_W * axes_B->transpose();
  X_WB.translation() = X_WF.translation() - X_WB.linear() * body.joint.X_BM.translation();
  return X_WB;
}

void add_frames(const Scene& scene, const std::vector<Pose>& X_WR, Poses& poses) {
  for (std::size_t i = 0; i < scene.frames.size(); ++i)
    if (scene.frames[i].body != kWorld) poses[scene.frames[i].body] = X_WR[i] * scene.frames[i].X_BR.inverse();
}

}  // namespace

void complete(const Scene& scene, const std::vector<double>& drive_values, Poses& poses) {
  for (bool found = true; found;) {
    found = false;
    const auto learn = [&](int body, const std::optional<Pose>& X_WB) {
      if (!X_WB) return;
      poses[body] = X_WB;
      found = true;
    };
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      const int index = static_cast<int>(i);
      const Body& body = scene.bodies[i];
      const Joint& joint = body.joint;
      const bool above = parent_known(joint, poses), here = poses[i].has_value();
      if (joint.type == JointType::free || above == here) continue;
      if (const auto X_PB = over_joint(joint, drive_values)) {
        if (above) learn(index, of_parent(joint, poses) * *X_PB);
        else learn(joint.parent, *poses[i] * X_PB->inverse());
      } else if (here && is_passive_hinge(joint)) {
        const Body& cross = scene.bodies[joint.parent];
        if (is_passive_hinge(cross.joint) && parent_known(cross.joint, poses))
          learn(joint.parent, between_hinges(cross, body, *poses[i], poses));
      }
    }
  }
}

std::vector<int> machine_parts(const Scene& scene) {
  std::vector<Pose> X_WR;
  for (const auto& frame : scene.frames)
    X_WR.push_back((frame.body == kWorld ? Pose::Identity() : scene.bodies[frame.body].X_WB) * frame.X_BR);
  std::vector<double> drive_values;
  for (const auto& drive : scene.drives) drive_values.push_back(drive.start);
  Poses poses(scene.bodies.size());
  add_frames(scene, X_WR, poses);
  const Poses reported = poses;
  complete(scene, drive_values, poses);
  std::vector<int> parts;
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (poses[i] && !reported[i] && scene.bodies[i].boxes.empty() && !scene.bodies[i].is_static()) parts.push_back(static_cast<int>(i));
  return parts;
}

std::string part_frame(const Body& part) { return "machine." + part.name; }

void add_machine_views(const Scene& scene, const Recording& recording, CurveTable& table) {
  const std::vector<int> parts = machine_parts(scene);
  if (parts.empty()) return;
  std::vector<std::size_t> frame_columns, drive_columns;
  for (const auto& frame : scene.frames) frame_columns.push_back(recording.index(frame.name + ".position.x"));
  for (const auto& drive : scene.drives) drive_columns.push_back(recording.index(drive.name + ".value"));

  const std::size_t first = table.curves.size();
  for (const int part : parts)
    for (const char* coordinate : {"position.x", "position.y", "position.z", "orientation.w", "orientation.x", "orientation.y", "orientation.z"})
      table.curves.push_back({part_frame(scene.bodies[part]) + "." + coordinate, coordinate[0] == 'p' ? "m" : "1", recording.times, {}});

  std::vector<Pose> X_WR(scene.frames.size());
  std::vector<Eigen::Quaterniond> last(parts.size(), Eigen::Quaterniond::Identity());
  std::vector<double> drive_values(scene.drives.size());
  for (std::size_t row = 0; row < recording.times.size(); ++row) {
    for (std::size_t i = 0; i < X_WR.size(); ++i) {
      const auto value = [&](int k) { return recording.columns[frame_columns[i] + k][row]; };
      X_WR[i] = Eigen::Translation3d(value(0), value(1), value(2)) * Eigen::Quaterniond(value(3), value(4), value(5), value(6)).normalized();
    }
    for (std::size_t i = 0; i < drive_values.size(); ++i) drive_values[i] = recording.columns[drive_columns[i]][row];
    Poses poses(scene.bodies.size());
    add_frames(scene, X_WR, poses);
    complete(scene, drive_values, poses);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Pose& X_WB = *poses[parts[i]];
      Eigen::Quaterniond q(X_WB.linear());
      if (q.dot(last[i]) < 0) q.coeffs() *= -1;  // of the two that mean the same, the one that goes on from the last
      last[i] = q;
      const double values[] = {X_WB.translation().x(), X_WB.translation().y(), X_WB.translation().z(), q.w(), q.x(), q.y(), q.z()};
      for (int k = 0; k < 7; ++k) table.curves[first + 7 * i + k].values.push_back(values[k]);
    }
  }
}

}  // namespace quayside::harness::report
