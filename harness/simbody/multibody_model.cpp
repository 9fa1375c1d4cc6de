#include "harness/simbody/multibody_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include <Simbody.h>

namespace quayside::harness {
namespace {

using crane_models::Body;
using crane_models::DriveMotion;
using crane_models::Joint;
using crane_models::JointType;
using crane_models::kWorld;
using crane_models::Pose;

constexpr double kShortestRope = 0.05;  // the radius of a small sheave [m]

// Differences for the Jacobian: small against a contact's depth (1e-3 m) and the transition speed of friction
// (1e-3 m/s), large against the rounding of a yard's coordinates (1e-14) [m, rad, m/s, rad/s].
constexpr double kJacobianShift = 1e-8;

SimTK::Vec3 to_simtk(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d to_eigen(const SimTK::Vec3& v) { return {v[0], v[1], v[2]}; }

SimTK::Transform to_simtk(const Pose& X) {
  const Eigen::Quaterniond q(X.linear());
  return {SimTK::Rotation(SimTK::Quaternion(q.w(), q.x(), q.y(), q.z())), to_simtk(Eigen::Vector3d(X.translation()))};
}

Pose to_eigen(const SimTK::Transform& X) {
  const SimTK::Mat33& R = X.R().asMat33();
  Pose pose;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) pose.matrix()(row, column) = R(row, column);
    pose.matrix()(column, 3) = X.p()[column];
  }
  pose.makeAffine();
  return pose;
}

SimTK::MassProperties mass_properties(const Body& body) {
  const Eigen::Matrix3d& I = body.I_BBcm_B;
  const SimTK::Inertia central(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  const SimTK::Vec3 com = to_simtk(body.p_BBcm);
  return {body.mass, com, central.shiftFromMassCenter(com, body.mass)};
}

// The one coordinate of a driven joint follows its drive; the drive's motion at the state's time is kept by the model.
class Drive : public SimTK::Motion::Custom::Implementation {
 public:
  explicit Drive(const DriveMotion& now) : now_(now) {}
  SimTK::Motion::Level getLevel(const SimTK::State&) const override { return SimTK::Motion::Position; }
  void calcPrescribedPosition(const SimTK::State&, int, SimTK::Real* q) const override { *q = now_.value; }
  void calcPrescribedPositionDot(const SimTK::State&, int, SimTK::Real* qdot) const override { *qdot = now_.rate; }
  void calcPrescribedPositionDotDot(const SimTK::State&, int, SimTK::Real* qdotdot) const override {
    *qdotdot = now_.acceleration;
  }

 private:
  const DriveMotion& now_;
};

}  // namespace

struct MultibodyModel::Simbody {
  // Forces are evaluated before Simbody asks for them and handed over as they are.
  class Forces : public SimTK::Force::Custom::Implementation {
   public:
    explicit Forces(const MultibodyModel& model) : model_(model) {}
    void calcForce(const SimTK::State& state, SimTK::Vector_<SimTK::SpatialVec>& body_forces,
                   SimTK::Vector_<SimTK::Vec3>&, SimTK::Vector& mobility_forces) const override {
      model_.simbody_->apply(model_, state, body_forces, mobility_forces);
    }
    SimTK::Real calcPotentialEnergy(const SimTK::State&) const override { return 0; }

   private:
    const MultibodyModel& model_;
  };

  // A stretch of y that belongs to one joint.
  struct Slot {
    int body;
    int q, q_count;  // in Simbody's q
    int u, u_count;
  };

  void apply(const MultibodyModel& model, const SimTK::State& state, SimTK::Vector_<SimTK::SpatialVec>& body_forces,
             SimTK::Vector& mobility_forces) const {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (!bodies[i].isValid()) continue;
      const Body& body = model.scene_.bodies[i];
      const BodyForce& load = model.loads_.bodies[i];
      const Eigen::Vector3d weight_W = body.mass * model.scene_.gravity;
      const Eigen::Vector3d arm_W = model.motions_[i].X_WB.linear() * body.p_BBcm;
      body_forces[bodies[i]] += SimTK::SpatialVec(to_simtk(Eigen::Vector3d(load.t_W + arm_W.cross(weight_W))),
                                                  to_simtk(Eigen::Vector3d(load.f_W + weight_W)));
    }
    for (const Slot& slot : slots) {
      const double damping = model.scene_.bodies[slot.body].joint.damping;
      if (damping == 0) continue;
      for (int i = 0; i < slot.u_count; ++i) mobility_forces[slot.u + i] -= damping * state.getU()[slot.u + i];
    }
  }

  SimTK::MobilizedBody add(const Body& body, SimTK::MobilizedBody& parent, const SimTK::Transform& X_PF) {
    const SimTK::Body::Rigid rigid(mass_properties(body));
    const SimTK::Transform X_BM = to_simtk(body.joint.X_BM);
    switch (body.joint.type) {
      case JointType::fixed: return SimTK::MobilizedBody::Weld(parent, X_PF, rigid, X_BM);
      case JointType::slider: return SimTK::MobilizedBody::Slider(parent, X_PF, rigid, X_BM);
      case JointType::hinge: return SimTK::MobilizedBody::Pin(parent, X_PF, rigid, X_BM);
      case JointType::pivot: return SimTK::MobilizedBody::Ball(parent, X_PF, rigid, X_BM);
      // Placed at the centre of mass, whose motion is smoother than that of any other point.
      case JointType::free:
        return SimTK::MobilizedBody::Free(parent, X_PF, rigid, SimTK::Transform(to_simtk(body.p_BBcm)));
    }
    throw std::logic_error("a joint of unknown type");
  }

  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem forces{system};
  std::vector<SimTK::MobilizedBodyIndex> bodies;  // per body of the scene; invalid: fixed to the world
  std::vector<Slot> slots;                        // free joints in the order of y
  std::vector<int> y_to_q, y_to_u;                // y[i] is q[y_to_q[i]]; after those, u
  SimTK::State state;
};

MultibodyModel::MultibodyModel(const crane_models::Scene& scene,
                               std::shared_ptr<const contact_nn::ContactModule> contact,
                               std::optional<contact_nn::BristleFriction> bristle, bool free_bodies_directly)
    : scene_(scene),
      free_bodies_directly_(free_bodies_directly),
      forces_(scene, std::move(contact), bristle),
      drives_(scene.drives.size()),
      drive_now_(scene.drives.size()),
      motions_(scene.bodies.size()),
      loads_(forces_.make_loads()),
      simbody_(std::make_unique<Simbody>()) {
  crane_models::check(scene);
  Simbody& s = *simbody_;
  for (std::size_t i = 0; i < scene.drives.size(); ++i) drives_[i].motion = {scene.drives[i].start, 0, 0};
  for (const auto& lock : scene.locks) locks_closed_.push_back(lock.closed);

  // What is fixed to the world is no body for Simbody: it never moves and would only cost time.
  s.bodies.resize(scene.bodies.size());
  std::vector<char> at_rest(scene.bodies.size(), false);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const int parent = body.joint.parent;
    const bool parent_at_rest = parent == kWorld || at_rest[parent];
    Pose X_PF = body.joint.X_PF;
    if (parent != kWorld && at_rest[parent]) X_PF = motions_[parent].X_WB * X_PF;
    motions_[i].X_WB = body.X_WB;
    if (body.joint.type == JointType::fixed && parent_at_rest) {
      at_rest[i] = true;
      continue;
    }
    moving_mass_ += body.mass;
    SimTK::MobilizedBody& base = parent_at_rest ? s.matter.updGround() : s.matter.updMobilizedBody(s.bodies[parent]);
    SimTK::MobilizedBody mobilized = s.add(body, base, to_simtk(X_PF));
    s.bodies[i] = mobilized.getMobilizedBodyIndex();
    if (body.joint.drive >= 0) {
      driven_.push_back(static_cast<int>(i));
      SimTK::Motion::Custom(mobilized, new Drive(drive_now_[body.joint.drive]));
    }
  }
  SimTK::Force::Custom(s.forces, new Simbody::Forces(*this));
  s.state = s.system.realizeTopology();
  s.system.realizeModel(s.state);
  s.system.realize(s.state, SimTK::Stage::Instance);

  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!s.bodies[i].isValid() || scene.bodies[i].joint.drive >= 0) continue;
    const SimTK::MobilizedBody& body = s.matter.getMobilizedBody(s.bodies[i]);
    const Simbody::Slot slot{static_cast<int>(i), body.getFirstQIndex(s.state), body.getNumQ(s.state),
                             body.getFirstUIndex(s.state), body.getNumU(s.state)};
    if (slot.q_count > 0) s.slots.push_back(slot);
  }
  for (const auto& slot : s.slots) {
    const JointType type = scene.bodies[slot.body].joint.type;
    if (type == JointType::pivot || type == JointType::free) quaternions_.push_back(static_cast<int>(s.y_to_q.size()));
    for (int i = 0; i < slot.q_count; ++i) {
      s.y_to_q.push_back(slot.q + i);
      quantities_.push_back(type == JointType::slider  ? Quantity::position
                            : type == JointType::hinge ? Quantity::angle
                            : i < 4                    ? Quantity::quaternion
                                                       : Quantity::position);
    }
  }
  for (const auto& slot : s.slots) {
    const JointType type = scene.bodies[slot.body].joint.type;
    for (int i = 0; i < slot.u_count; ++i) {
      s.y_to_u.push_back(slot.u + i);
      const bool linear = type == JointType::slider || (type == JointType::free && i >= 3);
      quantities_.push_back(linear ? Quantity::velocity : Quantity::angular_velocity);
    }
  }
  quantities_.resize(quantities_.size() + contact_nn::Bristle::SizeAtCompileTime * loads_.bristles.size(),
                     Quantity::deflection);
  find_blocks();
  find_free_bodies();
}

MultibodyModel::~MultibodyModel() = default;

void MultibodyModel::set_drive(int drive, double reference, const DriveMotion& motion) {
  drives_[drive] = {reference, motion};
}

DriveMotion MultibodyModel::drive(int drive, double t) const {
  return drives_[drive].motion.after(t - drives_[drive].reference);
}

int MultibodyModel::spent_rope(double t) const {
  for (std::size_t i = 0; i < scene_.ropes.size(); ++i) {
    const spreader::Rope& rope = scene_.ropes[i];
    const auto motion_of = [&](int index) { return drive(index, t); };
    if (!rope.drives.empty() && crane_models::rest_length(rope, motion_of).value < kShortestRope) return static_cast<int>(i);
  }
  return -1;
}

// Parents stand before their children, so that a child can be fitted against a parent that is in place.
void MultibodyModel::start(double t, double* y) {
  Simbody& s = *simbody_;
  for (std::size_t i = 0; i < drives_.size(); ++i) drive_now_[i] = drive(static_cast<int>(i), t);
  s.state.setTime(t);
  s.state.updU() = 0;
  for (const auto& slot : s.slots) {
    s.system.realize(s.state, SimTK::Stage::Time);
    s.system.prescribeQ(s.state);
    s.system.realize(s.state, SimTK::Stage::Position);
    s.system.prescribeU(s.state);
    s.system.realize(s.state, SimTK::Stage::Velocity);
    const Body& body = scene_.bodies[slot.body];
    const SimTK::MobilizedBody& mobilized = s.matter.getMobilizedBody(s.bodies[slot.body]);
    const SimTK::MobilizedBody& parent = mobilized.getParentMobilizedBody();
    const SimTK::Transform X_WF = parent.getBodyTransform(s.state) * mobilized.getInboardFrame(s.state);
    const SimTK::Transform X_WM = to_simtk(body.X_WB) * mobilized.getOutboardFrame(s.state);
    const SimTK::SpatialVec V_WP = parent.getBodyVelocity(s.state);

    const SimTK::Vec3 w_WB = to_simtk(body.w_WB);
    const SimTK::Vec3 p_BM_W = X_WM.p() - to_simtk(Eigen::Vector3d(body.X_WB.translation()));
    const SimTK::Vec3 v_WM = to_simtk(body.v_WB) + SimTK::cross(w_WB, p_BM_W);
    // Of M against the point of the parent that is there now.
    const SimTK::Vec3 p_PM_W = X_WM.p() - parent.getBodyOriginLocation(s.state);
    const SimTK::SpatialVec V_FM_W(w_WB - V_WP[0], v_WM - V_WP[1] - SimTK::cross(V_WP[0], p_PM_W));
    const SimTK::Rotation R_FW = ~X_WF.R();
    mobilized.setQToFitTransform(s.state, ~X_WF * X_WM);
    mobilized.setUToFitVelocity(s.state, SimTK::SpatialVec(R_FW * V_FM_W[0], R_FW * V_FM_W[1]));
  }
  std::size_t i = 0;
  for (const int q : s.y_to_q) y[i++] = s.state.getQ()[q];
  for (const int u : s.y_to_u) y[i++] = s.state.getU()[u];
  std::fill(y + i, y + quantities_.size(), 0.0);
}

void MultibodyModel::evaluate(double t, const double* y) {
  ++evaluations;
  time_ = t;
  for (std::size_t i = 0; i < drives_.size(); ++i) drive_now_[i] = drive(static_cast<int>(i), t);
  direct_now_ = free_bodies_directly_ && !free_bodies_.empty() && !driven_joints_move(t);
  if (!direct_now_ || !tree_is_there()) move_tree(t, y);  // bodies with drives are where it says
  if (direct_now_) place_free_bodies(y, motions_);
  read_bristles(y, loads_);
  forces_.evaluate(motions_, drive_now_, locks_closed_, loads_, contact_counters);

  joint_dissipation_ = 0;
  const double* u = y + simbody_->y_to_q.size();
  for (const auto& slot : simbody_->slots) {
    const double damping = scene_.bodies[slot.body].joint.damping;
    for (int i = 0; i < slot.u_count; ++i, ++u) joint_dissipation_ += damping * *u * *u;
  }
}

// All bodies where Simbody says, at the drives' present motion.
void MultibodyModel::move_tree(double t, const double* y) {
  Simbody& s = *simbody_;
  tree_moved_ = true;
  tree_drives_ = drive_now_;
  const std::size_t q_count = s.y_to_q.size(), u_count = s.y_to_u.size();
  if (!driven_.empty()) {  // nothing else in Simbody knows the time
    s.state.setTime(t);
    s.system.realize(s.state, SimTK::Stage::Time);
    s.system.prescribeQ(s.state);
  }
  SimTK::Vector& q = s.state.updQ();
  for (std::size_t i = 0; i < q_count; ++i) q[s.y_to_q[i]] = y[i];
  if (!driven_.empty()) {
    s.system.realize(s.state, SimTK::Stage::Position);
    s.system.prescribeU(s.state);
  }
  SimTK::Vector& u = s.state.updU();
  for (std::size_t i = 0; i < u_count; ++i) u[s.y_to_u[i]] = y[q_count + i];
  s.system.realize(s.state, SimTK::Stage::Velocity);

  for (std::size_t i = 0; i < motions_.size(); ++i) {
    if (!s.bodies[i].isValid()) continue;
    const SimTK::MobilizedBody& body = s.matter.getMobilizedBody(s.bodies[i]);
    const SimTK::SpatialVec& V_WB = body.getBodyVelocity(s.state);
    motions_[i] = {to_eigen(body.getBodyTransform(s.state)), to_eigen(V_WB[1]), to_eigen(V_WB[0])};
  }
}

// Whether bodies with drives stand now where they stood when it was moved last.
bool MultibodyModel::tree_is_there() const {
  return tree_moved_ && std::all_of(driven_.begin(), driven_.end(), [&](int body) {
    const int drive = scene_.bodies[body].joint.drive;
    return tree_drives_[drive].rate == 0 && tree_drives_[drive].value == drive_now_[drive].value;
  });
}

void MultibodyModel::derivative(double t, const double* y, double* y_dot) {
  evaluate(t, y);
  if (direct_now_) {
    accelerate_free_bodies(y, motions_, loads_, y_dot);
    return;
  }
  Simbody& s = *simbody_;
  s.system.realize(s.state, SimTK::Stage::Acceleration);
  const SimTK::Vector& q_dot = s.state.getQDot();
  const SimTK::Vector& u_dot = s.state.getUDot();
  for (const int q : s.y_to_q) *y_dot++ = q_dot[q];
  for (const int u : s.y_to_u) *y_dot++ = u_dot[u];
  for (const contact_nn::Bristle& rate : loads_.bristle_rates) y_dot = std::copy(rate.begin(), rate.end(), y_dot);
}

int MultibodyModel::first_bristle() const {
  return size() - contact_nn::Bristle::SizeAtCompileTime * static_cast<int>(loads_.bristles.size());
}

void MultibodyModel::read_bristles(const double* y, SceneLoads& loads) const {
  y += first_bristle();
  for (contact_nn::Bristle& z : loads.bristles) {
    z = contact_nn::Bristle::Map(y);
    y += z.size();
  }
}

// Parents stand before their children.
void MultibodyModel::find_blocks() {
  const Simbody& s = *simbody_;
  block_of_body_.assign(scene_.bodies.size(), -1);
  constexpr int kBristle = contact_nn::Bristle::SizeAtCompileTime;
  for (int at = first_bristle(); at < size(); at += kBristle) {
    std::vector<int>& block = blocks_.emplace_back(kBristle);
    std::iota(block.begin(), block.end(), at);
  }
  std::size_t slot = 0;
  int q = 0, u = static_cast<int>(s.y_to_q.size());
  for (std::size_t body = 0; body < scene_.bodies.size(); ++body) {
    const int parent = scene_.bodies[body].joint.parent;
    int& block = block_of_body_[body];
    if (parent != kWorld) block = block_of_body_[parent];
    if (slot == s.slots.size() || s.slots[slot].body != static_cast<int>(body)) continue;
    if (block < 0) {
      block = static_cast<int>(blocks_.size());
      blocks_.emplace_back();
    }
    for (int i = 0; i < s.slots[slot].q_count; ++i) blocks_[block].push_back(q++);
    for (int i = 0; i < s.slots[slot].u_count; ++i) blocks_[block].push_back(u++);
    ++slot;
  }
  coupled_.resize(blocks_.size() * blocks_.size());
  colours_.resize(blocks_.size());
  motions_shifted_ = motions_;
  loads_shifted_ = loads_;
  y_shifted_.resize(quantities_.size());
  y_dot_shifted_.resize(quantities_.size());
  y_dot_begin_.resize(quantities_.size());
  shifts_.resize(quantities_.size());
}

void MultibodyModel::find_free_bodies() {
  const Simbody& s = *simbody_;
  for (const auto& slot : s.slots) {
    const Body& body = scene_.bodies[slot.body];
    const int block = block_of_body_[slot.body];
    const bool alone = std::count(block_of_body_.begin(), block_of_body_.end(), block) == 1;
    if (body.joint.type != JointType::free || !alone) {
      free_bodies_.clear();
      return;
    }
    const SimTK::Transform X_WF = s.matter.getMobilizedBody(s.bodies[slot.body]).getDefaultInboardFrame();
    free_bodies_.push_back({slot.body, block, to_eigen(X_WF), body.I_BBcm_B.inverse()});
  }
}

void MultibodyModel::place_free_bodies(const double* y, std::vector<BodyMotion>& motions) const {
  using Eigen::Map, Eigen::Vector3d;
  for (const FreeBody& free : free_bodies_) {
    const std::vector<int>& block = blocks_[free.block];
    const Body& body = scene_.bodies[free.body];
    const double* q = y + block[0];
    const double* u = y + block[7];
    const Eigen::Matrix3d R_WF = free.X_WF.linear();
    const Eigen::Matrix3d R_WB = R_WF * Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
    const Vector3d p_BBcm_W = R_WB * body.p_BBcm;
    BodyMotion& motion = motions[free.body];
    motion.X_WB.linear() = R_WB;
    motion.X_WB.translation() = free.X_WF * Vector3d(q[4], q[5], q[6]) - p_BBcm_W;
    motion.w_WB = R_WF * Map<const Vector3d>(u);
    motion.v_WB = R_WF * Map<const Vector3d>(u + 3) - motion.w_WB.cross(p_BBcm_W);
  }
}

// dy/dt by Newton's and Euler's equations.
void MultibodyModel::accelerate_free_bodies(const double* y, const std::vector<BodyMotion>& motions, const SceneLoads& loads,
                                            double* y_dot) const {
  using Eigen::Map, Eigen::Vector3d;
  for (const FreeBody& free : free_bodies_) {
    const std::vector<int>& block = blocks_[free.block];
    const Body& body = scene_.bodies[free.body];
    const BodyMotion& motion = motions[free.body];
    const BodyForce& load = loads.bodies[free.body];
    const double* q = y + block[0];
    const Map<const Vector3d> w(y + block[7]), v(y + block[10]);  // in F
    const Eigen::Matrix3d R_WB = motion.X_WB.linear(), R_FW = free.X_WF.linear().transpose();
    const double damping = body.joint.damping;
    const Vector3d t_B = R_WB.transpose() * (load.t_W - (R_WB * body.p_BBcm).cross(load.f_W) - damping * motion.w_WB);
    const Vector3d w_B = R_WB.transpose() * motion.w_WB;
    const Eigen::Quaterniond q_dot = Eigen::Quaterniond(0, w.x(), w.y(), w.z()) * Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    double* q_out = y_dot + block[0];
    q_out[0] = 0.5 * q_dot.w();
    Map<Vector3d>(q_out + 1) = 0.5 * q_dot.vec();
    Map<Vector3d>(q_out + 4) = v;
    Map<Vector3d>(y_dot + block[7]) = R_FW * (R_WB * (free.inverse_I_B * (t_B - w_B.cross(body.I_BBcm_B * w_B))));
    Map<Vector3d>(y_dot + block[10]) = R_FW * (load.f_W / body.mass + scene_.gravity) - damping / body.mass * v;
  }
  double* z_dot = y_dot + first_bristle();
  for (const contact_nn::Bristle& rate : loads.bristle_rates) z_dot = std::copy(rate.begin(), rate.end(), z_dot);
}

// dy/dt at the time of the last evaluation, where bodies with drives stay as they are then.
void MultibodyModel::free_derivative(const double* y, double* y_dot) {
  ++evaluations;
  place_free_bodies(y, motions_shifted_);
  read_bristles(y, loads_shifted_);
  forces_.evaluate(motions_shifted_, drive_now_, locks_closed_, loads_shifted_, contact_counters);
  accelerate_free_bodies(y, motions_shifted_, loads_shifted_, y_dot);
}

void MultibodyModel::find_coupling() {
  const std::size_t n = blocks_.size();
  std::fill(coupled_.begin(), coupled_.end(), false);
  for (std::size_t i = 0; i < n; ++i) coupled_[i * n + i] = true;
  const auto block_of = [&](int body) { return body == kWorld ? -1 : block_of_body_[body]; };
  const auto couple_blocks = [&](int a, int b) {
    if (a >= 0 && b >= 0) coupled_[a * n + b] = coupled_[b * n + a] = true;
  };
  const auto couple = [&](int body_a, int body_b) { couple_blocks(block_of(body_a), block_of(body_b)); };
  for (const auto& rope : scene_.ropes) couple(rope.upper.body, rope.lower.body);
  for (std::size_t i = 0; i < scene_.locks.size(); ++i) {
    if (locks_closed_[i]) couple(scene_.locks[i].body_a, scene_.locks[i].body_b);
  }
  for (std::size_t i = 0; i < scene_.pairs.size(); ++i) {
    if (!loads_.pairs[i].contact.touching) continue;
    couple(scene_.pairs[i].body_a, scene_.pairs[i].body_b);
    if (loads_.bristles.empty()) continue;
    for (const int body : {scene_.pairs[i].body_a, scene_.pairs[i].body_b}) {
      couple_blocks(block_of(body), static_cast<int>(i));
    }
  }
}

// Each block gets the first colour that no block has which a common one feels.
void MultibodyModel::colour_blocks() {
  const std::size_t n = blocks_.size();
  const auto clash = [&](std::size_t a, std::size_t b) {
    for (std::size_t i = 0; i < n; ++i) {
      if (coupled_[a * n + i] && coupled_[b * n + i]) return true;
    }
    return false;
  };
  colour_count_ = 0;
  for (std::size_t block = 0; block < n; ++block) {
    int& colour = colours_[block];
    colour = 0;
    if (block < loads_.bristles.size() && !loads_.pairs[block].contact.touching) continue;  // feels itself alone
    for (std::size_t other = 0; other < block; ++other) {
      if (colours_[other] != colour || !clash(block, other)) continue;
      ++colour;
      other = static_cast<std::size_t>(-1);  // the next colour, from the first block on
    }
    colour_count_ = std::max(colour_count_, colour + 1);
  }
}

void MultibodyModel::jacobian(double t, const double* y, const double* y_dot, double* jacobian, Columns columns) {
  if (time_ != t) evaluate(t, y);  // which bodies touch
  find_coupling();
  colour_blocks();
  const std::size_t size = quantities_.size(), n = blocks_.size();
  const auto wanted = [&](int column) {
    return columns == Columns::all || quantities_[column] == Quantity::velocity ||
           quantities_[column] == Quantity::angular_velocity;
  };
  for (std::size_t column = 0; column < size; ++column) {
    if (wanted(static_cast<int>(column))) std::fill_n(jacobian + column * size, size, 0.0);
  }
  std::copy_n(y, size, y_shifted_.begin());
  const bool all_free = !free_bodies_.empty();
  if (all_free) {
    motions_shifted_ = motions_;
    loads_shifted_ = loads_;
    free_derivative(y, y_dot_begin_.data());
    y_dot = y_dot_begin_.data();
  }
  std::size_t longest = 0;
  for (const auto& block : blocks_) longest = std::max(longest, block.size());
  for (int colour = 0; colour < colour_count_; ++colour) {
    for (std::size_t k = 0; k < longest; ++k) {  // the k-th coordinates of all blocks of this colour
      int shifted = 0;
      const auto each = [&](auto&& action) {
        for (std::size_t block = 0; block < n; ++block) {
          if (colours_[block] == colour && k < blocks_[block].size() && wanted(blocks_[block][k])) {
            action(block, blocks_[block][k]);
          }
        }
      };
      each([&](std::size_t, int column) {
        y_shifted_[column] = y[column] + kJacobianShift;
        shifts_[column] = y_shifted_[column] - y[column];  // as rounded
        ++shifted;
      });
      if (shifted == 0) continue;
      if (all_free) free_derivative(y_shifted_.data(), y_dot_shifted_.data());
      else derivative(t, y_shifted_.data(), y_dot_shifted_.data());
      each([&](std::size_t block, int column) {
        for (std::size_t other = 0; other < n; ++other) {
          if (!coupled_[block * n + other]) continue;
          for (const int row : blocks_[other]) {
            jacobian[column * size + row] = (y_dot_shifted_[row] - y_dot[row]) / shifts_[column];
          }
        }
        y_shifted_[column] = y[column];
      });
    }
  }
}

double MultibodyModel::kinetic_energy() const {
  double energy = 0;
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    if (!simbody_->bodies[i].isValid()) continue;
    const Body& body = scene_.bodies[i];
    const Eigen::Matrix3d& R_WB = motions_[i].X_WB.linear();
    const Eigen::Vector3d w_WB_B = R_WB.transpose() * motions_[i].w_WB;
    const Eigen::Vector3d v_WBcm = motions_[i].v_WB + motions_[i].w_WB.cross(R_WB * body.p_BBcm);
    energy += 0.5 * body.mass * v_WBcm.squaredNorm() + 0.5 * w_WB_B.dot(body.I_BBcm_B * w_WB_B);
  }
  return energy;
}

double MultibodyModel::potential_energy() const {
  double energy = loads_.potential_energy;
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    if (!simbody_->bodies[i].isValid()) continue;
    const Body& body = scene_.bodies[i];
    energy -= body.mass * scene_.gravity.dot(motions_[i].X_WB * body.p_BBcm);
  }
  return energy;
}

bool MultibodyModel::driven_joints_move(double t) const {
  return std::any_of(driven_.begin(), driven_.end(),
                     [&](int body) { return drive(scene_.bodies[body].joint.drive, t).rate != 0; });
}

double MultibodyModel::work_power() const {
  const double joints = !driven_joints_move(time_) ? 0 : simbody_->matter.calcMotionPower(simbody_->state);
  return loads_.rope_work_in + joints;
}

double MultibodyModel::dissipated_power() const { return loads_.dissipated_power + joint_dissipation_; }

}  // namespace quayside::harness
