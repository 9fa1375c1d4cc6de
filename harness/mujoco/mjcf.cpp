#include "harness/mujoco/mjcf.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

namespace quayside::harness::mujoco {
namespace {

using crane_models::Body;
using crane_models::CollisionBox;
using crane_models::Joint;
using crane_models::JointType;
using crane_models::kWorld;
using crane_models::Pose;
using crane_models::Scene;
using tinyxml2::XMLElement;

// The armature of a driven joint over the inertia of everything that moves. Larger follows the drive closer; smaller
// keeps more digits of the force: 1e-7 and 1e-9 at this value.
constexpr double kDriveInertiaRatio = 1e7;

// A level static box counts as a plane for boxes whose diagonal goes this often into its length and width, and that
// start at least their diagonal from its rim: beyond the rim a plane would go on.
constexpr double kPlaneRatio = 1.5;
constexpr double kLevel = 1e-9;  // largest tilt of such a box [rad]

// Most points that MuJoCo's colliders give for one pair.
constexpr int kMostBoxPoints = 16, kMostPlanePoints = 4;
constexpr int kPointRows = 3;  // normal and two friction directions
constexpr int kSpareRows = 16;

// See contact_half.
constexpr double kSameSize = 1e-3;    // [m]
constexpr double kShrink = 1e-4;      // of half length and half width per earlier box [m]
constexpr double kMostShrink = 0.01;  // of either

constexpr double kRopeWidth = 0.02;  // drawn radius [m]
constexpr double kSiteSize = 0.05;   // drawn radius [m]

template <typename Derived>
std::string text(const Eigen::MatrixBase<Derived>& v) {
  const auto& x = v.eval();
  return fmt::format("{}", fmt::join(x.data(), x.data() + x.size(), " "));
}
std::string text(const std::vector<double>& v) { return fmt::format("{}", fmt::join(v, " ")); }
std::string text(double x) { return fmt::format("{}", x); }
std::string quaternion_text(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return fmt::format("{} {} {} {}", q.w(), q.x(), q.y(), q.z());
}

void set(XMLElement* element, const char* name, const std::string& value) {
  element->SetAttribute(name, value.c_str());
}

void set_reference(XMLElement* element, const char* solref, const char* solimp, const std::vector<SolverReference>& all,
                   std::size_t index) {
  if (all.empty()) return;
  set(element, solref, fmt::format("{} {}", -all[index].stiffness, -all[index].damping));
  set(element, solimp, fmt::format("{0} {0} 0.001 0.5 2", kImpedance));
}

// Pose of a body in its parent at coordinate zero.
Pose X_PB_at_zero(const Joint& joint) { return joint.X_PF * joint.X_BM.inverse(); }

// Depth first, as MuJoCo numbers bodies and coordinates.
void for_each_child(const Scene& scene, int parent, const std::function<void(int)>& visit) {
  for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i) {
    if (scene.bodies[i].joint.parent == parent) visit(i);
  }
}

double moving_mass(const Scene& scene) {
  double mass = 0;
  for (const Body& body : scene.bodies) mass += body.is_static() ? 0 : body.mass;
  return mass;
}

class Writer {
 public:
  Writer(const Scene& scene, const MjcfOptions& options)
      : scene_(scene), options_(options), start_(start_coordinates(scene)) {}

  std::string write() {
    XMLElement* root = document_.NewElement("mujoco");
    document_.InsertEndChild(root);
    set(root, "model", scene_.title.empty() ? "scene" : scene_.title);
    add_settings(root);
    XMLElement* world = root->InsertNewChildElement("worldbody");
    for (std::size_t i = 0; i < scene_.ropes.size(); ++i) add_rope_ends(world, kWorld, i);
    for_each_child(scene_, kWorld, [&](int i) { add_body(world, i); });
    if (options_.native) {
      add_contacts(root);
      add_locks(root);
      add_ropes(root);
    }
    add_start(root);
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    return printer.CStr();
  }

 private:
  void add_settings(XMLElement* root) {
    XMLElement* compiler = root->InsertNewChildElement("compiler");
    compiler->SetAttribute("angle", "radian");
    compiler->SetAttribute("inertiafromgeom", "false");

    XMLElement* option = root->InsertNewChildElement("option");
    set(option, "timestep", text(options_.step));
    set(option, "gravity", text(scene_.gravity));
    option->SetAttribute("integrator", "RK4");
    option->SetAttribute("cone", "elliptic");
    option->SetAttribute("solver", "Newton");
    set(option, "impratio", text(options_.impratio));
    option->SetAttribute("tolerance", "1e-14");
    option->SetAttribute("iterations", "50");
    XMLElement* flag = option->InsertNewChildElement("flag");
    flag->SetAttribute("warmstart", "disable");  // so that accelerations depend on the state alone
    if (!options_.native) {
      flag->SetAttribute("contact", "disable");
      flag->SetAttribute("constraint", "disable");
    }

    // The solver measures its progress against the mean inertia, which the drives' armature would spoil.
    XMLElement* statistic = root->InsertNewChildElement("statistic");
    const int moving = std::max<int>(1, std::count_if(scene_.bodies.begin(), scene_.bodies.end(),
                                                      [](const Body& body) { return !body.is_static(); }));
    set(statistic, "meaninertia", text(std::max(1.0, moving_mass(scene_) / moving)));

    int points = 0;
    for (const auto& pair : scene_.pairs) {
      const bool plane = is_plane_for(scene_, pair.body_a, pair.box_a, pair.body_b, pair.box_b) ||
                         is_plane_for(scene_, pair.body_b, pair.box_b, pair.body_a, pair.box_a);
      points += plane ? kMostPlanePoints : kMostBoxPoints;
    }
    int rows = kSpareRows + 2 * static_cast<int>(scene_.ropes.size()) + kPointRows * points;
    for (const auto& lock : scene_.locks) rows += 3 * static_cast<int>(lock.pins.size());
    XMLElement* size = root->InsertNewChildElement("size");
    size->SetAttribute("njmax", options_.native ? rows : kSpareRows);
    size->SetAttribute("nconmax", options_.native ? points + kMostBoxPoints : kMostBoxPoints);
  }

  void add_body(XMLElement* parent, int index) {
    const Body& body = scene_.bodies[index];
    const Joint& joint = body.joint;
    XMLElement* element = parent->InsertNewChildElement("body");
    set(element, "name", body.name);
    const Pose X_PB = joint.type == JointType::free ? body.X_WB : X_PB_at_zero(joint);
    set(element, "pos", text(X_PB.translation()));
    set(element, "quat", quaternion_text(X_PB.linear()));
    add_joint(element, index);
    if (!body.is_static()) add_inertia(element, body);
    for (std::size_t k = 0; k < body.boxes.size(); ++k) add_box(element, index, static_cast<int>(k));
    for (std::size_t k = 0; k < scene_.ropes.size(); ++k) add_rope_ends(element, index, k);
    for_each_child(scene_, index, [&](int child) { add_body(element, child); });
  }

  void add_joint(XMLElement* element, int index) {
    const Body& body = scene_.bodies[index];
    const Joint& joint = body.joint;
    if (joint.type == JointType::fixed) return;
    if (joint.type == JointType::free) {
      set(element->InsertNewChildElement("freejoint"), "name", joint_name(body));
    } else {
      XMLElement* child = element->InsertNewChildElement("joint");
      set(child, "name", joint_name(body));
      set(child, "pos", text(joint.X_BM.translation()));
      if (joint.type == JointType::pivot) {
        child->SetAttribute("type", "ball");
      } else {
        const bool slides = joint.type == JointType::slider;
        child->SetAttribute("type", slides ? "slide" : "hinge");
        set(child, "axis", text(joint.X_BM.linear().col(slides ? 0 : 2)));
      }
      child->SetAttribute("limited", "false");
      if (joint.damping > 0) set(child, "damping", text(joint.damping));
      if (joint.drive >= 0) set(child, "armature", text(drive_armature(scene_, index)));
    }
    positions_.insert(positions_.end(), start_[index].position.begin(), start_[index].position.end());
    velocities_.insert(velocities_.end(), start_[index].velocity.begin(), start_[index].velocity.end());
  }

  void add_inertia(XMLElement* element, const Body& body) {
    XMLElement* inertial = element->InsertNewChildElement("inertial");
    set(inertial, "pos", text(body.p_BBcm));
    set(inertial, "mass", text(body.mass));
    if (body.I_BBcm_B.isDiagonal(0)) {
      set(inertial, "diaginertia", text(Eigen::Vector3d(body.I_BBcm_B.diagonal())));
      return;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(body.I_BBcm_B);
    Eigen::Matrix3d axes = principal.eigenvectors();
    if (axes.determinant() < 0) axes.col(2) *= -1;
    set(inertial, "quat", quaternion_text(axes));
    set(inertial, "diaginertia", text(principal.eigenvalues()));
  }

  void add_box(XMLElement* element, int index, int box) {
    const Body& body = scene_.bodies[index];
    const CollisionBox& shape = body.boxes[box];
    XMLElement* geom = add_geom(element, geom_name(scene_, index, box, false), "box");
    set(geom, "size", text(options_.native ? contact_half(index, box) : shape.half));
    set(geom, "pos", text(shape.X_BG.translation()));
    set(geom, "quat", quaternion_text(shape.X_BG.linear()));
    if (!options_.native || !stands_as_plane(index, box)) return;

    const Pose X_BT = shape.X_BG * Eigen::Translation3d(0, 0, shape.half.z());
    XMLElement* plane = add_geom(element, geom_name(scene_, index, box, true), "plane");
    set(plane, "size", fmt::format("{} {} 1", shape.half.x(), shape.half.y()));
    set(plane, "pos", text(X_BT.translation()));
    set(plane, "quat", quaternion_text(X_BT.linear()));
    plane->SetAttribute("rgba", "0.5 0.5 0.5 0");
  }

  // MuJoCo's box collider (2.2.2) errs where edges of two boxes lie in one line, as those of stacked containers do:
  // contacts beside a box, and some that are metres deep, blows of 100 MN. So every box is a little shorter and
  // narrower than the boxes of its size before it.
  Eigen::Vector3d contact_half(int index, int box) const {
    const Eigen::Vector3d& half = scene_.bodies[index].boxes[box].half;
    int before = 0;
    for (int i = 0; i <= index; ++i) {
      const auto& boxes = scene_.bodies[i].boxes;
      for (int k = 0; k < (i == index ? box : static_cast<int>(boxes.size())); ++k) {
        before += (boxes[k].half - half).head<2>().norm() < kSameSize;
      }
    }
    const double shrink = std::min(before * kShrink, kMostShrink * half.head<2>().minCoeff());
    return half - Eigen::Vector3d(shrink, shrink, 0);
  }

  // Geoms meet only where a <pair> says so.
  static XMLElement* add_geom(XMLElement* element, const std::string& name, const char* type) {
    XMLElement* geom = element->InsertNewChildElement("geom");
    set(geom, "name", name);
    geom->SetAttribute("type", type);
    geom->SetAttribute("contype", 0);
    geom->SetAttribute("conaffinity", 0);
    return geom;
  }

  bool stands_as_plane(int body, int box) const {
    return std::any_of(scene_.pairs.begin(), scene_.pairs.end(), [&](const crane_models::ContactPair& pair) {
      return (pair.body_a == body && pair.box_a == box && is_plane_for(scene_, body, box, pair.body_b, pair.box_b)) ||
             (pair.body_b == body && pair.box_b == box && is_plane_for(scene_, body, box, pair.body_a, pair.box_a));
    });
  }

  void add_rope_ends(XMLElement* element, int body, std::size_t rope) {
    if (!options_.native) return;
    const auto add = [&](const spreader::Attachment& end, const char* suffix) {
      if (end.body != body) return;
      XMLElement* site = element->InsertNewChildElement("site");
      set(site, "name", scene_.ropes[rope].name + suffix);
      set(site, "pos", text(end.p_B));
      set(site, "size", text(kSiteSize));
    };
    add(scene_.ropes[rope].upper, ".upper");
    add(scene_.ropes[rope].lower, ".lower");
  }

  void add_contacts(XMLElement* root) {
    if (scene_.pairs.empty()) return;
    XMLElement* contact = root->InsertNewChildElement("contact");
    for (std::size_t i = 0; i < scene_.pairs.size(); ++i) {
      const auto& pair = scene_.pairs[i];
      const bool a_plane = is_plane_for(scene_, pair.body_a, pair.box_a, pair.body_b, pair.box_b);
      const bool b_plane = !a_plane && is_plane_for(scene_, pair.body_b, pair.box_b, pair.body_a, pair.box_a);
      XMLElement* element = contact->InsertNewChildElement("pair");
      set(element, "geom1", geom_name(scene_, pair.body_a, pair.box_a, a_plane));
      set(element, "geom2", geom_name(scene_, pair.body_b, pair.box_b, b_plane));
      element->SetAttribute("condim", options_.friction > 0 ? 3 : 1);
      set(element, "friction", fmt::format("{0} {0} 0 0 0", options_.friction));
      set_reference(element, "solref", "solimp", options_.pairs, i);
    }
  }

  void add_locks(XMLElement* root) {
    if (scene_.locks.empty()) return;
    XMLElement* equality = root->InsertNewChildElement("equality");
    for (std::size_t i = 0; i < scene_.locks.size(); ++i) {
      const spreader::Lock& lock = scene_.locks[i];
      for (std::size_t k = 0; k < lock.pins.size(); ++k) {
        XMLElement* connect = equality->InsertNewChildElement("connect");
        set(connect, "name", pin_name(lock, static_cast<int>(k)));
        set(connect, "body1", scene_.bodies[lock.body_a].name);
        set(connect, "body2", scene_.bodies[lock.body_b].name);
        set(connect, "anchor", text(lock.pins[k].p_A));
        connect->SetAttribute("active", lock.closed);
        set_reference(connect, "solref", "solimp", options_.locks, i);
      }
    }
  }

  void add_ropes(XMLElement* root) {
    if (scene_.ropes.empty()) return;
    XMLElement* tendon = root->InsertNewChildElement("tendon");
    for (std::size_t i = 0; i < scene_.ropes.size(); ++i) {
      const spreader::Rope& rope = scene_.ropes[i];
      XMLElement* spatial = tendon->InsertNewChildElement("spatial");
      set(spatial, "name", rope.name);
      spatial->SetAttribute("limited", "true");
      set(spatial, "range", "0 " + text(crane_models::rest_length_at_start(scene_, rope)));
      set(spatial, "width", text(kRopeWidth));
      set_reference(spatial, "solreflimit", "solimplimit", options_.ropes, i);
      for (const char* suffix : {".upper", ".lower"}) {
        set(spatial->InsertNewChildElement("site"), "site", rope.name + suffix);
      }
    }
  }

  void add_start(XMLElement* root) {
    if (positions_.empty()) return;
    XMLElement* key = root->InsertNewChildElement("keyframe")->InsertNewChildElement("key");
    key->SetAttribute("name", "start");
    set(key, "qpos", text(positions_));
    set(key, "qvel", text(velocities_));
  }

  const Scene& scene_;
  const MjcfOptions& options_;
  std::vector<StartCoordinates> start_;
  std::vector<double> positions_, velocities_;  // in the order of MuJoCo's coordinates
  tinyxml2::XMLDocument document_;
};

std::vector<double> values(const Eigen::Quaterniond& q) { return {q.w(), q.x(), q.y(), q.z()}; }

}  // namespace

std::string to_mjcf(const Scene& scene, const MjcfOptions& options) {
  crane_models::check(scene);
  return Writer(scene, options).write();
}

std::vector<StartCoordinates> start_coordinates(const Scene& scene) {
  struct Motion {
    Pose X_WB = Pose::Identity();
    Eigen::Vector3d v_WB = Eigen::Vector3d::Zero(), w_WB = Eigen::Vector3d::Zero();
  };
  std::vector<StartCoordinates> start(scene.bodies.size());
  std::vector<Motion> motions(scene.bodies.size());
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const Joint& joint = body.joint;
    const Motion parent = joint.parent == kWorld ? Motion() : motions[joint.parent];
    Motion& motion = motions[i];
    if (joint.type == JointType::free) {
      motion = {body.X_WB, body.v_WB, body.w_WB};
      start[i].position = {body.X_WB.translation().x(), body.X_WB.translation().y(), body.X_WB.translation().z()};
      const auto q = values(Eigen::Quaterniond(body.X_WB.linear()));
      start[i].position.insert(start[i].position.end(), q.begin(), q.end());
      const Eigen::Vector3d w_WB_B = body.X_WB.linear().transpose() * body.w_WB;
      start[i].velocity = {body.v_WB.x(), body.v_WB.y(), body.v_WB.z(), w_WB_B.x(), w_WB_B.y(), w_WB_B.z()};
      continue;
    }

    // The coordinate is what of the wanted pose the joint allows; its rate likewise.
    const Pose X_WF = parent.X_WB * joint.X_PF;
    const Pose X_FM = X_WF.inverse() * body.X_WB * joint.X_BM;
    const Eigen::Vector3d w_PB = body.w_WB - parent.w_WB;
    Pose X_FM_start = Pose::Identity();
    Eigen::Vector3d w_PB_start = Eigen::Vector3d::Zero(), v_FM_start = Eigen::Vector3d::Zero();
    if (joint.type == JointType::slider) {
      const Eigen::Vector3d axis_W = X_WF.linear().col(0);
      const Eigen::Vector3d p_BM_W = body.X_WB.linear() * joint.X_BM.translation();
      const Eigen::Vector3d p_PM_W = body.X_WB.translation() + p_BM_W - parent.X_WB.translation();
      double q = X_FM.translation().x();
      double rate = axis_W.dot(body.v_WB + body.w_WB.cross(p_BM_W) - parent.v_WB - parent.w_WB.cross(p_PM_W));
      if (joint.drive >= 0) q = scene.drives[joint.drive].start, rate = 0;
      X_FM_start.translation().x() = q;
      v_FM_start = rate * axis_W;
      start[i] = {{q}, {rate}};
    } else if (joint.type == JointType::hinge) {
      const Eigen::Vector3d axis_W = X_WF.linear().col(2);
      double q = std::atan2(X_FM.linear()(1, 0), X_FM.linear()(0, 0));
      double rate = axis_W.dot(w_PB);
      if (joint.drive >= 0) q = scene.drives[joint.drive].start, rate = 0;
      X_FM_start.linear() = Eigen::AngleAxisd(q, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      w_PB_start = rate * axis_W;
      start[i] = {{q}, {rate}};
    } else if (joint.type == JointType::pivot) {
      X_FM_start.linear() = X_FM.linear();
      w_PB_start = w_PB;
      const Eigen::Matrix3d R_BM = joint.X_BM.linear();
      const Eigen::Matrix3d R_WB = X_WF.linear() * X_FM.linear() * R_BM.transpose();
      const Eigen::Vector3d w_PB_B = R_WB.transpose() * w_PB;
      start[i] = {values(Eigen::Quaterniond(Eigen::Matrix3d(R_BM * X_FM.linear() * R_BM.transpose()))),
                  {w_PB_B.x(), w_PB_B.y(), w_PB_B.z()}};
    }
    const Pose X_WM = X_WF * X_FM_start;
    motion.X_WB = X_WM * joint.X_BM.inverse();
    motion.w_WB = parent.w_WB + w_PB_start;
    const Eigen::Vector3d v_WM =
        parent.v_WB + parent.w_WB.cross(X_WM.translation() - parent.X_WB.translation()) + v_FM_start;
    motion.v_WB = v_WM + motion.w_WB.cross(motion.X_WB.translation() - X_WM.translation());
  }
  return start;
}

double drive_armature(const Scene& scene, int body) {
  const Joint& joint = scene.bodies[body].joint;
  double inertia = moving_mass(scene);
  if (joint.type == JointType::hinge) {
    // Radius of a hinge's load: all bodies at their distance from it, at least a metre.
    const Eigen::Vector3d p_WM = scene.bodies[body].X_WB * joint.X_BM.translation();
    double radius = 1;
    for (const Body& other : scene.bodies) {
      if (!other.is_static()) radius = std::max(radius, (other.X_WB * other.p_BBcm - p_WM).norm());
    }
    inertia *= radius * radius;
  }
  return kDriveInertiaRatio * inertia;
}

bool is_plane_for(const Scene& scene, int body, int box, int other_body, int other_box) {
  if (!scene.bodies[body].is_static()) return false;
  const CollisionBox& wide = scene.bodies[body].boxes[box];
  const Eigen::Vector3d up = (X_PB_at_zero(scene.bodies[body].joint) * wide.X_BG).linear().col(2);
  const CollisionBox& other = scene.bodies[other_body].boxes[other_box];
  const double diagonal = 2 * other.half.norm();
  const Pose X_WG = scene.bodies[body].X_WB * wide.X_BG;
  const Eigen::Vector3d start = X_WG.inverse() * (scene.bodies[other_body].X_WB * other.X_BG.translation());
  const Eigen::Array2d to_rim = wide.half.head<2>().array() - start.head<2>().array().abs();
  return (up - Eigen::Vector3d::UnitZ()).norm() < kLevel &&
         2 * std::min(wide.half.x(), wide.half.y()) > kPlaneRatio * diagonal && to_rim.minCoeff() > diagonal;
}

std::string geom_name(const Scene& scene, int body, int box, bool as_plane) {
  return fmt::format("{}.{}{}", scene.bodies[body].name, box, as_plane ? ".top" : "");
}

std::string pin_name(const spreader::Lock& lock, int pin) { return fmt::format("{}.{}", lock.name, pin); }

}  // namespace quayside::harness::mujoco
