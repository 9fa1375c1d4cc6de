// Times at which a recorded signal passes zero upwards.
#pragma once

#include <vector>

namespace quayside::harness {

// Cubic Hermite interpolation between the samples, from values and rates: its error, h⁴/384 times the fourth
// derivative, is 1e-12 of the amplitude for a pendulum of 10 s sampled every 10 ms.
class ZeroCrossings {
 public:
  void add(double time, double value, double rate) {
    if (has_last_ && value_ < 0 && value >= 0) times_.push_back(root(time, value, rate));
    time_ = time;
    value_ = value;
    rate_ = rate;
    has_last_ = true;
  }
  const std::vector<double>& times() const { return times_; }
  // Mean over all whole periods seen.
  double period() const { return (times_.back() - times_.front()) / static_cast<double>(times_.size() - 1); }

 private:
  double root(double time, double value, double rate) const {
    const double h = time - time_;
    const auto at = [&](double s) {
      const double r = 1 - s;
      return r * r * ((1 + 2 * s) * value_ + s * h * rate_) + s * s * ((3 - 2 * s) * value - r * h * rate);
    };
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (at(middle) < 0 ? low : high) = middle;
    }
    return time_ + h * low;
  }
  bool has_last_ = false;
  double time_ = 0, value_ = 0, rate_ = 0;
  std::vector<double> times_;
};

}  // namespace quayside::harness
