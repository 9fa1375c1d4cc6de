#include "harness/mujoco/native_options.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "contact_nn/pads_law.h"
#include "contact_nn/potential_law.h"
#include "contact_nn/triangle_moments.h"
#include "harness/mujoco/model.h"

namespace quayside::harness::mujoco {
namespace {

using crane_models::CollisionBox;
using crane_models::Pose;
using crane_models::Scene;

constexpr double kPressedDepth = 1e-3;  // [m]
constexpr double kStandardGravity = 9.81;  // for the friction of scenes without gravity [m/s²]

// The axis of R nearest to `direction`, and the sign with which it points there.
std::pair<int, double> nearest_axis(const Eigen::Matrix3d& R, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d along = R.transpose() * direction;
  int axis;
  along.cwiseAbs().maxCoeff(&axis);
  return {axis, along[axis] < 0 ? -1.0 : 1.0};
}

double face_area(const Eigen::Vector3d& half, int normal) {
  return 4 * half[(normal + 1) % 3] * half[(normal + 2) % 3];
}

Eigen::Matrix3d rotation_at_start(const Scene& scene, int body, int box) {
  return scene.bodies[body].X_WB.linear() * scene.bodies[body].boxes[box].X_BG.linear();
}

std::string quaternion_text(const Eigen::Quaterniond& q) {
  return fmt::format("{} {} {} {}", q.w(), q.x(), q.y(), q.z());
}

std::string box_text(const char* name, const Eigen::Vector3d& half, double height, const Eigen::Quaterniond& q) {
  return fmt::format(R"(<geom name="{}" type="box" size="{} {} {}" pos="0 0 {}" quat="{}" mass="1" contype="0")"
                     R"( conaffinity="0"/>)",
                     name, half.x(), half.y(), half.z(), height, quaternion_text(q));
}

}  // namespace

FlatContact press_flat(const Scene& scene, const crane_models::ContactPair& pair) {
  const ProcessHooks hooks;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d half_a = scene.bodies[pair.body_a].boxes[pair.box_a].half;
  const Eigen::Vector3d half_b = scene.bodies[pair.body_b].boxes[pair.box_b].half;
  const Eigen::Matrix3d R_WA = rotation_at_start(scene, pair.body_a, pair.box_a);
  const Eigen::Matrix3d R_WB = rotation_at_start(scene, pair.body_b, pair.box_b);
  const auto [normal_a, sign_a] = nearest_axis(R_WA, up);
  const auto [normal_b, sign_b] = nearest_axis(R_WB, up);
  const auto level = [&](const Eigen::Matrix3d& R, int normal, double sign) {
    return Eigen::Quaterniond::FromTwoVectors(sign * R.col(normal), up) * Eigen::Quaterniond(R);
  };
  const Eigen::Quaterniond q_a = level(R_WA, normal_a, sign_a), q_b = level(R_WB, normal_b, sign_b);

  const bool a_plane = is_plane_for(scene, pair.body_a, pair.box_a, pair.body_b, pair.box_b);
  const bool b_plane = !a_plane && is_plane_for(scene, pair.body_b, pair.box_b, pair.body_a, pair.box_a);
  const std::string below =
      a_plane || b_plane ? R"(<geom name="below" type="plane" size="1 1 1" contype="0" conaffinity="0"/>)"
                         : box_text("below", half_a, -half_a[normal_a], q_a);
  const std::string above = b_plane ? box_text("above", half_a, half_a[normal_a] - kPressedDepth, q_a)
                                    : box_text("above", half_b, half_b[normal_b] - kPressedDepth, q_b);
  const ModelPointer model = compile(fmt::format(
      R"(<mujoco><worldbody>{}<body><freejoint/>{}</body></worldbody>)"
      R"(<contact><pair geom1="below" geom2="above"/></contact></mujoco>)",
      below, above));
  mjData* data = nullptr;
  guarded([&] { data = mj_makeData(model.get()); });
  const DataPointer owned(data);
  guarded([&] { mj_fwdPosition(model.get(), data); });

  FlatContact result;
  result.area = std::min(face_area(half_a, normal_a), face_area(half_b, normal_b));
  double depth = 0;
  for (int i = 0; i < data->ncon; ++i) depth -= data->contact[i].dist;
  result.points = std::max(1, data->ncon);
  if (data->ncon > 0) result.reported_depth = depth / (data->ncon * kPressedDepth);
  return result;
}

double damping_ratio(double restitution) {
  if (restitution >= 1) return 0;
  const auto rebound = [](double zeta) {
    // acos ζ/√(1 − ζ²) = acosh ζ/√(ζ² − 1) is 1 at ζ = 1.
    const double square = 1 - zeta * zeta;
    const double quotient = square > 0   ? std::acos(zeta) / std::sqrt(square)
                            : square < 0 ? std::acosh(zeta) / std::sqrt(-square)
                                         : 1;
    return std::exp(-2 * zeta * quotient);
  };
  double low = 0, high = 1;
  while (rebound(high) > restitution) high *= 2;
  constexpr int kBisections = 60;  // to the last bit
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (rebound(middle) > restitution ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

SolverReference reference(double stiffness, double damping, double inverse_mass) {
  return {stiffness * inverse_mass * (1 - kImpedance), damping * inverse_mass * (1 - kImpedance)};
}

double inverse_mass(const mjModel* model, int body_a, int body_b) {
  return model->body_invweight0[2 * body_a] + model->body_invweight0[2 * body_b];
}

MjcfOptions native_options(const Scene& scene, const contact_nn::ContactSettings& contact) {
  const ProcessHooks hooks;
  MjcfOptions options;
  options.friction = contact.friction;
  // The inverse masses are MuJoCo's own, so the model is made once without the parameters that they are for.
  const Model plain(scene, to_mjcf(scene, options));
  const mjModel* m = plain.model();

  for (const spreader::Rope& rope : scene.ropes) {
    const double stiffness = rope.axial_stiffness / crane_models::rest_length_at_start(scene, rope);
    const int tendon = mj_name2id(m, mjOBJ_TENDON, rope.name.c_str());
    options.ropes.push_back(reference(stiffness, rope.damping_time * stiffness, m->tendon_invweight0[tendon]));
  }
  for (const spreader::Lock& lock : scene.locks) {
    options.locks.push_back(reference(
        lock.stiffness, lock.damping, inverse_mass(m, plain.body_id(lock.body_a), plain.body_id(lock.body_b))));
  }

  double zeta = damping_ratio(contact.restitution);
  if (contact.friction > 0) zeta = std::max(zeta, kLeastDampingRatio);
  const double gravity = scene.gravity.norm() > 0 ? scene.gravity.norm() : kStandardGravity;
  for (const auto& pair : scene.pairs) {
    const FlatContact flat = press_flat(scene, pair);
    double stiffness = contact.stiffness;
    const bool pads = contact.law == contact_nn::Law::pads;
    if (!pads && contact.law != contact_nn::Law::points) {
      stiffness *= std::pow(flat.area / contact_nn::kReferenceArea, 2.0 / contact_nn::kNorm);
    }
    const double inverse = inverse_mass(m, plain.body_id(pair.body_a), plain.body_id(pair.body_b));
    const double damping = inverse > 0 ? 2 * zeta * std::sqrt(stiffness / inverse) : 0;
    const int points = pads ? contact_nn::kPads : flat.points;
    options.pairs.push_back(reference(stiffness / (points * flat.reported_depth), damping / points, inverse));
    if (damping > 0) {
      options.impratio = std::max(
          options.impratio, contact.friction * gravity / (inverse * damping * contact.transition_speed));
    }
  }
  return options;
}

}  // namespace quayside::harness::mujoco
