#include "crane_models/reduction.h"

#include <algorithm>
#include <cassert>
#include <functional>

#include <fmt/format.h>

#include "crane_models/load_bodies.h"

namespace quayside::crane_models {
namespace {

// Two bodies move as one at the start if their velocities at one point differ by no more [m/s, rad/s].
constexpr double kSameVelocity = 1e-12;

using Entries = std::vector<ReductionReport::Entry>;

// Drives that the script never moves hold still: their joints are fixed where they start, their ropes keep their
// length. The drives themselves stay listed, so that a script may still name them.
void freeze_unused_drives(const std::vector<bool>& used, Scene& scene, Entries& entries) {
  for (std::size_t i = 0; i < scene.drives.size(); ++i) {
    if (used[i]) continue;
    const Drive& drive = scene.drives[i];
    const int index = static_cast<int>(i);
    const std::string reason = fmt::format("the script never moves the drive '{}'", drive.name);
    for (Body& body : scene.bodies) {
      if (body.joint.drive != index) continue;
      Pose X_FM = Pose::Identity();
      if (body.joint.type == JointType::slider) X_FM.translation().x() = drive.start;
      if (body.joint.type == JointType::hinge) X_FM.rotate(Eigen::AngleAxisd(drive.start, Eigen::Vector3d::UnitZ()));
      Joint fixed;
      fixed.type = JointType::fixed;
      fixed.parent = body.joint.parent;
      fixed.X_PF = body.joint.X_PF * X_FM;
      fixed.X_BM = body.joint.X_BM;
      body.joint = fixed;
      entries.push_back({body.name + " fixed", reason});
    }
    if (scene.wind.drive == index) {
      scene.wind.drive = -1;
      entries.push_back({"wind left out", reason});
    }
    int ropes = 0;
    for (spreader::Rope& rope : scene.ropes) {
      const auto frozen = std::remove_if(rope.drives.begin(), rope.drives.end(), [&](const spreader::RopeDrive& part) {
        if (part.drive != index) return false;
        rope.rest_length += part.share * drive.start;
        return true;
      });
      if (frozen == rope.drives.end()) continue;
      rope.drives.erase(frozen, rope.drives.end());
      ropes += rope.drives.empty();
    }
    if (ropes > 0) entries.push_back({fmt::format("{} ropes of constant rest length", ropes), reason});
  }
}

bool moves_alike(const Body& a, const Body& b) {
  const Eigen::Vector3d v_WB_of_a = a.v_WB + a.w_WB.cross(b.X_WB.translation() - a.X_WB.translation());
  return (b.v_WB - v_WB_of_a).norm() <= kSameVelocity && (b.w_WB - a.w_WB).norm() <= kSameVelocity;
}

// Makes one body part of another, A, where it stands at the start.
void merge(int absorbed, int absorber, Scene& scene) {
  Body& a = scene.bodies[absorber];
  const Body b = scene.bodies[absorbed];
  const Pose X_AB = a.X_WB.inverse() * b.X_WB;
  const int first_box = static_cast<int>(a.boxes.size());
  if (!a.is_static()) {
    set_mass_properties(a, spreader::combined(mass_properties(a), spreader::moved(mass_properties(b), X_AB)));
  }
  for (CollisionBox box : b.boxes) {
    if (box.name.empty()) box.name = b.name;
    box.X_BG = X_AB * box.X_BG;
    a.boxes.push_back(std::move(box));
  }
  // Indices behind the absorbed body move up by one.
  const auto renamed = [&](int body) { return body == absorbed ? absorber : body; };
  const auto closed_up = [&](int body) { return body > absorbed ? body - 1 : body; };
  const auto body_index = [&](int& body) { body = closed_up(renamed(body)); };

  for (spreader::Rope& rope : scene.ropes) {
    for (spreader::Attachment* end : {&rope.upper, &rope.lower}) {
      if (end->body == absorbed) end->p_B = X_AB * end->p_B;
      body_index(end->body);
    }
  }
  for (spreader::Lock& lock : scene.locks) {
    for (spreader::Lock::Pin& pin : lock.pins) {
      if (lock.body_a == absorbed) pin.p_A = X_AB * pin.p_A;
      if (lock.body_b == absorbed) pin.p_B = X_AB * pin.p_B;
    }
    body_index(lock.body_a);
    body_index(lock.body_b);
  }
  for (ReportedFrame& frame : scene.frames) {
    if (frame.body == absorbed) frame.X_BR = X_AB * frame.X_BR;
    body_index(frame.body);
  }
  for (ContactPair& pair : scene.pairs) {
    if (pair.body_a == absorbed) pair.box_a += first_box;
    if (pair.body_b == absorbed) pair.box_b += first_box;
    body_index(pair.body_a);
    body_index(pair.body_b);
  }
  for (LandedSwitch& landed : scene.landed_switches) {
    for (int& body : landed.bodies) body_index(body);
    std::sort(landed.bodies.begin(), landed.bodies.end());
    landed.bodies.erase(std::unique(landed.bodies.begin(), landed.bodies.end()), landed.bodies.end());
  }
  for (Body& body : scene.bodies) {
    assert(body.joint.parent != absorbed);
    body.joint.parent = closed_up(body.joint.parent);
  }
  scene.bodies.erase(scene.bodies.begin() + absorbed);
}

bool drop_pairs(const std::function<bool(const ContactPair&)>& drop, Scene& scene, int& dropped) {
  const auto end = std::remove_if(scene.pairs.begin(), scene.pairs.end(), drop);
  dropped = static_cast<int>(scene.pairs.end() - end);
  scene.pairs.erase(end, scene.pairs.end());
  return dropped > 0;
}

std::string counted_pairs(int count) { return fmt::format("{} contact pair{} left out", count, count == 1 ? "" : "s"); }

// A free body that nothing else is jointed to can become part of another. Ropes between the two would then do nothing.
bool can_be_absorbed(int body, int other, const Scene& scene) {
  if (scene.bodies[body].joint.type != JointType::free) return false;
  for (const Body& child : scene.bodies) {
    if (child.joint.parent == body) return false;
  }
  for (const spreader::Rope& rope : scene.ropes) {
    if (std::minmax(rope.upper.body, rope.lower.body) == std::minmax(body, other)) return false;
  }
  return true;
}

// Whether a lock holds its bodies as if they were one: fewer than three pins leave a turn free, and another lock between
// them may do something yet.
bool is_rigid(const spreader::Lock& lock, const Scene& scene) {
  constexpr std::size_t kRigidPins = 3;
  const auto bodies = std::minmax(lock.body_a, lock.body_b);
  const auto joins_them = [&](const spreader::Lock& other) { return std::minmax(other.body_a, other.body_b) == bodies; };
  return !lock.elastic && lock.pins.size() >= kRigidPins &&
         std::count_if(scene.locks.begin(), scene.locks.end(), joins_them) == 1;
}

// Locks that keep their state for the whole script: closed, they make one body of two; open, they do nothing.
void settle_constant_locks(const std::vector<bool>& commands_used, Scene& scene, Entries& entries) {
  for (std::size_t i = 0; i < scene.locks.size();) {
    const spreader::Lock lock = scene.locks[i];
    if (lock.command >= 0 && commands_used[lock.command]) {
      ++i;
      continue;
    }
    if (!lock.closed) {
      entries.push_back({lock.name + " left out", lock.name + " stay open for the whole script"});
      scene.locks.erase(scene.locks.begin() + i);
      continue;
    }
    if (!is_rigid(lock, scene)) {
      ++i;
      continue;
    }
    int absorber = lock.body_a, absorbed = lock.body_b;
    if (!can_be_absorbed(absorbed, absorber, scene)) std::swap(absorber, absorbed);
    if (absorber != absorbed && (!can_be_absorbed(absorbed, absorber, scene) ||
                                 !moves_alike(scene.bodies[absorber], scene.bodies[absorbed]))) {
      ++i;
      continue;
    }
    scene.locks.erase(scene.locks.begin() + i);
    if (absorber == absorbed) continue;  // merged by another lock already
    const std::string what =
        fmt::format("{} merged into {}", scene.bodies[absorbed].name, scene.bodies[absorber].name);
    entries.push_back({what, lock.name + " stay closed for the whole script"});
    merge(absorbed, absorber, scene);
    int dropped = 0;
    if (drop_pairs([](const ContactPair& pair) { return pair.body_a == pair.body_b; }, scene, dropped)) {
      entries.push_back({counted_pairs(dropped), what});
    }
  }
}

}  // namespace

// In this order: what a drive holds still may become static, what a lock joins to that as well, and pairs between
// static bodies then push nothing.
Scene reduce(const Scene& full, const ScriptUse& use, ReductionReport& report) {
  assert(use.drives_used.size() == full.drives.size() && use.commands_used.size() == full.commands.size());
  Scene scene = full;
  report = ReductionReport{};
  freeze_unused_drives(use.drives_used, scene, report.entries);
  settle_constant_locks(use.commands_used, scene, report.entries);
  int dropped = 0;
  const auto both_static = [&](const ContactPair& pair) {
    return scene.bodies[pair.body_a].is_static() && scene.bodies[pair.body_b].is_static();
  };
  if (drop_pairs(both_static, scene, dropped)) {
    report.entries.push_back({counted_pairs(dropped), "neither body can move"});
  }
  report.bodies_before = static_cast<int>(full.bodies.size());
  report.bodies_after = static_cast<int>(scene.bodies.size());
  report.degrees_of_freedom_before = degrees_of_freedom(full);
  report.degrees_of_freedom_after = degrees_of_freedom(scene);
  report.pairs_before = static_cast<int>(full.pairs.size());
  report.pairs_after = static_cast<int>(scene.pairs.size());
  return scene;
}

}  // namespace quayside::crane_models
