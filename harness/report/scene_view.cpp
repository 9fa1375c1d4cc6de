#include "harness/report/scene_view.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "harness/build_scene.h"
#include "harness/report/machine_view.h"

namespace quayside::harness::report {
namespace {

using crane_models::Body;
using crane_models::JointType;
using crane_models::Pose;
using crane_models::Scene;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

// Finer than a display shows (60 Hz), coarse enough to cost little beside the simulation [s].
constexpr double kContactInterval = 0.02;

// Within this distance two boxes may be the ones that carry a force that their law does not see [m]: MuJoCo's own contacts
// are made where its solver says.
constexpr double kNearby = 0.05;

// Rails are drawn this far beyond where a trolley goes, and the legs of a portal this far apart [m].
constexpr double kRailsBeyond = 8, kPortalWidth = 14;

// A joint this far off its parent's box is drawn with a strut between them [m].
constexpr double kOffTheBox = 0.5;

// Where a body is: with a reported frame, or at rest in the world.
struct Carrier {
  const crane_models::ReportedFrame* frame = nullptr;  // null: the world
  Pose X_CB = Pose::Identity();                        // the body in it
};

std::optional<Carrier> carrier(const Scene& scene, int body) {
  for (const auto& frame : scene.frames)
    if (frame.body == body) return Carrier{&frame, frame.X_BR.inverse()};
  if (scene.bodies[body].joint.type != JointType::fixed) return std::nullopt;
  const crane_models::Joint& joint = scene.bodies[body].joint;
  std::optional<Carrier> parent = Carrier{};
  if (joint.parent != crane_models::kWorld) parent = carrier(scene, joint.parent);
  if (parent) parent->X_CB = parent->X_CB * joint.X_PF * joint.X_BM.inverse();
  return parent;
}

Json vector_json(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json placed(const std::string& name, const Vector3d& half, const Pose& X, const std::string& kind) {
  const Eigen::Quaterniond q(X.linear());
  return {{"name", name}, {"half", vector_json(half)}, {"p", vector_json(X.translation())},
          {"q", {q.w(), q.x(), q.y(), q.z()}}, {"kind", kind}};
}

std::string kind_of(const cases::Case& description, const Body& body, const std::string& box_name) {
  if (body.is_static() && box_name == "ground") return "ground";
  for (const cases::ContainerSpec& container : description.containers)
    if (container.name == box_name) return "container";
  return "body";
}

// Half edges of the uniform box with the body's mass and inertia: I_xx = m (b² + c²) / 3 and so on for half edges a, b, c.
Vector3d half_of_inertia(const Body& body) {
  const Vector3d moments = body.I_BBcm_B.diagonal();
  Vector3d half;
  for (int i = 0; i < 3; ++i) half[i] = std::sqrt(std::max(0.0, 1.5 * (moments.sum() - 2 * moments[i]) / body.mass));
  return half;
}

Json frame_json(const std::optional<Carrier>& place) { return place->frame ? Json(place->frame->name) : Json(nullptr); }

Json body_json(const cases::Case& description, const Scene& scene, int index, bool left_out) {
  const Body& body = scene.bodies[index];
  const std::optional<Carrier> place = left_out ? Carrier{nullptr, body.X_WB} : carrier(scene, index);
  if (body.boxes.empty() || !place) return nullptr;
  Json boxes = Json::array();
  for (const auto& box : body.boxes) {
    const std::string& name = box.name.empty() ? body.name : box.name;
    boxes.push_back(placed(name, box.half, place->X_CB * box.X_BG, left_out ? "left_out" : kind_of(description, body, name)));
  }
  return {{"name", body.name}, {"frame", frame_json(place)}, {"boxes", boxes}};
}

// A body of the full scene without collision boxes: where it is reported, else as `machine_parts` finds it.
struct MachinePlace {
  Json frame;
  Pose X_CB = Pose::Identity();
};

MachinePlace machine_place(const Scene& full, int index) {
  if (index == crane_models::kWorld) return {nullptr};
  if (const std::optional<Carrier> place = carrier(full, index)) return {frame_json(place), place->X_CB};
  return {part_frame(full.bodies[index])};
}

// What the upper ends of ropes hang on.
bool is_trolley(const Scene& scene, int index) {
  const crane_models::Joint& joint = scene.bodies[index].joint;
  return joint.type == JointType::slider && joint.drive >= 0 &&
         std::any_of(scene.ropes.begin(), scene.ropes.end(), [&](const spreader::Rope& rope) { return rope.upper.body == index; });
}

// Parts of machines, but for what trolleys run on: that is drawn as rails.
void add_machine_bodies(const Scene& full, Json& bodies) {
  std::vector<int> drawn = machine_parts(full);
  for (int i = 0; i < static_cast<int>(full.bodies.size()); ++i) {
    const Body& body = full.bodies[i];
    if (body.boxes.empty() && body.mass > 0 && carrier(full, i)) drawn.push_back(i);
    if (is_trolley(full, i)) drawn.erase(std::remove(drawn.begin(), drawn.end(), body.joint.parent), drawn.end());
  }
  for (const int i : drawn) {
    const Body& body = full.bodies[i];
    const MachinePlace place = machine_place(full, i);
    const Vector3d half = half_of_inertia(body);
    Json struts = Json::array();  // to the joints of other parts that lie off the box
    for (const int k : drawn) {
      const crane_models::Joint& joint = full.bodies[k].joint;
      if (joint.parent != i) continue;
      const Vector3d end = joint.X_PF.translation(), begin = body.p_BBcm + (end - body.p_BBcm).cwiseMin(half).cwiseMax(-half);
      if ((end - begin).norm() > kOffTheBox) struts.push_back({{"from", vector_json(place.X_CB * begin)}, {"to", vector_json(place.X_CB * end)}});
    }
    bodies.push_back({{"name", body.name}, {"frame", place.frame}, {"struts", struts},
                      {"boxes", {placed(body.name, half, place.X_CB * Eigen::Translation3d(body.p_BBcm), "machine")}}});
  }
}

Json attachment_json(const Scene& scene, const spreader::Attachment& attachment) {
  if (attachment.body == crane_models::kWorld) return {{"frame", nullptr}, {"p", vector_json(attachment.p_B)}};
  const std::optional<Carrier> place = carrier(scene, attachment.body);
  if (!place) return nullptr;
  return {{"frame", place->frame ? Json(place->frame->name) : Json(nullptr)}, {"p", vector_json(place->X_CB * attachment.p_B)}};
}

// The line that a trolley runs along, as far as it went and a little beyond, and what carries it: a portal that a gantry
// crane straddles its rows with; legs behind and a boom for others.
Json rails_json(const RunResult& run, const Scene& full) {
  Json rails = Json::array();
  for (int i = 0; i < static_cast<int>(full.bodies.size()); ++i) {
    if (!is_trolley(full, i)) continue;
    const crane_models::Joint& joint = full.bodies[i].joint;
    const crane_models::Drive& drive = full.drives[joint.drive];
    double from = drive.start, to = drive.start;
    for (const EngineRun& engine : run.engines) {
      for (const double q : engine.trajectory.columns[engine.trajectory.index(drive.name + ".value")]) {
        from = std::min(from, q);
        to = std::max(to, q);
      }
    }
    from -= kRailsBeyond;
    to += kRailsBeyond;
    const bool straddles = run.description.crane.type == "rtg";
    const double behind = straddles ? to : from - kPortalWidth;
    const MachinePlace place = machine_place(full, joint.parent);
    const Pose X_CF = place.X_CB * joint.X_PF;
    rails.push_back({{"body", full.bodies[i].name}, {"frame", place.frame}, {"p", vector_json(X_CF.translation())},
                     {"axis", vector_json(X_CF.linear().col(0))}, {"from", std::min(from, behind)}, {"to", to},
                     {"legs", {from, behind}}, {"boom", !straddles}});
  }
  return rails;
}

// What the eye should follow: what hangs in the locks, else what hangs on ropes, else the first thing that moves.
std::string focus(const Scene& scene) {
  const auto last_frame = [&](int body) {
    std::string name;
    for (const auto& frame : scene.frames)
      if (frame.body == body) name = frame.name;
    return name;
  };
  if (!scene.locks.empty() && scene.locks.front().body_b >= 0) return last_frame(scene.locks.front().body_b);
  if (!scene.ropes.empty() && scene.ropes.front().lower.body >= 0) return last_frame(scene.ropes.front().lower.body);
  for (const auto& frame : scene.frames)
    if (frame.body >= 0 && !scene.bodies[frame.body].is_static()) return frame.name;
  return "";
}

// Motion of every body whose motion was recorded, row by row.
class RecordedMotion {
 public:
  RecordedMotion(const Scene& scene, const Recording& recording) : scene_(scene), recording_(recording) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      carriers_.push_back(carrier(scene, static_cast<int>(i)));
      const bool moves = carriers_.back() && carriers_.back()->frame;
      first_column_.push_back(moves ? recording.index(carriers_.back()->frame->name + ".position.x") : 0);
    }
  }

  bool known(int body) const { return carriers_[body].has_value(); }

  struct Motion {
    Pose X_WB;
    Vector3d v_WB, w_WB;
  };
  // Columns of a frame in the order of `engine_variables`: position, orientation, velocity, angular velocity.
  Motion at(int body, std::size_t row) const {
    const Carrier& place = *carriers_[body];
    if (!place.frame) return {place.X_CB, Vector3d::Zero(), Vector3d::Zero()};
    const auto value = [&](int k) { return recording_.columns[first_column_[body] + k][row]; };
    const Vector3d p_WR(value(0), value(1), value(2)), v_WR(value(7), value(8), value(9)), w(value(10), value(11), value(12));
    const Pose X_WR = Eigen::Translation3d(p_WR) * Eigen::Quaterniond(value(3), value(4), value(5), value(6)).normalized();
    const Pose X_WB = X_WR * place.X_CB;
    return {X_WB, v_WR + w.cross(X_WB.translation() - p_WR), w};
  }

 private:
  const Scene& scene_;
  const Recording& recording_;
  std::vector<std::optional<Carrier>> carriers_;
  std::vector<std::size_t> first_column_;
};

struct Push {
  Vector3d p_W = Vector3d::Zero();          // weighted by the force
  Vector3d direction_W = Vector3d::Zero();  // of the force on b
};

// Sum over the pairs of a group. Where the law sees no contact, the pair that is nearest tells point and normal.
std::optional<Push> push_of(const Scene& scene, const crane_models::ContactGroup& group, const RecordedMotion& motion,
                            std::size_t row, const contact_nn::ContactModule& contact) {
  contact_nn::ContactCounters counters;
  Vector3d sum_f = Vector3d::Zero(), sum_p = Vector3d::Zero();
  double sum_weight = 0, nearest = kNearby;
  std::optional<Push> guess;
  for (const int index : group.pairs) {
    const crane_models::ContactPair& pair = scene.pairs[index];
    if (!motion.known(pair.body_a) || !motion.known(pair.body_b)) return std::nullopt;
    const auto a = motion.at(pair.body_a, row), b = motion.at(pair.body_b, row);
    const auto& box_a = scene.bodies[pair.body_a].boxes[pair.box_a];
    const auto& box_b = scene.bodies[pair.body_b].boxes[pair.box_b];
    const Pose X_WA = a.X_WB * box_a.X_BG, X_WG = b.X_WB * box_b.X_BG, X_AB = X_WA.inverse() * X_WG;
    const Vector3d v_WG = b.v_WB + b.w_WB.cross(X_WG.translation() - b.X_WB.translation());
    const Vector3d v_of_A = a.v_WB + a.w_WB.cross(X_WG.translation() - a.X_WB.translation());
    const contact_nn::RelativeVelocity V_AB{X_WA.linear().transpose() * (b.w_WB - a.w_WB),
                                            X_WA.linear().transpose() * (v_WG - v_of_A)};
    const contact_nn::Box shape_a{box_a.half}, shape_b{box_b.half};
    const contact_nn::ContactForce force = contact.force(shape_a, shape_b, X_AB, V_AB, counters);
    if (const double weight = force.f_A.norm(); force.touching && weight > 0) {
      sum_f += X_WA.linear() * force.f_A;
      sum_p += weight * (X_WA * force.impact_point_A);
      sum_weight += weight;
    } else if (sum_weight == 0) {
      const contact_nn::Manifold manifold = contact.query(shape_a, shape_b, X_AB, counters, kNearby);
      if (manifold.count == 0 || manifold.gap >= nearest) continue;
      nearest = manifold.gap;
      Vector3d middle = Vector3d::Zero();
      for (int k = 0; k < manifold.count; ++k) middle += manifold.points[k].p_A / manifold.count;
      guess = Push{X_WA * middle, X_WA.linear() * manifold.n_A};
    }
  }
  if (sum_weight > 0 && sum_f.norm() > 0) return Push{sum_p / sum_weight, sum_f.normalized()};
  return guess;
}

}  // namespace

nlohmann::ordered_json scene_view(const RunResult& run, const Scene& full) {
  const Scene& scene = run.scene;
  Json bodies = Json::array();
  std::set<std::string> drawn;
  for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i) {
    const Json body = body_json(run.description, scene, i, false);
    if (body.is_null()) continue;
    for (const auto& box : body.at("boxes")) drawn.insert(box.at("name").get<std::string>());
    bodies.push_back(body);
  }
  for (int i = 0; i < static_cast<int>(full.bodies.size()); ++i) {
    const Body& body = full.bodies[i];
    const bool missing = !body.boxes.empty() && drawn.count(body.boxes.front().name.empty() ? body.name : body.boxes.front().name) == 0;
    if (missing) bodies.push_back(body_json(run.description, full, i, true));
  }
  add_machine_bodies(full, bodies);
  Json ropes = Json::array();
  for (const spreader::Rope& rope : scene.ropes) {
    const Json upper = attachment_json(scene, rope.upper), lower = attachment_json(scene, rope.lower);
    if (!upper.is_null() && !lower.is_null()) ropes.push_back({{"name", rope.name}, {"upper", upper}, {"lower", lower}});
  }
  return {{"bodies", bodies}, {"ropes", ropes}, {"rails", rails_json(run, full)}, {"focus", focus(scene)},
          {"gravity", vector_json(scene.gravity)}};
}

void add_contact_views(const RunResult& run, const EngineRun& engine, CurveTable& table) {
  const Recording& recording = engine.trajectory;
  const RecordedMotion motion(run.scene, recording);
  const auto contact = contact_nn::make_contact_module(contact_settings(run.description.contact));
  for (const auto& group : crane_models::contact_groups(run.scene)) {
    const std::string name = "contact." + group.a + "." + group.b;
    const std::vector<double>& force = recording.columns[recording.index(name + ".force")];
    std::vector<double> times;
    std::vector<std::vector<double>> values(6);
    for (std::size_t row = 0; row < force.size(); ++row) {
      if (!(force[row] > 0) || (!times.empty() && recording.times[row] < times.back() + kContactInterval)) continue;
      const std::optional<Push> push = push_of(run.scene, group, motion, row, *contact);
      if (!push) continue;
      times.push_back(recording.times[row]);
      for (int k = 0; k < 3; ++k) {
        values[k].push_back(push->p_W[k]);
        values[3 + k].push_back(push->direction_W[k]);
      }
    }
    if (times.empty()) continue;
    for (int k = 0; k < 6; ++k)
      table.curves.push_back({name + (k < 3 ? ".point." : ".direction.") + "xyz"[k % 3], k < 3 ? "m" : "1", times, values[k]});
  }
}

}  // namespace quayside::harness::report
