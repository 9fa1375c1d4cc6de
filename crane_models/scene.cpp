#include "crane_models/scene.h"

#include <cmath>
#include <set>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

namespace quayside::crane_models {
namespace {

// How far rounding may take a rotation from orthonormal, and an inertia from symmetric or from the triangle inequality
// of its principal moments (relative).
constexpr double kRounding = 1e-9;

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
  throw std::invalid_argument(fmt::format("{}: {}", what, why));
}

void require(bool holds, const std::string& what, const char* why) {
  if (!holds) refuse(what, why);
}

bool is_positive(double x) { return std::isfinite(x) && x > 0; }
bool is_not_negative(double x) { return std::isfinite(x) && x >= 0; }

bool is_pose(const Pose& X) {
  const Eigen::Matrix3d R = X.linear();
  return X.matrix().allFinite() && (R * R.transpose()).isIdentity(kRounding) && R.determinant() > 0;
}

// Moments about the principal axes are sums of two of the three positive second moments of the mass distribution.
void check_inertia(const Eigen::Matrix3d& I, const std::string& what) {
  require(I.allFinite(), what, "the inertia is not finite");
  require((I - I.transpose()).norm() <= kRounding * I.norm(), what, "the inertia is not symmetric");
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(I, Eigen::EigenvaluesOnly);
  const Eigen::Vector3d moments = principal.eigenvalues();
  require(moments[0] > 0, what, "the principal moments of inertia must be positive");
  require(moments[2] <= (moments[0] + moments[1]) * (1 + kRounding), what,
          "no mass distribution has these moments of inertia: the largest exceeds the sum of the other two");
}

class Checker {
 public:
  explicit Checker(const Scene& scene) : scene_(scene) {}

  void all() const {
    require(scene_.gravity.allFinite(), "gravity", "is not finite");
    std::set<std::string> names;
    for (const Drive& drive : scene_.drives) check_drive(drive, names);
    for (const Command& command : scene_.commands) check_name(command.name, "command", names);
    names.clear();
    for (int i = 0; i < size(scene_.bodies); ++i) check_body(i, names);
    names.clear();
    for (const auto& rope : scene_.ropes) check_rope(rope, names);
    for (const auto& lock : scene_.locks) check_lock(lock, names);
    for (const ContactPair& pair : scene_.pairs) check_pair(pair);
    for (const LandedSwitch& landed : scene_.landed_switches) check_switch(landed, names);
    for (const LoadLimit& limit : scene_.load_limits) check_limit(limit, names);
    require(is_drive_or_none(scene_.wind.drive), "wind", "its drive is not in the scene");
    require(std::abs(scene_.wind.direction_W.norm() - 1) <= kRounding, "wind", "its direction is not a unit vector");
    require(is_not_negative(scene_.wind.pressure_factor), "wind", "its pressure factor must not be negative");
    names.clear();
    for (const ReportedFrame& frame : scene_.frames) {
      check_name(frame.name, "frame", names);
      require(is_body(frame.body), "frame " + frame.name, "its body is not in the scene");
      require(is_pose(frame.X_BR), "frame " + frame.name, "its pose is not a rotation and a position");
    }
  }

 private:
  template <typename T>
  static int size(const std::vector<T>& items) {
    return static_cast<int>(items.size());
  }
  bool is_body(int i) const { return i >= 0 && i < size(scene_.bodies); }
  bool is_body_or_world(int i) const { return i == kWorld || is_body(i); }
  bool is_drive(int i) const { return i >= 0 && i < size(scene_.drives); }
  bool is_drive_or_none(int i) const { return i == -1 || is_drive(i); }

  static void check_name(const std::string& name, const char* kind, std::set<std::string>& names) {
    if (name.empty()) refuse(kind, "has no name");
    if (!names.insert(name).second) refuse(fmt::format("{} {}", kind, name), "the name is used twice");
  }

  static void check_drive(const Drive& drive, std::set<std::string>& names) {
    check_name(drive.name, "drive", names);
    const std::string what = "drive " + drive.name;
    require(std::isfinite(drive.start), what, "its start is not finite");
    require(drive.lowest <= drive.start && drive.start <= drive.highest, what, "its start is beyond its limit switches");
    require(std::abs(drive.sign) == 1, what, "its sign must be 1 or -1");
    require(is_not_negative(drive.max_speed), what, "its largest speed must be finite and not negative");
    require(is_not_negative(drive.max_acceleration), what, "its largest acceleration must be finite and not negative");
    require(is_not_negative(drive.max_jerk), what, "its largest jerk must be finite and not negative");
    require(is_not_negative(drive.emergency_stop), what, "its emergency stop must be finite and not negative");
  }

  void check_body(int index, std::set<std::string>& names) const {
    const Body& body = scene_.bodies[index];
    check_name(body.name, "body", names);
    const std::string what = "body " + body.name;
    if (!body.is_static()) {
      require(is_positive(body.mass), what, "its mass must be positive");
      check_inertia(body.I_BBcm_B, what);
    }
    require(body.p_BBcm.allFinite(), what, "its centre of mass is not finite");
    for (const CollisionBox& box : body.boxes) {
      require(box.half.allFinite() && box.half.minCoeff() > 0, what, "the size of a box must be positive");
      require(is_pose(box.X_BG), what, "the pose of a box is not a rotation and a position");
    }
    require(is_pose(body.X_WB), what, "its start is not a rotation and a position");
    require(body.v_WB.allFinite() && body.w_WB.allFinite(), what, "its velocity at the start is not finite");

    const Joint& joint = body.joint;
    require(joint.parent >= kWorld && joint.parent < index, what, "the parent of its joint must stand before it");
    require(joint.type != JointType::free || joint.parent == kWorld, what, "a free joint has the world as its parent");
    require(is_pose(joint.X_PF) && is_pose(joint.X_BM), what, "a frame of its joint is not a rotation and a position");
    require(is_not_negative(joint.damping), what, "the damping of its joint must not be negative");
    require(is_drive_or_none(joint.drive), what, "the drive of its joint is not in the scene");
    require(joint.drive < 0 || joint.type == JointType::slider || joint.type == JointType::hinge, what,
            "only a slider or a hinge can be driven");
  }

  void check_rope(const spreader::Rope& rope, std::set<std::string>& names) const {
    check_name(rope.name, "rope", names);
    const std::string what = "rope " + rope.name;
    for (const spreader::Attachment& end : {rope.upper, rope.lower}) {
      require(is_body_or_world(end.body), what, "a body it is fixed to is not in the scene");
      require(end.p_B.allFinite(), what, "a point it is fixed to is not finite");
    }
    require(rope.upper.body != rope.lower.body, what, "both ends are on one body");
    require(is_positive(rope.axial_stiffness), what, "its stiffness EA must be positive");
    require(is_not_negative(rope.damping_time), what, "its damping time must not be negative");
    for (const spreader::RopeDrive& part : rope.drives) {
      require(is_drive(part.drive), what, "its drive is not in the scene");
      require(std::isfinite(part.share), what, "the share of a drive is not finite");
    }
    require(is_positive(rest_length_at_start(scene_, rope)), what, "its rest length at the start must be positive");
  }

  void check_lock(const spreader::Lock& lock, std::set<std::string>& names) const {
    check_name(lock.name, "lock", names);
    const std::string what = "lock " + lock.name;
    require(is_body(lock.body_a) && is_body(lock.body_b), what, "a body it holds is not in the scene");
    require(lock.body_a != lock.body_b, what, "it holds a body to itself");
    require(!lock.pins.empty(), what, "it has no pins");
    for (const auto& pin : lock.pins) require(pin.p_A.allFinite() && pin.p_B.allFinite(), what, "a pin is not finite");
    require(is_positive(lock.stiffness), what, "its stiffness must be positive");
    require(is_not_negative(lock.damping), what, "its damping must not be negative");
    require(is_not_negative(lock.reach), what, "its reach must not be negative");
    require(lock.command >= -1 && lock.command < size(scene_.commands), what, "its command is not in the scene");
    require(lock.command < 0 || scene_.commands[lock.command].start == lock.closed, what,
            "it must start as its command says");
  }

  void check_pair(const ContactPair& pair) const {
    const auto is_box = [&](int body, int box) {
      return is_body(body) && box >= 0 && box < size(scene_.bodies[body].boxes);
    };
    if (!is_box(pair.body_a, pair.box_a) || !is_box(pair.body_b, pair.box_b)) {
      refuse(fmt::format("contact pair of bodies {} and {}", pair.body_a, pair.body_b),
             "its boxes are not in the scene");
    }
    require(pair.body_a != pair.body_b, "contact pair of body " + scene_.bodies[pair.body_a].name, "it meets itself");
  }

  void check_switch(const LandedSwitch& landed, std::set<std::string>& names) const {
    check_name(landed.name, "switch", names);
    const std::string what = "switch " + landed.name;
    require(!landed.bodies.empty(), what, "it watches no body");
    for (int body : landed.bodies) require(is_body(body), what, "a body it watches is not in the scene");
    require(is_positive(landed.threshold), what, "its threshold must be positive");
  }

  void check_limit(const LoadLimit& limit, std::set<std::string>& names) const {
    check_name(limit.name, "load limit", names);
    const std::string what = "load limit " + limit.name;
    require(!limit.ropes.empty(), what, "it watches no rope");
    for (int rope : limit.ropes) {
      require(rope >= 0 && rope < size(scene_.ropes), what, "a rope it watches is not in the scene");
    }
    require(is_positive(limit.threshold), what, "its threshold must be positive");
    require(is_not_negative(limit.delay), what, "its delay must not be negative");
  }

  const Scene& scene_;
};

}  // namespace

const std::string& contact_name(const Scene& scene, int body, int box) {
  const std::string& name = scene.bodies[body].boxes[box].name;
  return name.empty() ? scene.bodies[body].name : name;
}

std::vector<ContactGroup> contact_groups(const Scene& scene) {
  std::vector<ContactGroup> groups;
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    const ContactPair& pair = scene.pairs[i];
    const std::string& a = contact_name(scene, pair.body_a, pair.box_a);
    const std::string& b = contact_name(scene, pair.body_b, pair.box_b);
    auto group = groups.begin();
    while (group != groups.end() && !(group->a == a && group->b == b)) ++group;
    if (group == groups.end()) group = groups.insert(group, ContactGroup{a, b, {}});
    group->pairs.push_back(static_cast<int>(i));
  }
  return groups;
}

double rest_length_at_start(const Scene& scene, const spreader::Rope& rope) {
  return rest_length(rope, [&](int drive) { return DriveMotion{scene.drives[drive].start}; }).value;
}

int degrees_of_freedom(const Scene& scene) {
  int count = 0;
  for (const Body& body : scene.bodies) {
    switch (body.joint.type) {
      case JointType::fixed: break;
      case JointType::slider:
      case JointType::hinge: count += body.joint.drive < 0 ? 1 : 0; break;
      case JointType::pivot: count += 3; break;
      case JointType::free: count += 6; break;
    }
  }
  return count;
}

void check(const Scene& scene) { Checker(scene).all(); }

}  // namespace quayside::crane_models
