// A free 40 ft box of 30 t on a fixed one under the law `learned`: bounces and rest.
#include <cmath>

#include <gtest/gtest.h>

#include "contact_nn/learned_potential.h"
#include "contact_nn/random.h"
#include "contact_nn/separating_axes.h"
#include "tests/unit/contact_nn/poses.h"

namespace quayside::contact_nn {
namespace {

using Eigen::Vector3d;
using test::kContainer;
using test::pose;

constexpr double kMass = 30e3, kGravity = 9.80665;
const Vector3d kSquares = kContainer.half.cwiseAbs2();
const Vector3d kInertia = kMass / 3 * Vector3d(kSquares[1] + kSquares[2], kSquares[0] + kSquares[2], kSquares[0] + kSquares[1]);

// Position, quaternion (w, x, y, z), velocity in the fixed box A; angular velocity in the free box B.
using State = Eigen::Matrix<double, 13, 1>;

class FreeBox {
 public:
  FreeBox(const ContactSettings& settings, double gravity) : module_(make_contact_module(settings)), gravity_(gravity) {}

  static Pose pose_of(const State& y) {
    return pose(y.segment<3>(0), Eigen::Quaterniond(y[3], y[4], y[5], y[6]).normalized().toRotationMatrix());
  }

  ContactForce contact(const State& y) const {
    const Pose X = pose_of(y);
    RelativeVelocity V;
    V.v_A = y.segment<3>(7);
    V.w_A = X.linear() * y.segment<3>(10);
    ContactCounters counters;
    return module_->force(kContainer, kContainer, X, V, counters);
  }

  State derivative(const State& y) const {
    const Pose X = pose_of(y);
    const ContactForce f = contact(y);
    const Vector3d w = y.segment<3>(10), p = y.segment<3>(0);
    const Vector3d torque = X.linear().transpose() * (f.t_A - p.cross(f.f_A));
    const Eigen::Quaterniond q_dot = Eigen::Quaterniond(y[3], y[4], y[5], y[6]) * Eigen::Quaterniond(0, w[0], w[1], w[2]);
    State d;
    d << y.segment<3>(7), 0.5 * q_dot.w(), 0.5 * q_dot.vec(), f.f_A / kMass - gravity_ * Vector3d::UnitZ(),
        (torque - w.cross(kInertia.cwiseProduct(w))).cwiseQuotient(kInertia);
    return d;
  }

  void step(State& y, double h) const {  // Runge and Kutta, order 4
    const State k1 = derivative(y), k2 = derivative(y + 0.5 * h * k1), k3 = derivative(y + 0.5 * h * k2),
                k4 = derivative(y + h * k3);
    y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    y.segment<4>(3).normalize();
  }

  double energy(const State& y) const {
    const Vector3d v = y.segment<3>(7), w = y.segment<3>(10);
    return 0.5 * kMass * v.squaredNorm() + 0.5 * w.dot(kInertia.cwiseProduct(w)) + kMass * gravity_ * y[2] +
           contact(y).potential_energy;
  }

 private:
  std::unique_ptr<ContactModule> module_;
  double gravity_;
};

// Starts over the whole domain of the network and beyond, so that some cross the seam while they rock. What is gained or lost
// is the integrator's: 6e-4 with these steps, 2e-4 with half of them; a network in double precision makes no difference.
// The limit is what a simulation may not notice.
TEST(LearnedPotentialBounces, AThousandElasticBouncesGainNoEnergy) {
  ContactSettings settings;
  settings.model = Model::exact;
  settings.law = Law::learned;
  settings.friction = 0;
  settings.restitution = 1;
  const FreeBox box(settings, 0);
  constexpr double kStep = 5e-5;  // [s]
  constexpr int kSteps = 4000;    // 0.2 s: several contacts of 20 ms
  Random random(1);
  double most = 0;
  int touched = 0;
  for (int i = 0; i < 1000; ++i) {
    const double tilt = random.uniform(0, 2.5) * M_PI / 180, yaw = random.uniform(-6, 6) * M_PI / 180,
                 heading = random.uniform(0, 2 * M_PI);
    const Eigen::Matrix3d R = test::rotation(yaw, Vector3d::UnitZ()) *
                              test::rotation(tilt, Vector3d(std::cos(heading), std::sin(heading), 0));
    const Pose X = test::at_depth(kContainer, kContainer,
                                  pose({random.uniform(-2, 2), random.uniform(-0.5, 0.5), 0}, R), Vector3d::UnitZ(), -1e-3);
    const Eigen::Quaterniond q(X.linear());
    const Vector3d v(0.1 * random.normal(), 0.1 * random.normal(), -random.uniform(0.1, 0.6)),
        w = random.uniform(0, 0.05) * random.direction();
    State y;
    y << X.translation(), q.w(), q.vec(), v, w;
    const double start = box.energy(y);
    bool touching = false;
    for (int k = 0; k < kSteps; ++k) {
      box.step(y, kStep);
      touching |= k % 10 == 0 && separation(kContainer, kContainer, FreeBox::pose_of(y)) < 0;
    }
    touched += touching;
    most = std::max(most, std::abs(box.energy(y) - start) / start);
  }
  RecordProperty("largest_change", std::to_string(most));
  EXPECT_GT(touched, 900);
  EXPECT_LT(most, 1e-3);
}

// Set down, offset by 30/20 mm and at rest for 20 s. Sideways force is F_x/F times the load, and friction creeps under it at
// v_t0 F_x/(μ N): 2 µm in 20 s are F_x = 4e-5 of the load.
TEST(LearnedPotentialRest, ABoxAtRestDoesNotSlide) {
  ContactSettings settings;
  settings.model = Model::exact;
  settings.law = Law::learned;
  const FreeBox box(settings, kGravity);
  State y;
  y << 0.03, 0.02, 2 * kContainer.half.z() - 4.9e-4, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0;
  const double h = 2e-4;  // friction's own rate is μ g/v_t0 = 3900/s
  for (int i = 0; i < 10000; ++i) box.step(y, h);
  const Vector3d settled = y.segment<3>(0);
  for (int i = 0; i < 100000; ++i) box.step(y, h);
  const double slide = (y.segment<3>(0) - settled).head<2>().norm(), sink = std::abs(y[2] - settled[2]);
  RecordProperty("slide", std::to_string(slide * 1e6) + " um");
  EXPECT_LT(slide, 2e-6);
  EXPECT_LT(sink, 1e-6);
}

}  // namespace
}  // namespace quayside::contact_nn
