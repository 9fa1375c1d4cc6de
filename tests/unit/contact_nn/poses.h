// Boxes and poses that the contact tests share.
#pragma once

#include <random>

#include "contact_nn/contact.h"

namespace quayside::contact_nn::test {

inline const Box kContainer{{6.096, 1.219, 1.2955}};  // 40 ft
inline const Box kCube{{0.5, 0.5, 0.5}};
inline const Box kSlab{{3.0, 1.2, 0.05}};
inline const Box kGround{{50, 50, 0.5}};
inline const Box kNeedle{{2.0, 0.02, 0.03}};

inline Pose pose(const Eigen::Vector3d& p, const Eigen::Matrix3d& R = Eigen::Matrix3d::Identity()) {
  Pose X = Pose::Identity();
  X.linear() = R;
  X.translation() = p;
  return X;
}

inline Eigen::Matrix3d rotation(double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  double log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  Eigen::Vector3d direction() {
    std::normal_distribution<double> normal;
    return Eigen::Vector3d(normal(engine_), normal(engine_), normal(engine_)).normalized();
  }
  Eigen::Matrix3d rotation() {
    std::normal_distribution<double> normal;
    return Eigen::Quaterniond(normal(engine_), normal(engine_), normal(engine_), normal(engine_))
        .normalized()
        .toRotationMatrix();
  }

 private:
  std::mt19937_64 engine_;
};

// Moves B along `direction` from A's centre to where the largest separation is −depth.
inline Pose at_depth(const Box& a, const Box& b, Pose X_AB, const Eigen::Vector3d& direction, double depth) {
  const Eigen::Vector3d start = X_AB.translation();
  double low = 0, high = 2 * (a.half.norm() + b.half.norm()) + start.norm();
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    X_AB.translation() = start + middle * direction;
    (separation(a, b, X_AB) < -depth ? low : high) = middle;
  }
  return X_AB;
}

}  // namespace quayside::contact_nn::test
