#include "contact_nn/free_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace quayside::contact_nn {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using State = FreeBox::State;

constexpr double kContactTime = 0.02;   // a bounce lasts about this long [s]
constexpr double kShortestStep = 1e-9;  // [s]
constexpr double kLongestStep = 0.01;   // [s]; at 1 m/s a step of 1 cm cannot pass through a box
constexpr double kMassOfContainer = 30e3;  // [kg]
constexpr double kStartGap = 2e-3;         // [m]

// B moved along `direction` from where it is until the separation is `gap`.
Pose moved_to_gap(const Box& a, const Box& b, Pose X_AB, const Vector3d& direction, double gap) {
  const Vector3d start = X_AB.translation();
  double low = 0, high = 2 * (a.half.norm() + b.half.norm()) + start.norm();
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    X_AB.translation() = start + middle * direction;
    (separation(a, b, X_AB) < gap ? low : high) = middle;
  }
  return X_AB;
}

}  // namespace

FreeBox::FreeBox(const Box& b, double mass, Force force, double gravity)
    : half_(b.half), mass_(mass), gravity_(gravity), force_(std::move(force)) {
  const Vector3d squares = b.half.cwiseAbs2();
  inertia_ = mass / 3 * Vector3d(squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]);
}

State FreeBox::state(const Pose& X_AB, const Vector3d& v_A, const Vector3d& w_B) {
  const Quaterniond q(X_AB.linear());
  State y;
  y << X_AB.translation(), q.w(), q.vec(), v_A, w_B;
  return y;
}

Pose FreeBox::pose(const State& y) {
  Pose X = Pose::Identity();
  X.linear() = Quaterniond(y[3], y[4], y[5], y[6]).normalized().toRotationMatrix();
  X.translation() = y.head<3>();
  return X;
}

ContactForce FreeBox::contact(const State& y) const {
  const Pose X = pose(y);
  return force_(X, {X.linear() * y.tail<3>(), y.segment<3>(7)});
}

double FreeBox::energy(const State& y) const {
  const Vector3d v = y.segment<3>(7), w = y.tail<3>();
  return 0.5 * mass_ * v.squaredNorm() + 0.5 * w.dot(inertia_.cwiseProduct(w)) + mass_ * gravity_ * y[2] +
         contact(y).potential_energy;
}

State FreeBox::derivative(const State& y) const {
  const ContactForce f = contact(y);
  const Vector3d w = y.tail<3>(), p = y.head<3>();
  const Quaterniond q(y[3], y[4], y[5], y[6]), q_dot = q * Quaterniond(0, w.x(), w.y(), w.z());
  const Vector3d torque = q.normalized().conjugate() * Vector3d(f.t_A - p.cross(f.f_A));
  State d;
  d << y.segment<3>(7), 0.5 * q_dot.w(), 0.5 * q_dot.vec(), f.f_A / mass_ - gravity_ * Vector3d::UnitZ(),
      (torque - w.cross(inertia_.cwiseProduct(w))).cwiseQuotient(inertia_);
  return d;
}

// Returns the estimated error [m].
double FreeBox::step(const State& y, double h, State& next) const {
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
  const double arm = half_.maxCoeff();
  return error.head<3>().norm() + arm * error.segment<4>(3).norm() + kContactTime * error.segment<3>(7).norm() +
         arm * kContactTime * error.tail<3>().norm();
}

double FreeBox::follow(State& y, double duration, double tolerance,
                       const std::function<bool(double, const State&)>& stop) const {
  double h = 1e-4, t = 0;
  while (t < duration) {
    State next;
    h = std::min(h, duration - t);
    const double error = step(y, h, next) / tolerance;
    if (error <= 1 || h <= kShortestStep) {
      t += h;
      y = next;
      y.segment<4>(3).normalize();
      if (stop && stop(t, y)) break;
    }
    h *= std::min(5.0, std::max(0.2, 0.9 * std::pow(error + 1e-10, -0.2)));
    h = std::min(kLongestStep, std::max(kShortestStep, h));
  }
  return t;
}

Rebound rebound(const Throw& start, const FreeBox::Force& elastic, double tolerance) {
  constexpr double kLongest = 3, kAway = 5e-3, kAwayFor = 0.05;  // [s], [m], [s]
  const FreeBox box(start.b, start.mass, elastic);
  State y = FreeBox::state(start.X_AB, start.v_A, start.w_B);
  const double before = box.energy(y);
  Rebound result;
  double near_until = 0;
  box.follow(y, kLongest, tolerance, [&](double time, const State& now) {
    const double gap = separation(start.a, start.b, FreeBox::pose(now));
    result.touched |= gap < 0;
    if (gap < kAway) near_until = time;
    result.left = result.touched && time - near_until > kAwayFor;
    return result.left;
  });
  result.gain = (box.energy(y) - before) / before;
  return result;
}

Throw throw_from_anywhere(const Box& a, const Box& b, Random& random) {
  const Vector3d from = random.direction();
  Pose X = Pose::Identity();
  X.linear() = random.rotation();
  const Vector3d v = random.uniform(0.2, 1) * (-from + 0.3 * random.direction());
  return {a, b, kMassOfContainer, moved_to_gap(a, b, X, from, kStartGap), v, random.uniform(0, 0.1) * random.direction()};
}

Throw throw_down(const Box& a, const Box& b, Random& random) {
  constexpr double degree = M_PI / 180;
  const double tilt = random.uniform(0, 2.5 * degree), yaw = random.uniform(-6 * degree, 6 * degree),
               heading = random.uniform(0, 2 * M_PI);
  Pose X = Pose::Identity();
  X.linear() = (Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) *
                Eigen::AngleAxisd(tilt, Vector3d(std::cos(heading), std::sin(heading), 0))).toRotationMatrix();
  X.translation() = Vector3d(random.uniform(-2, 2), random.uniform(-0.5, 0.5), 0);
  const Vector3d v(0.1 * random.normal(), 0.1 * random.normal(), -random.uniform(0.1, 0.6));
  return {a, b, kMassOfContainer, moved_to_gap(a, b, X, Vector3d::UnitZ(), kStartGap), v,
          random.uniform(0, 0.05) * random.direction()};
}

ReboundFigures figures_of(std::vector<Rebound> bounces) {
  bounces.erase(std::remove_if(bounces.begin(), bounces.end(), [](const Rebound& b) { return !b.touched; }), bounces.end());
  ReboundFigures f;
  f.touched = static_cast<int>(bounces.size());
  std::vector<double> changes;
  for (const Rebound& b : bounces) {
    f.gained += b.gain > kNoticeable;
    f.lost += b.gain < -kNoticeable;
    f.still_near += !b.left;
    f.most_gained = std::max(f.most_gained, b.gain);
    changes.push_back(std::abs(b.gain));
  }
  if (changes.empty()) return f;
  const auto middle = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
  std::nth_element(changes.begin(), middle, changes.end());
  f.median = *middle;
  return f;
}

}  // namespace quayside::contact_nn
