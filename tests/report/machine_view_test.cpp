// Parts of machines that no frame is reported of: found again where forward kinematics put them.
#include <map>

#include <gtest/gtest.h>

#include "crane_models/reach_stacker.h"
#include "crane_models/rope_crane.h"
#include "harness/report/machine_view.h"

namespace quayside::harness::report {
namespace {

using crane_models::Body;
using crane_models::JointType;
using crane_models::Pose;
using crane_models::Scene;

// X_WB = X_WP · X_PF · joint(q) · X_BM⁻¹, parents first; a free body stays at its start.
std::vector<Pose> forward_kinematics(const Scene& scene, const std::vector<double>& drives, const std::map<std::string, double>& passive) {
  std::vector<Pose> X_WB;
  for (const Body& body : scene.bodies) {
    const auto& joint = body.joint;
    if (joint.type == JointType::free) {
      X_WB.push_back(body.X_WB);
      continue;
    }
    const double q = joint.drive >= 0 ? drives[joint.drive] : passive.at(body.name);
    Pose X_FM = Pose::Identity();
    if (joint.type == JointType::slider) X_FM.translation().x() = q;
    if (joint.type == JointType::hinge) X_FM.rotate(Eigen::AngleAxisd(q, Eigen::Vector3d::UnitZ()));
    const Pose X_WP = joint.parent == crane_models::kWorld ? Pose::Identity() : X_WB[joint.parent];
    X_WB.push_back(X_WP * joint.X_PF * X_FM * joint.X_BM.inverse());
  }
  return X_WB;
}

// One row: the poses of the reported frames, and the drives.
Recording recorded(const Scene& scene, const std::vector<Pose>& X_WB, const std::vector<double>& drives) {
  Recording recording;
  recording.times = {0};
  const auto add = [&](const std::string& name, double value) {
    recording.names.push_back(name);
    recording.units.push_back("1");
    recording.columns.push_back({value});
  };
  for (const auto& frame : scene.frames) {
    const Pose X_WR = X_WB[frame.body] * frame.X_BR;
    const Eigen::Quaterniond q(X_WR.linear());
    for (int k = 0; k < 3; ++k) add(frame.name + ".position." + "xyz"[k], X_WR.translation()[k]);
    add(frame.name + ".orientation.w", q.w());
    for (int k = 0; k < 3; ++k) add(frame.name + ".orientation." + "xyz"[k], q.vec()[k]);
  }
  for (std::size_t i = 0; i < drives.size(); ++i) add(scene.drives[i].name + ".value", drives[i]);
  return recording;
}

void expect_found(const Scene& scene, const std::vector<double>& drives, const std::map<std::string, double>& passive,
                  const std::vector<std::string>& names) {
  std::vector<std::string> parts;
  for (const int part : machine_parts(scene)) parts.push_back(scene.bodies[part].name);
  EXPECT_EQ(parts, names);

  const std::vector<Pose> X_WB = forward_kinematics(scene, drives, passive);
  CurveTable table;
  add_machine_views(scene, recorded(scene, X_WB, drives), table);
  ASSERT_EQ(table.curves.size(), 7 * names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto value = [&](int k) { return table.curves[7 * i + k].values.at(0); };
    const Pose found = Eigen::Translation3d(value(0), value(1), value(2)) * Eigen::Quaterniond(value(3), value(4), value(5), value(6));
    const Pose& truth = X_WB[machine_parts(scene)[i]];
    EXPECT_EQ(table.curves[7 * i].name, "machine." + names[i] + ".position.x");
    EXPECT_TRUE(found.isApprox(truth, 1e-12)) << names[i] << "\n" << found.matrix() << "\n" << truth.matrix();  // rounding
  }
}

TEST(MachineView, FindsTheReachStackerFromBoomTipAndSpreader) {
  crane_models::ReachStacker machine;
  machine.load_side.loads = {{"load", 20000}};
  Scene scene;
  crane_models::add_reach_stacker(machine, scene);
  // travel, boom, telescope, rotation, side shift; the pivots swing, so that the link between them stands askew.
  expect_found(scene, {1.5, 0.4, 2.1, 0.7, -0.3}, {{"link", 0.12}, {"head", -0.2}}, {"truck", "boom", "link", "head", "rotator"});
}

TEST(MachineView, FindsTheGantryFromItsDrive) {
  crane_models::RopeCrane crane = crane_models::rubber_tyred_gantry();
  crane.gantry_position = 3;
  crane.trolley_position = 8;
  crane.trolley_height = 21;
  crane.rope_length = 12;
  Scene scene;
  crane_models::add_rope_crane(crane, scene);
  expect_found(scene, {-4, 11, 12}, {}, {"gantry"});
}

}  // namespace
}  // namespace quayside::harness::report
