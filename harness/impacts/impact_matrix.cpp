#include "harness/impacts/impact_matrix.h"

#include <cassert>

#include <fmt/format.h>

#include "spreader/container.h"
#include "spreader/mass_properties.h"

namespace quayside::harness {
namespace {

using crane_models::Body;
using crane_models::Pose;
using crane_models::Scene;
using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kFull = 30480, kEmpty = 3940;  // ISO 40 ft container, gross and tare [kg]
constexpr double kFlight = 1e-3;                // before the touch [s]
constexpr double kSameHeight = 1e-9;            // of corners that touch together [m]
constexpr double kGravity = 9.81;               // [m/s²]
constexpr double kRopeLength = 20;              // stretched [m]
constexpr double kRopeStiffness = 84e6;         // EA of a group of two falls [N]
constexpr double kOffCentre = 2, kOffCentreAcross = 0.4;  // of the point on a struck box that is hit, from the middle of its face [m]
const Vector3d kGroundHalf(20, 20, 1);          // [m]

const char* to_string(Feature feature) {
  switch (feature) {
    case Feature::face: return "face";
    case Feature::edge: return "edge";
    case Feature::vertex: return "vertex";
    case Feature::crossing: return "crossing edges";
  }
  assert(false && "a feature without a name");
  return "";
}

const char* to_string(Struck struck) {
  switch (struck) {
    case Struck::ground: return "ground";
    case Struck::box: return "box";
    case Struck::hanging: return "hanging box";
  }
  assert(false && "a struck body without a name");
  return "";
}

Body make_box(const std::string& name, double mass, const Pose& X_WB) {
  const Vector3d& size = spreader::container_data(spreader::ContainerSize::iso40).size;
  Body body;
  body.name = name;
  body.mass = mass;
  body.I_BBcm_B = spreader::uniform_box(mass, size).I_BBcm_B;
  body.boxes.push_back({0.5 * size});
  body.X_WB = X_WB;
  return body;
}

// How the box is turned when it comes from above; from the side the same about other axes.
Matrix3d attitude(const Impact& impact) {
  const bool side = impact.struck == Struck::hanging;
  switch (impact.feature) {
    case Feature::face: return Matrix3d::Identity();
    case Feature::edge: return AngleAxisd(0.3, side ? Vector3d::UnitZ() : Vector3d::UnitX()).toRotationMatrix();
    case Feature::vertex:
      return (AngleAxisd(0.3, side ? Vector3d::UnitZ() : Vector3d::UnitX()) * AngleAxisd(0.2, side ? Vector3d::UnitX() : Vector3d::UnitY()))
          .toRotationMatrix();
    case Feature::crossing:  // on its long edge, across the struck box, and that edge down to the outside
      return (AngleAxisd(-0.2, Vector3d::UnitX()) * AngleAxisd(0.5 * M_PI, Vector3d::UnitZ()) * AngleAxisd(0.25 * M_PI, Vector3d::UnitX()))
          .toRotationMatrix();
  }
  return Matrix3d::Identity();
}

// The middle of the corners that are farthest along `direction_W`, from the box' centre.
Vector3d foremost(const Vector3d& half, const Matrix3d& R_WB, const Vector3d& direction_W) {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  const double reach = half.dot((R_WB.transpose() * direction_W).cwiseAbs());
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const Vector3d p_W = R_WB * half.cwiseProduct(signs);
    if (p_W.dot(direction_W) > reach - kSameHeight) sum += p_W, ++count;
  }
  return sum / count;
}

// Four vertical ropes to points at half its height, which hold it in any attitude.
void hang(Scene& scene, int index) {
  const Body& body = scene.bodies[index];
  for (const double x : {-2.5, 2.5}) {
    for (const double y : {-0.8, 0.8}) {
      spreader::Rope rope;
      rope.name = body.name + ".rope" + std::to_string(scene.ropes.size());
      rope.lower = {index, {x, y, 0}};
      rope.upper = {crane_models::kWorld, body.X_WB * Vector3d(x, y, 0) + Vector3d(0, 0, kRopeLength)};
      rope.axial_stiffness = kRopeStiffness;
      rope.rest_length = kRopeLength / (1 + body.mass * kGravity / 4 / kRopeStiffness);
      scene.ropes.push_back(rope);
    }
  }
}

}  // namespace

std::string Impact::name() const {
  return fmt::format("{} on {}, {} m/s, {:g} t{}", to_string(feature), to_string(struck), speed, mass / 1e3, friction > 0 ? ", oblique" : "");
}

std::vector<Impact> impact_matrix() {
  constexpr double kFriction = 0.4;
  std::vector<Impact> all;
  const auto add = [&](Feature feature, Struck struck, double mass) {
    for (const double speed : {0.05, 0.5, 3.0}) {
      for (const double friction : {0.0, kFriction}) all.push_back({feature, struck, speed, mass, friction});
    }
  };
  for (const Feature feature : {Feature::face, Feature::edge, Feature::vertex}) {
    for (const Struck struck : {Struck::ground, Struck::box}) {
      for (const double mass : {kEmpty, kFull}) add(feature, struck, mass);
    }
    add(feature, Struck::hanging, kFull);
  }
  add(Feature::crossing, Struck::box, kFull);
  return all;
}

ImpactScene impact_scene(const Impact& impact) {
  ImpactScene result;
  Scene& scene = result.scene;
  scene.title = impact.name();
  const bool side = impact.struck == Struck::hanging;
  const Vector3d half = 0.5 * spreader::container_data(spreader::ContainerSize::iso40).size;
  Vector3d& n = result.normal_W;
  if (side) n = -Vector3d::UnitY();
  const Matrix3d R_WB = attitude(impact);
  if (impact.feature == Feature::crossing) n = (AngleAxisd(-0.2, Vector3d::UnitX()) * Vector3d::UnitZ());

  const Vector3d p_BP_W = impact.feature == Feature::crossing
                              ? Vector3d(R_WB * Vector3d(0, -half.y(), -half.z()))  // the middle of its edge
                              : foremost(half, R_WB, -n);
  const Vector3d tangent = (impact.feature == Feature::vertex && !side ? Vector3d(1, 1, 0).normalized()
                            : impact.feature == Feature::edge && !side ? Vector3d::UnitY()
                                                                       : Vector3d::UnitX());
  Vector3d v = -impact.speed * n;
  if (impact.friction > 0) v += kObliqueness * impact.speed * (tangent - tangent.dot(n) * n).normalized();

  Pose X_WA = Pose::Identity();
  // Faces meet whole. An edge that lies on a face is hit off the centre across it only, so that it stays lying.
  const bool face = impact.feature == Feature::face, edge = impact.feature == Feature::edge;
  switch (impact.struck) {
    case Struck::ground: X_WA.translation() = Vector3d(0, 0, -kGroundHalf.z()); break;
    case Struck::box:
      X_WA.translation() = Vector3d(face || edge ? 0 : -kOffCentre, face ? 0 : -kOffCentreAcross, -half.z());
      if (impact.feature == Feature::crossing) X_WA.translation().y() = -half.y();
      break;
    case Struck::hanging:
      X_WA.translation() = Vector3d(face ? 0 : -kOffCentre, half.y(), face || edge ? 0 : -kOffCentreAcross);
      break;
  }
  Body struck = make_box("struck", kFull, X_WA);
  if (impact.struck == Struck::ground) {
    struck.boxes[0].half = kGroundHalf;
    struck.joint.type = crane_models::JointType::fixed;
    struck.joint.X_PF = X_WA;
  }
  Pose X_WB = Pose::Identity();
  X_WB.linear() = R_WB;
  X_WB.translation() = -p_BP_W - kFlight * v;
  Body box = make_box("box", impact.mass, X_WB);
  box.v_WB = v;
  result.time_of_touch = kFlight;

  scene.bodies = {struck, box};
  scene.pairs = {{0, 0, 1, 0}};
  scene.frames = {{"struck", 0}, {"box", 1}};
  scene.gravity = side ? Vector3d(0, 0, -kGravity) : Vector3d(0, 0, 0);
  if (side) {
    for (const int i : {0, 1}) hang(scene, i);
  }
  return result;
}

}  // namespace quayside::harness
