// A free 40 ft box thrown elastically and without friction against a fixed one: does it come back with more energy?
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "contact_nn/potential_law.h"
#include "tests/unit/contact_nn/poses.h"

namespace quayside::contact_nn {
namespace {

using namespace test;
using Eigen::Vector3d;

constexpr double kMass = 30e3;
const LawParameters kElastic{6e8, 0, 0, 1e-3};

// Position, quaternion (w, x, y, z), velocity in the fixed box A; angular velocity in the free box B.
using State = Eigen::Matrix<double, 13, 1>;

const Vector3d kInertia = kMass / 3 *
                          Vector3d(kContainer.half.y() * kContainer.half.y() + kContainer.half.z() * kContainer.half.z(),
                                   kContainer.half.x() * kContainer.half.x() + kContainer.half.z() * kContainer.half.z(),
                                   kContainer.half.x() * kContainer.half.x() + kContainer.half.y() * kContainer.half.y());

Pose pose_of(const State& y) {
  return pose(y.segment<3>(0), Eigen::Quaterniond(y[3], y[4], y[5], y[6]).normalized().toRotationMatrix());
}

State derivative(const State& y) {
  const Pose X = pose_of(y);
  const ContactForce f = potential_force(kContainer, kContainer, X, {}, kElastic);
  const Vector3d w = y.segment<3>(10), p = y.segment<3>(0);
  const Vector3d torque = X.linear().transpose() * (f.t_A - p.cross(f.f_A));
  const Eigen::Quaterniond q(y[3], y[4], y[5], y[6]), spin(0, w.x(), w.y(), w.z());
  const Eigen::Quaterniond q_dot = q * spin;
  State d;
  d << y.segment<3>(7), 0.5 * q_dot.w(), 0.5 * q_dot.vec(), f.f_A / kMass,
      (torque - w.cross(kInertia.cwiseProduct(w))).cwiseQuotient(kInertia);
  return d;
}

double energy(const State& y) {
  const Vector3d v = y.segment<3>(7), w = y.segment<3>(10);
  return 0.5 * kMass * v.squaredNorm() + 0.5 * w.dot(kInertia.cwiseProduct(w)) +
         potential_force(kContainer, kContainer, pose_of(y), {}, kElastic).potential_energy;
}

// One step of Dormand and Prince's pair of orders 5 and 4; returns the error estimate, weighted to lengths in m.
double dormand_prince(const State& y, double h, State& next) {
  std::array<State, 7> k;
  k[0] = derivative(y);
  k[1] = derivative(y + h * (k[0] / 5));
  k[2] = derivative(y + h * (3. / 40 * k[0] + 9. / 40 * k[1]));
  k[3] = derivative(y + h * (44. / 45 * k[0] - 56. / 15 * k[1] + 32. / 9 * k[2]));
  k[4] = derivative(y + h * (19372. / 6561 * k[0] - 25360. / 2187 * k[1] + 64448. / 6561 * k[2] - 212. / 729 * k[3]));
  k[5] = derivative(y + h * (9017. / 3168 * k[0] - 355. / 33 * k[1] + 46732. / 5247 * k[2] + 49. / 176 * k[3] -
                             5103. / 18656 * k[4]));
  next = y + h * (35. / 384 * k[0] + 500. / 1113 * k[2] + 125. / 192 * k[3] - 2187. / 6784 * k[4] + 11. / 84 * k[5]);
  k[6] = derivative(next);
  const State error = h * (71. / 57600 * k[0] - 71. / 16695 * k[2] + 71. / 1920 * k[3] - 17253. / 339200 * k[4] +
                           22. / 525 * k[5] - 1. / 40 * k[6]);
  // A contact lasts some 20 ms: speeds count by that, angles by the box' half length.
  constexpr double kDuration = 0.02, kArm = 6;
  const double angle = kArm * error.segment<4>(3).norm(), turn = kArm * kDuration * error.segment<3>(10).norm();
  return error.segment<3>(0).norm() + angle + kDuration * error.segment<3>(7).norm() + turn;
}

// Follows a box until it has left: apart by 5 mm and not touching for a while. Returns the energy gained, over the energy at
// the start, and whether there was a contact at all.
struct Bounce {
  bool touched;
  double gain;
};
Bounce bounce(State y, double tolerance) {
  constexpr double kLongest = 3.0, kLargestStep = 0.01;  // [s]; at 1 m/s a step of 1 cm cannot pass through a box
  const double start = energy(y);
  double h = 1e-4, free_since = 0;
  bool touched = false;
  for (double t = 0; t < kLongest && !(touched && t - free_since > 0.05);) {
    State next;
    const double error = dormand_prince(y, h, next) / tolerance;
    if (error <= 1) {
      t += h;
      y = next;
      y.segment<4>(3).normalize();
      if (separation(kContainer, kContainer, pose_of(y)) < 5e-3) {
        touched |= separation(kContainer, kContainer, pose_of(y)) < 0;
        free_since = t;
      }
    }
    h = std::min(kLargestStep, h * std::min(5.0, std::max(0.2, 0.9 * std::pow(error + 1e-10, -0.2))));
  }
  return {touched, (energy(y) - start) / start};
}

State random_start(Random& random) {
  const Vector3d from = random.direction();
  const Pose X = at_depth(kContainer, kContainer, pose({0, 0, 0}, random.rotation()), from, -2e-3);
  const Eigen::Quaterniond q(X.linear());
  const Vector3d v = random.uniform(0.2, 1) * (-from + 0.3 * random.direction()), w = random.uniform(0, 0.1) * random.direction();
  State y;
  y << X.translation(), q.w(), q.vec(), v, w;
  return y;
}

// The force is the gradient of a potential, so only the integrator can make energy: what is gained or lost must fall with its
// tolerance. It does: at most 1.5e-5 of the start at 1e-9 m per step, 6e-7 at 1e-11 m. A law that makes energy would not
// care; the limit that matters to a simulation is 1e-3.
TEST(Bounces, AThousandElasticBouncesGainNoEnergy) {
  constexpr int kBounces = 1000;
  const auto largest_change = [](double tolerance) {
    Random random(20240501);
    int touched = 0;
    double largest = 0;
    for (int i = 0; i < kBounces; ++i) {
      const Bounce b = bounce(random_start(random), tolerance);
      touched += b.touched;
      largest = std::max(largest, std::abs(b.gain));
    }
    EXPECT_GT(touched, 0.95 * kBounces);
    return largest;
  };
  const double coarse = largest_change(1e-9), fine = largest_change(1e-11);
  RecordProperty("largest_change", std::to_string(fine));
  EXPECT_LT(fine, 1e-5);
  EXPECT_LT(fine, coarse / 5);
}

}  // namespace
}  // namespace quayside::contact_nn
