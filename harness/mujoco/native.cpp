#include "harness/mujoco/native.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "harness/mujoco/native_options.h"
#include "harness/mujoco/phantom.h"

namespace quayside::harness::mujoco {
namespace {

// The geometry of contacts as our own modules see it, for events and time to contact; the forces are MuJoCo's.
std::shared_ptr<const contact_nn::ContactModule> geometry(contact_nn::ContactSettings contact) {
  contact.model = contact_nn::Model::exact;
  return contact_nn::make_contact_module(contact);
}

Eigen::Vector3d vector(const mjtNum* v) { return {v[0], v[1], v[2]}; }

crane_models::Pose geom_pose(const mjData* data, int geom) {
  crane_models::Pose X_WG = crane_models::Pose::Identity();
  X_WG.translation() = vector(data->geom_xpos + 3 * geom);
  X_WG.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data->geom_xmat + 9 * geom);
  return X_WG;
}

void set_active(mjModel* model, mjData* data, int equality, bool active) {
#if mjVERSION_HEADER >= 310
  data->eq_active[equality] = active;
#else
  model->eq_active[equality] = active;
#endif
}

int geom_index(const mjContact& contact, int side) {
#if mjVERSION_HEADER >= 310
  return contact.geom[side];
#else
  return side == 0 ? contact.geom1 : contact.geom2;
#endif
}

}  // namespace

NativeEngine::NativeEngine(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
                           const SolverSettings& solver)
    : NativeEngine(scene, contact, solver, native_options(scene, contact)) {}

NativeEngine::NativeEngine(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
                           const SolverSettings& solver, const MjcfOptions& options)
    : Engine("mujoco", scene, contact, solver, geometry(contact), to_mjcf(scene, options)) {
  mjModel* m = model_.model();
  for (const auto& rope : scene_.ropes) tendons_.push_back(mj_name2id(m, mjOBJ_TENDON, rope.name.c_str()));
  for (const auto& lock : scene_.locks) {
    std::vector<int> pins;
    for (std::size_t k = 0; k < lock.pins.size(); ++k) {
      const int equality = mj_name2id(m, mjOBJ_EQUALITY, pin_name(lock, static_cast<int>(k)).c_str());
      // MuJoCo takes the second anchor from the pose at the start; a lock may close later.
      mjtNum* anchors = m->eq_data + mjNEQDATA * equality;
      std::copy_n(lock.pins[k].p_A.data(), 3, anchors);
      std::copy_n(lock.pins[k].p_B.data(), 3, anchors + 3);
      pins.push_back(equality);
    }
    equalities_.push_back(std::move(pins));
  }
  pair_of_geoms_.assign(m->ngeom * m->ngeom, 0);
  for (const auto& pair : scene_.pairs) {
    const bool a_plane = is_plane_for(scene_, pair.body_a, pair.box_a, pair.body_b, pair.box_b);
    const bool b_plane = !a_plane && is_plane_for(scene_, pair.body_b, pair.box_b, pair.body_a, pair.box_a);
    const auto id = [&](int body, int box, bool as_plane) {
      return mj_name2id(m, mjOBJ_GEOM, geom_name(scene_, body, box, as_plane).c_str());
    };
    const int a = id(pair.body_a, pair.box_a, a_plane), b = id(pair.body_b, pair.box_b, b_plane);
    pairs_.push_back({id(pair.body_a, pair.box_a, false), id(pair.body_b, pair.box_b, false),
                      press_flat(scene_, pair).reported_depth});
    const int number = static_cast<int>(pairs_.size());
    pair_of_geoms_[a * m->ngeom + b] = number;
    pair_of_geoms_[b * m->ngeom + a] = -number;
  }
  reset();
}

void NativeEngine::set_ropes(double after) {
  mjModel* m = model_.model();
  for (std::size_t i = 0; i < tendons_.size(); ++i) {
    const auto& rope = scene_.ropes[i];
    const crane_models::DriveMotion motion =
        crane_models::rest_length(rope, [&](int index) { return drive(index, after); });
    const double rest_length = motion.value;
    // An upper limit must stay above the lower one, which is 0, and a stiffness finite.
    if (rest_length <= 0) throw MujocoError("rope " + rope.name + " has been hoisted to no length at all");
    const double stiffness = rope.axial_stiffness / rest_length;
    const int tendon = tendons_[i];
    const SolverReference ref =
        reference(stiffness, rope.damping_time * stiffness, m->tendon_invweight0[tendon]);
    m->tendon_range[2 * tendon + 1] = rest_length + rope.damping_time * motion.rate;
    m->tendon_solref_lim[2 * tendon] = -ref.stiffness;
    m->tendon_solref_lim[2 * tendon + 1] = -ref.damping;
  }
}

void NativeEngine::prepare_evaluation() {
  set_ropes(0);
  for (std::size_t i = 0; i < equalities_.size(); ++i) {
    for (const int equality : equalities_[i]) set_active(model_.model(), model_.data(), equality, locks_closed_[i]);
  }
}

void NativeEngine::prepare_stages(double h) {
  set_ropes(kMeanOfLaterStages * h);
}

void NativeEngine::read_loads() {
  loads_.potential_energy = loads_.rope_work_in = loads_.dissipated_power = 0;
  read_contacts();
  read_energy();
  read_ropes();
  loads_.rope_work_in += forces_.add_wind(motions_, drives_now_, loads_.bodies);
  write_rates(loads_.rope_work_in, loads_.dissipated_power + model_.joint_damping_power());
}

NativeEngine::PairContact NativeEngine::find_pair(const mjContact& contact) const {
  const int number = pair_of_geoms_[geom_index(contact, 0) * model_.model()->ngeom + geom_index(contact, 1)];
  assert(number != 0);
  return {std::abs(number) - 1, number > 0 ? 1.0 : -1.0};
}

void NativeEngine::read_contacts() {
  const mjData* d = model_.data();
  std::fill(loads_.pairs.begin(), loads_.pairs.end(), PairLoad{});
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (contact.efc_address < 0) continue;
    const auto [index, sign] = find_pair(contact);
    PairLoad& load = loads_.pairs[index];
    mjtNum force[6];
    mj_contactForce(model_.model(), d, i, force);
    for (int axis = 0; axis < 3; ++axis) load.f_W += sign * force[axis] * vector(contact.frame + 3 * axis);
    load.p_W += force[0] * vector(contact.pos);
    load.contact.normal_force += force[0];
    load.contact.touching = true;
  }
  for (PairLoad& load : loads_.pairs) {
    if (load.contact.normal_force > 0) load.p_W /= load.contact.normal_force;
  }
}

// Of every row of locks and contacts: the spring in its force, f = −D K I r, the energy of that spring, and the power
// that the rest of the force takes. Rows of friction have no spring.
void NativeEngine::read_energy() {
  const mjData* d = model_.data();
  for (int i = 0; i < d->nefc; ++i) {
    const int type = d->efc_type[i];
    if (type == mjCNSTR_LIMIT_TENDON) continue;
    const double violation = d->efc_pos[i] - d->efc_margin[i];
    const double spring = -d->efc_D[i] * d->efc_KBIP[4 * i] * d->efc_KBIP[4 * i + 2] * violation;
    double depth_scale = 1;
    if (type == mjCNSTR_CONTACT_ELLIPTIC || type == mjCNSTR_CONTACT_FRICTIONLESS) {
      depth_scale = pairs_[find_pair(d->contact[d->efc_id[i]]).pair].reported_depth;
    }
    loads_.potential_energy += -0.5 * spring * violation / depth_scale;
    loads_.dissipated_power -= (d->efc_force[i] - spring) * d->efc_vel[i];
  }
}

void NativeEngine::read_ropes() {
  const mjData* d = model_.data();
  for (std::size_t i = 0; i < tendons_.size(); ++i) {
    const auto& rope = scene_.ropes[i];
    const crane_models::DriveMotion motion = crane_models::rest_length(rope, drives_now_);
    const double rest_length = motion.value;
    const double stiffness = rope.axial_stiffness / rest_length;
    spreader::RopeTension& state = loads_.ropes[i];
    state = {};
    state.stretch = d->ten_length[tendons_[i]] - rest_length;
    const double x = std::max(0.0, state.stretch);
    state.energy = 0.5 * stiffness * x * x;
    for (int row = d->ne; row < d->nefc; ++row) {
      if (d->efc_type[row] == mjCNSTR_LIMIT_TENDON && d->efc_id[row] == tendons_[i]) state.tension = d->efc_force[row];
    }
    state.work_in = -(state.tension + 0.5 * stiffness * x * x / rest_length) * motion.rate;
    state.dissipated_power = (state.tension - stiffness * x) * (d->ten_velocity[tendons_[i]] - motion.rate);
    loads_.potential_energy += state.energy;
    loads_.rope_work_in += state.work_in;
    loads_.dissipated_power += state.dissipated_power;
  }
}

void NativeEngine::integrate(double h, const std::vector<double>& rates_at_begin) {
  for (std::size_t i = 0; i < rates_.size(); ++i) integrals_[i] += 0.5 * h * (rates_at_begin[i] + rates_[i]);
}

void NativeEngine::add_passive_forces(const mjModel*, mjData* data) {
  ++statistics_.rhs_evaluations;
  if (scene_.wind.drive >= 0) {
    fill_drives(data->time);
    model_.read_motions(motions_);
    std::fill(loads_.bodies.begin(), loads_.bodies.end(), BodyForce{});
    forces_.add_wind(motions_, drives_now_, loads_.bodies);
    model_.add_forces(loads_.bodies, data->qfrc_passive);
  }
  for (int i = 0; i < data->ncon; ++i) {
    const mjContact& contact = data->contact[i];
    const auto [index, sign] = find_pair(contact);
    const crane_models::Pose X_WA = geom_pose(data, pairs_[index].box_a), X_WB = geom_pose(data, pairs_[index].box_b);
    const ReportedContact reported{X_WA.inverse() * vector(contact.pos),
                                   sign * (X_WA.linear().transpose() * vector(contact.frame)), -contact.dist};
    const auto& pair = scene_.pairs[index];
    statistics_.phantom_contacts +=
        is_phantom({scene_.bodies[pair.body_a].boxes[pair.box_a].half},
                   {scene_.bodies[pair.body_b].boxes[pair.box_b].half}, X_WA.inverse() * X_WB, reported);
  }
}

}  // namespace quayside::harness::mujoco
