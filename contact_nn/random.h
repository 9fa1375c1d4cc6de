// Random numbers that are the same on every machine: the standard fixes its engines, not its distributions.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include <Eigen/Geometry>

namespace quayside::contact_nn {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  // In [0, 1), 53 random bits.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  // In [0, n), n > 0. The bias of the remainder, n / 2⁶⁴, does not matter here.
  std::uint64_t below(std::uint64_t n) { return engine_() % n; }

  double sign() { return engine_() >> 63 ? 1.0 : -1.0; }

  double normal() {  // Box and Muller
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * M_PI * uniform());
  }

  Eigen::Vector3d direction() {
    Eigen::Vector3d v;
    do v = Eigen::Vector3d(normal(), normal(), normal()); while (v.squaredNorm() < 1e-12);
    return v.normalized();
  }

  Eigen::Matrix3d rotation() {
    Eigen::Quaterniond q(normal(), normal(), normal(), normal());
    return q.normalized().toRotationMatrix();
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace quayside::contact_nn
