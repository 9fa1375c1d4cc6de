#include "contact_nn/bounces.h"

#include <algorithm>
#include <cmath>

#include "contact_nn/random.h"

namespace quayside::contact_nn {

using Eigen::Vector3d;

const Box kBounceBox{{6.096, 1.219, 1.2955}};

namespace {

constexpr double kMass = 30e3;                                 // [kg]
constexpr double kLongest = 3.0, kFreeFor = 0.05;              // [s]
constexpr double kLargestStep = 0.01, kSmallestStep = 1e-7;    // [s]; at 1 m/s a step of 1 cm cannot pass through a box
constexpr double kAway = 5e-3, kStart = 2e-3;                  // gaps [m]

Vector3d inertia() {
  const Vector3d squared = kBounceBox.half.cwiseAbs2();
  return kMass / 3 * (Vector3d::Constant(squared.sum()) - squared);
}
const Vector3d kInertia = inertia();

Pose pose_of(const BounceState& y) {
  Pose X = Pose::Identity();
  X.linear() = Eigen::Quaterniond(y[3], y[4], y[5], y[6]).normalized().toRotationMatrix();
  X.translation() = y.segment<3>(0);
  return X;
}

BounceState derivative(const BounceState& y, const ElasticLaw& law) {
  const Pose X = pose_of(y);
  const Wrench on_b = law(X);
  const Vector3d w = y.segment<3>(10), p = y.segment<3>(0);
  const Vector3d torque = X.linear().transpose() * (on_b.t_A - p.cross(on_b.f_A));
  const Eigen::Quaterniond q(y[3], y[4], y[5], y[6]), spin(0, w.x(), w.y(), w.z());
  const Eigen::Quaterniond q_dot = q * spin;
  BounceState d;
  d << y.segment<3>(7), 0.5 * q_dot.w(), 0.5 * q_dot.vec(), on_b.f_A / kMass,
      (torque - w.cross(kInertia.cwiseProduct(w))).cwiseQuotient(kInertia);
  return d;
}

double kinetic_energy(const BounceState& y) {
  const Vector3d v = y.segment<3>(7), w = y.segment<3>(10);
  return 0.5 * kMass * v.squaredNorm() + 0.5 * w.dot(kInertia.cwiseProduct(w));
}

// One step; returns the error estimate, weighted to lengths in m.
double dormand_prince(const BounceState& y, double h, const ElasticLaw& law, BounceState& next) {
  std::array<BounceState, 7> k;
  k[0] = derivative(y, law);
  k[1] = derivative(y + h * (k[0] / 5), law);
  k[2] = derivative(y + h * (3. / 40 * k[0] + 9. / 40 * k[1]), law);
  k[3] = derivative(y + h * (44. / 45 * k[0] - 56. / 15 * k[1] + 32. / 9 * k[2]), law);
  k[4] = derivative(
      y + h * (19372. / 6561 * k[0] - 25360. / 2187 * k[1] + 64448. / 6561 * k[2] - 212. / 729 * k[3]), law);
  k[5] = derivative(y + h * (9017. / 3168 * k[0] - 355. / 33 * k[1] + 46732. / 5247 * k[2] + 49. / 176 * k[3] -
                             5103. / 18656 * k[4]), law);
  next = y + h * (35. / 384 * k[0] + 500. / 1113 * k[2] + 125. / 192 * k[3] - 2187. / 6784 * k[4] + 11. / 84 * k[5]);
  k[6] = derivative(next, law);
  const BounceState error = h * (71. / 57600 * k[0] - 71. / 16695 * k[2] + 71. / 1920 * k[3] - 17253. / 339200 * k[4] +
                                 22. / 525 * k[5] - 1. / 40 * k[6]);
  // A contact lasts some 20 ms: speeds count by that, angles by the box' half length.
  constexpr double kDuration = 0.02, kArm = 6;
  const double angle = kArm * error.segment<4>(3).norm(), turn = kArm * kDuration * error.segment<3>(10).norm();
  return error.segment<3>(0).norm() + angle + kDuration * error.segment<3>(7).norm() + turn;
}

}  // namespace

BounceState random_bounce_start(std::uint64_t seed) {
  Random random(seed);
  const Vector3d from = random.direction();
  const Eigen::Quaterniond q(random.rotation());
  BounceState y;
  y << Vector3d::Zero(), q.w(), q.vec(), Vector3d::Zero(), Vector3d::Zero();
  double low = 0, high = 4 * kBounceBox.half.norm();
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    y.segment<3>(0) = middle * from;
    (separation(kBounceBox, kBounceBox, pose_of(y)) < kStart ? low : high) = middle;
  }
  y.segment<3>(7) = random.uniform(0.2, 1) * (-from + 0.3 * random.direction());
  y.segment<3>(10) = random.uniform(0, 0.1) * random.direction();
  return y;
}

Bounce bounce(const BounceState& start, const ElasticLaw& law, double tolerance) {
  Bounce result;
  BounceState y = start;
  double h = 1e-4, free_since = 0, gap = kStart;
  for (double t = 0; t < kLongest && !(result.touched && t - free_since > kFreeFor);) {
    BounceState next;
    const double error = dormand_prince(y, h, law, next) / tolerance;
    result.evaluations += 7;
    if (error <= 1 || h <= kSmallestStep) {
      t += h;
      y = next;
      y.segment<4>(3).normalize();
      gap = separation(kBounceBox, kBounceBox, pose_of(y));
      if (gap < kAway) {
        result.touched |= gap < 0;
        free_since = t;
      }
    }
    h = std::clamp(h * std::clamp(0.9 * std::pow(error + 1e-10, -0.2), 0.2, 5.0), kSmallestStep, kLargestStep);
  }
  result.finished = gap > 0;
  const double energy = kinetic_energy(start);
  result.gain = (kinetic_energy(y) - energy) / energy;
  return result;
}

void BounceTrials::add(const Bounce& b) {
  ++bounces;
  evaluations += b.evaluations;
  touched += b.touched;
  unfinished += b.touched && !b.finished;
  if (!b.finished) return;
  gained += b.gain > kBounceGain;
  most_gained = std::max(most_gained, b.gain);
  most_lost = std::max(most_lost, -b.gain);
}

}  // namespace quayside::contact_nn
