#include "harness/scene_forces.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "contact_nn/separating_axes.h"

namespace quayside::harness {
namespace {

using crane_models::Pose;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Velocity of the material point of a body that is at `p_W` now.
Vector3d velocity_at(const BodyMotion& body, const Vector3d& p_W) {
  return body.v_WB + body.w_WB.cross(p_W - body.X_WB.translation());
}

void add_force(const BodyMotion& body, const Vector3d& f_W, const Vector3d& p_W, BodyForce& total) {
  total.f_W += f_W;
  total.t_W += (p_W - body.X_WB.translation()).cross(f_W);
}

// From a point to a box: p_B in the box's frame.
double squared_distance(const Vector3d& p_B, const Vector3d& half) {
  return (p_B.cwiseAbs() - half).cwiseMax(0.0).squaredNorm();
}

// The fastest that a point of a box moves along n.
double top_speed(const BodyMotion& body, const Pose& X_BG, const Vector3d& half, const Vector3d& n_W) {
  const Matrix3d R_WG = body.X_WB.linear() * X_BG.linear();
  // (w × e)·n = e·(n × w)
  const Vector3d turning_G = R_WG.transpose() * n_W.cross(body.w_WB);
  return n_W.dot(velocity_at(body, body.X_WB * X_BG.translation())) + half.dot(turning_G.cwiseAbs());
}

// The positive root of distance = speed t + ½ acceleration t²; infinite where there is none.
double time_to_cover(double distance, double speed, double acceleration) {
  const double root = std::sqrt(speed * speed + 2 * acceleration * distance);
  if (speed + root <= 0) return std::numeric_limits<double>::infinity();
  return speed > 0 ? 2 * distance / (speed + root) : (root - speed) / acceleration;
}

const BodyMotion kWorldAtRest;

const BodyMotion& motion_of(int body, const std::vector<BodyMotion>& bodies) {
  return body == crane_models::kWorld ? kWorldAtRest : bodies[body];
}

}  // namespace

SceneForces::SceneForces(const crane_models::Scene& scene, std::shared_ptr<const contact_nn::ContactModule> contact,
                         std::optional<contact_nn::BristleFriction> bristle)
    : scene_(scene), contact_(std::move(contact)), bristle_(bristle) {
  for (const crane_models::ContactPair& p : scene.pairs) {
    const crane_models::Body& a = scene.bodies[p.body_a];
    const crane_models::Body& b = scene.bodies[p.body_b];
    const crane_models::CollisionBox& box_a = a.boxes[p.box_a];
    const crane_models::CollisionBox& box_b = b.boxes[p.box_b];
    Pair pair{p.body_a, p.body_b, {box_a.half}, {box_b.half}, box_a.X_BG, box_b.X_BG, box_a.half.norm(),
              box_b.half.norm(), !a.is_static() + !b.is_static(), {}};
    for (std::size_t i = 0; i < scene.locks.size(); ++i) {
      const spreader::Lock& lock = scene.locks[i];
      if (std::minmax(lock.body_a, lock.body_b) == std::minmax(p.body_a, p.body_b)) {
        pair.locks.push_back(static_cast<int>(i));
      }
    }
    pairs_.push_back(std::move(pair));
  }
  for (const crane_models::LandedSwitch& landed : scene.landed_switches) {
    const auto in_group = [&](int body) {
      return std::find(landed.bodies.begin(), landed.bodies.end(), body) != landed.bodies.end();
    };
    std::vector<SwitchTerm> terms;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const bool a = in_group(pairs_[i].body_a), b = in_group(pairs_[i].body_b);
      if (a != b) terms.push_back({static_cast<int>(i), b ? 1.0 : -1.0});
    }
    switch_terms_.push_back(std::move(terms));
  }
}

SceneLoads SceneForces::make_loads() const {
  SceneLoads loads;
  loads.bodies.resize(scene_.bodies.size());
  loads.ropes.resize(scene_.ropes.size());
  loads.pairs.resize(pairs_.size());
  if (bristle_) loads.bristles = loads.bristle_rates = {pairs_.size(), contact_nn::Bristle::Zero()};
  return loads;
}

void SceneForces::evaluate(const std::vector<BodyMotion>& bodies, const std::vector<crane_models::DriveMotion>& drives,
                           const std::vector<char>& locks_closed, SceneLoads& loads,
                           contact_nn::ContactCounters& counters) const {
  assert(bodies.size() == scene_.bodies.size() && drives.size() == scene_.drives.size());
  assert(locks_closed.size() == scene_.locks.size() && loads.bodies.size() == bodies.size());
  std::fill(loads.bodies.begin(), loads.bodies.end(), BodyForce{});
  loads.potential_energy = loads.rope_work_in = loads.dissipated_power = 0;

  for (std::size_t i = 0; i < scene_.ropes.size(); ++i) add_rope(i, bodies, drives, loads);
  for (std::size_t i = 0; i < scene_.locks.size(); ++i) {
    if (locks_closed[i]) add_lock(scene_.locks[i], bodies, loads);
  }
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (loads.contacts_held) add_held_contact(i, bodies, loads);
    else add_contact(i, bodies, loads, counters);
  }
  loads.rope_work_in += add_wind(bodies, drives, loads.bodies);
}

// A box turns the sum over its three axes of area × |axis · wind| to the wind.
double SceneForces::add_wind(const std::vector<BodyMotion>& bodies,
                             const std::vector<crane_models::DriveMotion>& drives,
                             std::vector<BodyForce>& forces) const {
  const crane_models::Wind& wind = scene_.wind;
  if (wind.drive < 0) return 0;
  const double air_speed = drives[wind.drive].rate;
  double power = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (scene_.bodies[i].is_static()) continue;
    for (const crane_models::CollisionBox& box : scene_.bodies[i].boxes) {
      const Vector3d p_W = bodies[i].X_WB * box.X_BG.translation();
      const Matrix3d R_WG = bodies[i].X_WB.linear() * box.X_BG.linear();
      const Vector3d along = (R_WG.transpose() * wind.direction_W).cwiseAbs();
      const Vector3d& h = box.half;
      const double area = 4 * along.dot(Vector3d(h.y() * h.z(), h.z() * h.x(), h.x() * h.y()));
      const Vector3d v_W = velocity_at(bodies[i], p_W);
      const double relative = air_speed - wind.direction_W.dot(v_W);
      const Vector3d f_W = wind.pressure_factor * area * relative * std::abs(relative) * wind.direction_W;
      add_force(bodies[i], f_W, p_W, forces[i]);
      power += f_W.dot(v_W);
    }
  }
  return power;
}

spreader::RopeTension SceneForces::rope_state(const spreader::Rope& rope, const std::vector<BodyMotion>& bodies,
                                              const std::vector<crane_models::DriveMotion>& drives,
                                              Vector3d& direction_W) const {
  const BodyMotion& upper = motion_of(rope.upper.body, bodies);
  const BodyMotion& lower = motion_of(rope.lower.body, bodies);
  const Vector3d p_WU = upper.X_WB * rope.upper.p_B;
  const Vector3d p_WL = lower.X_WB * rope.lower.p_B;
  const double length = (p_WL - p_WU).norm();
  // A rope of no length is slack, so that its direction does not matter.
  direction_W = length > 0 ? Vector3d((p_WL - p_WU) / length) : Vector3d(-Vector3d::UnitZ());
  const double length_rate = direction_W.dot(velocity_at(lower, p_WL) - velocity_at(upper, p_WU));
  const crane_models::DriveMotion rest = crane_models::rest_length(rope, drives);
  return spreader::rope_tension(rope, length, length_rate, rest.value, rest.rate);
}

void SceneForces::add_rope(std::size_t index, const std::vector<BodyMotion>& bodies,
                           const std::vector<crane_models::DriveMotion>& drives, SceneLoads& loads) const {
  const spreader::Rope& rope = scene_.ropes[index];
  Vector3d direction_W;
  const spreader::RopeTension state = rope_state(rope, bodies, drives, direction_W);
  loads.ropes[index] = state;
  loads.potential_energy += state.energy;
  loads.rope_work_in += state.work_in;
  loads.dissipated_power += state.dissipated_power;
  const Vector3d pull_W = state.tension * direction_W;  // on the upper end
  const auto pull = [&](const spreader::Attachment& end, const Vector3d& f_W) {
    if (end.body != crane_models::kWorld) {
      add_force(bodies[end.body], f_W, bodies[end.body].X_WB * end.p_B, loads.bodies[end.body]);
    }
  };
  pull(rope.upper, pull_W);
  pull(rope.lower, -pull_W);
}

void SceneForces::add_lock(const spreader::Lock& lock, const std::vector<BodyMotion>& bodies, SceneLoads& loads) const {
  const BodyMotion& a = bodies[lock.body_a];
  const BodyMotion& b = bodies[lock.body_b];
  for (const spreader::Lock::Pin& pin : lock.pins) {
    const Vector3d p_WA = a.X_WB * pin.p_A;
    const Vector3d p_WB = b.X_WB * pin.p_B;
    const Vector3d middle_W = 0.5 * (p_WA + p_WB);
    const spreader::PinLoad load =
        spreader::pin_load(lock, p_WB - p_WA, velocity_at(b, middle_W) - velocity_at(a, middle_W));
    add_force(a, -load.force, middle_W, loads.bodies[lock.body_a]);
    add_force(b, load.force, middle_W, loads.bodies[lock.body_b]);
    loads.potential_energy += load.energy;
    loads.dissipated_power += load.dissipated_power;
  }
}

// A box is farther from the other than the sphere about it is: cheap, and unlike two spheres it tells a container from
// the ground, whose sphere holds the whole yard.
double SceneForces::distance_bound(const Pair& pair, const std::vector<BodyMotion>& bodies) {
  const Pose& X_WA = bodies[pair.body_a].X_WB;
  const Pose& X_WB = bodies[pair.body_b].X_WB;
  const Vector3d apart_W = X_WB * pair.X_BGb.translation() - X_WA * pair.X_BGa.translation();
  const auto distance = [&](const Pose& X_WBody, const Pose& X_BG, const Vector3d& half) {
    const Vector3d p_G = X_BG.linear().transpose() * (X_WBody.linear().transpose() * apart_W);  // up to a sign
    return std::sqrt(squared_distance(p_G, half));
  };
  return std::max(distance(X_WA, pair.X_BGa, pair.a.half) - pair.radius_b,
                  distance(X_WB, pair.X_BGb, pair.b.half) - pair.radius_a);
}

Pose SceneForces::relative_pose(const Pair& pair, const std::vector<BodyMotion>& bodies) const {
  const Pose X_WGa = bodies[pair.body_a].X_WB * pair.X_BGa;
  const Pose X_WGb = bodies[pair.body_b].X_WB * pair.X_BGb;
  return X_WGa.inverse() * X_WGb;
}

void SceneForces::add_contact(std::size_t index, const std::vector<BodyMotion>& bodies, SceneLoads& loads,
                              contact_nn::ContactCounters& counters) const {
  const Pair& pair = pairs_[index];
  PairLoad& load = loads.pairs[index];
  load = PairLoad{};
  const bool apart = distance_bound(pair, bodies) > 0;
  if (bristle_) loads.bristle_rates[index].setZero();
  if (apart && (!bristle_ || (loads.bristles[index].array() == 0).all())) return;

  const BodyMotion& a = bodies[pair.body_a];
  const BodyMotion& b = bodies[pair.body_b];
  const Matrix3d R_WGa = a.X_WB.linear() * pair.X_BGa.linear();
  const Vector3d p_WGb = b.X_WB * pair.X_BGb.translation();
  // The velocity of b's centre against the point of a that is there now, so that it is seen from a's frame as it turns.
  const contact_nn::RelativeVelocity V_AB{R_WGa.transpose() * (b.w_WB - a.w_WB),
                                          R_WGa.transpose() * (velocity_at(b, p_WGb) - velocity_at(a, p_WGb))};
  const Pose X_AB = relative_pose(pair, bodies);
  if (!apart) load.contact = contact_->force(pair.a, pair.b, X_AB, V_AB, counters);
  if (bristle_) loads.bristle_rates[index] = bristle_->add(loads.bristles[index], X_AB, V_AB, load.contact);
  loads.potential_energy += load.contact.potential_energy;  // that of a bristle outlasts its contact
  loads.dissipated_power += load.contact.dissipated_power;
  if (!load.contact.touching) return;

  const Vector3d p_WGa = a.X_WB * pair.X_BGa.translation();
  const Vector3d t_W = R_WGa * load.contact.t_A;  // about a's centre
  load.f_W = R_WGa * load.contact.f_A;
  load.p_W = p_WGa + R_WGa * load.contact.impact_point_A;
  load.t_W = t_W - (load.p_W - p_WGa).cross(load.f_W);
  // One force and torque about one point, a's centre, on both bodies.
  add_force(a, -load.f_W, p_WGa, loads.bodies[pair.body_a]);
  add_force(b, load.f_W, p_WGa, loads.bodies[pair.body_b]);
  loads.bodies[pair.body_a].t_W -= t_W;
  loads.bodies[pair.body_b].t_W += t_W;
}

void SceneForces::add_held_contact(std::size_t index, const std::vector<BodyMotion>& bodies, SceneLoads& loads) const {
  const Pair& pair = pairs_[index];
  const PairLoad& load = loads.pairs[index];
  loads.potential_energy += load.contact.potential_energy;
  loads.dissipated_power += load.contact.dissipated_power;
  if (!load.contact.touching) return;
  add_force(bodies[pair.body_a], -load.f_W, load.p_W, loads.bodies[pair.body_a]);
  add_force(bodies[pair.body_b], load.f_W, load.p_W, loads.bodies[pair.body_b]);
  loads.bodies[pair.body_a].t_W -= load.t_W;
  loads.bodies[pair.body_b].t_W += load.t_W;
}

double SceneForces::lock_energy(int index, const std::vector<BodyMotion>& bodies) const {
  const spreader::Lock& lock = scene_.locks[index];
  double energy = 0;
  for (const spreader::Lock::Pin& pin : lock.pins) {
    const Vector3d offset_W = bodies[lock.body_b].X_WB * pin.p_B - bodies[lock.body_a].X_WB * pin.p_A;
    energy += spreader::pin_load(lock, offset_W, Vector3d::Zero()).energy;
  }
  return energy;
}

void SceneForces::indicators(const std::vector<BodyMotion>& bodies,
                             const std::vector<crane_models::DriveMotion>& drives, const SceneLoads& loads,
                             Indicators& out) const {
  out.ropes.resize(scene_.ropes.size());
  out.pairs.resize(pairs_.size());
  out.switches.resize(switch_terms_.size());
  Vector3d direction_W;
  for (std::size_t i = 0; i < out.ropes.size(); ++i) {
    out.ropes[i] = rope_state(scene_.ropes[i], bodies, drives, direction_W).stretch;
  }
  for (std::size_t i = 0; i < out.pairs.size(); ++i) {
    const double bound = distance_bound(pairs_[i], bodies);
    out.pairs[i] =
        bound > 0 ? -bound : -contact_nn::separation(pairs_[i].a, pairs_[i].b, relative_pose(pairs_[i], bodies));
  }
  for (std::size_t i = 0; i < out.switches.size(); ++i) {
    double upward = 0;
    for (const SwitchTerm& term : switch_terms_[i]) upward += term.sign * loads.pairs[term.pair].f_W.z();
    out.switches[i] = upward / scene_.landed_switches[i].threshold - 1;
  }
}

// Along the axis that separates two boxes most, held still in the world, their gap shrinks no faster than the fastest
// point of the one moves towards the slowest of the other; and no penetration is deeper than the overlap along any
// axis.
double SceneForces::time_to_contact(const std::vector<BodyMotion>& bodies, double depth, double acceleration,
                                    const std::vector<char>& locks_closed) const {
  double shortest = std::numeric_limits<double>::infinity();
  for (const Pair& pair : pairs_) {
    const auto is_closed = [&](int lock) { return !locks_closed.empty() && locks_closed[lock]; };
    if (std::any_of(pair.locks.begin(), pair.locks.end(), is_closed)) continue;
    const contact_nn::AxisSeparation axis =
        contact_nn::largest_separation(pair.a, pair.b, relative_pose(pair, bodies));
    if (axis.gap < 0) continue;
    const BodyMotion& a = bodies[pair.body_a];
    const BodyMotion& b = bodies[pair.body_b];
    const Vector3d n_W = a.X_WB.linear() * (pair.X_BGa.linear() * axis.n_A);
    const double closing = top_speed(a, pair.X_BGa, pair.a.half, n_W) + top_speed(b, pair.X_BGb, pair.b.half, -n_W);
    shortest = std::min(shortest, time_to_cover(axis.gap + depth, closing, pair.moving_sides * acceleration));
  }
  return shortest;
}

}  // namespace quayside::harness
