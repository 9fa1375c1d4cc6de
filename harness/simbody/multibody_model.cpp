#include "harness/simbody/multibody_model.h"

#include <cassert>
#include <cmath>

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
                               std::shared_ptr<const contact_nn::ContactModule> contact)
    : scene_(scene),
      forces_(scene, std::move(contact)),
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
    if (rope.drive >= 0 && rope.rest_length + drive(rope.drive, t).value < kShortestRope) return static_cast<int>(i);
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
}

void MultibodyModel::evaluate(double t, const double* y) {
  Simbody& s = *simbody_;
  ++evaluations;
  time_ = t;
  for (std::size_t i = 0; i < drives_.size(); ++i) drive_now_[i] = drive(static_cast<int>(i), t);

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
  forces_.evaluate(motions_, drive_now_, locks_closed_, loads_, contact_counters);

  joint_dissipation_ = 0;
  for (const auto& slot : s.slots) {
    const double damping = scene_.bodies[slot.body].joint.damping;
    if (damping == 0) continue;
    for (int i = 0; i < slot.u_count; ++i) joint_dissipation_ += damping * u[slot.u + i] * u[slot.u + i];
  }
}

void MultibodyModel::derivative(double t, const double* y, double* y_dot) {
  evaluate(t, y);
  Simbody& s = *simbody_;
  s.system.realize(s.state, SimTK::Stage::Acceleration);
  const SimTK::Vector& q_dot = s.state.getQDot();
  const SimTK::Vector& u_dot = s.state.getUDot();
  for (const int q : s.y_to_q) *y_dot++ = q_dot[q];
  for (const int u : s.y_to_u) *y_dot++ = u_dot[u];
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

double MultibodyModel::work_power() const {
  const double joints = driven_.empty() ? 0 : simbody_->matter.calcMotionPower(simbody_->state);
  return loads_.rope_work_in + joints;
}

double MultibodyModel::dissipated_power() const { return loads_.dissipated_power + joint_dissipation_; }

}  // namespace quayside::harness
