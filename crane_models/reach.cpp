#include "crane_models/reach.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace quayside::crane_models {
namespace {

using Eigen::Vector2d;

// Bounces, a turn of the load by some degrees, a lean of what is set down beside its place [m].
constexpr double kMargin = 1.0;
// A change of speed by a ramp has two corners, each of which swings the load by up to a/g. They may all add up, and
// shortening ropes and blows may make more of it: twice that.
constexpr double kSwayPerChange = 2 * 2.0;

GroundPlan widened(const GroundPlan& place, const Vector2d& by) { return {place.min() - by, place.max() + by}; }

std::optional<GroundPlan> place_of(const Body& body) {
  GroundPlan place;
  for (const CollisionBox& box : body.boxes) {
    const Pose X_WG = body.X_WB * box.X_BG;
    const Vector2d half = (X_WG.linear().cwiseAbs() * box.half).head<2>();
    const Vector2d centre = X_WG.translation().head<2>();
    place.extend(centre - half);
    place.extend(centre + half);
  }
  if (place.isEmpty()) return std::nullopt;
  return place;
}

// The body that a drive moves along a line; −1: none.
int slider_of(int drive, const Scene& scene) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Joint& joint = scene.bodies[i].joint;
    if (joint.drive == drive && joint.type == JointType::slider) return static_cast<int>(i);
  }
  return -1;
}

// A hinge, or ropes that get unequally long.
bool turns_something(int drive, const Scene& scene) {
  for (const Body& body : scene.bodies) {
    if (body.joint.drive == drive && body.joint.type == JointType::hinge) return true;
  }
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const spreader::Rope& rope : scene.ropes) {
    double share = 0;
    for (const spreader::RopeDrive& part : rope.drives) share += part.drive == drive ? part.share : 0;
    least = std::min(least, share);
    most = std::max(most, share);
  }
  return least < most;
}

}  // namespace

bool moves_sideways(const Scene& scene, const ScriptUse& use) {
  for (std::size_t i = 0; i < scene.drives.size(); ++i) {
    if (use.drives_used[i] && slider_of(static_cast<int>(i), scene) >= 0) return true;
  }
  return false;
}

std::optional<std::vector<GroundPlan>> reach(const Scene& scene, const ScriptUse& use) {
  assert(use.drive_travel.size() == scene.drives.size() && use.drive_changes.size() == scene.drives.size());
  double highest = 0;  // of the points from which loads hang above the ground [m]
  for (const auto& rope : scene.ropes) {
    const Pose X_WU = rope.upper.body == kWorld ? Pose::Identity() : scene.bodies[rope.upper.body].X_WB;
    highest = std::max(highest, (X_WU * rope.upper.p_B).z());
  }
  Vector2d wider = Vector2d::Constant(kMargin);
  for (std::size_t i = 0; i < scene.drives.size(); ++i) {
    if (!use.drives_used[i]) continue;
    const int drive = static_cast<int>(i);
    if (turns_something(drive, scene) || scene.wind.drive == drive) return std::nullopt;
    const int slider = slider_of(drive, scene);
    if (slider < 0) continue;  // a hoist moves nothing along the ground
    const Body& body = scene.bodies[slider];
    const Vector2d along = (body.X_WB.linear() * body.joint.X_BM.linear().col(0)).head<2>().cwiseAbs();
    const double sway = kSwayPerChange * use.drive_changes[i] * scene.drives[i].max_acceleration /
                        scene.gravity.norm() * highest;
    wider += (use.drive_travel[i] + sway) * along;
  }
  std::vector<GroundPlan> places;
  for (const Body& body : scene.bodies) {
    if (body.is_static()) continue;
    if (body.v_WB.norm() > 0 || body.w_WB.norm() > 0) return std::nullopt;
    if (const auto place = place_of(body)) places.push_back(widened(*place, wider));
  }
  return places;
}

// A stack that falls reaches as far as it is high, and a margin.
std::vector<bool> touched(const std::vector<GroundPlan>& stacks, double height, const std::vector<GroundPlan>& reach,
                          bool sideways) {
  std::vector<bool> result(stacks.size(), false);
  std::vector<GroundPlan> within = reach;
  for (std::size_t next = 0; next < within.size(); ++next) {
    const GroundPlan place = within[next];
    for (std::size_t i = 0; i < stacks.size(); ++i) {
      if (result[i] || !place.intersects(stacks[i])) continue;
      result[i] = true;
      if (sideways) within.push_back(widened(stacks[i], Vector2d::Constant(height + kMargin)));
    }
  }
  return result;
}

}  // namespace quayside::crane_models
