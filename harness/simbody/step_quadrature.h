// Quadratures along the steps of a method that knows none: Simpson's rule, two evaluations a step, order four; between
// the ends of a step the cubic through values and rates there.
#pragma once

#include <cassert>
#include <functional>
#include <vector>

#include "harness/simbody/integrator.h"

namespace quayside::harness {

// Weights of the cubic through values and rates at the ends of a step of length h, at the fraction s of it:
// value_begin · w[0] + rate_begin · w[1] + value_end · w[2] + rate_end · w[3].
struct HermiteWeights {
  double w[4];
  HermiteWeights(double s, double h)
      : w{(1 + 2 * s) * (1 - s) * (1 - s), h * s * (1 - s) * (1 - s), s * s * (3 - 2 * s), h * s * s * (s - 1)} {}
};

class StepQuadrature {
 public:
  StepQuadrature(OdeSystem& system, int count)
      : system_(system), z_(count), z_begin_(count), rate_(count), rate_begin_(count), rate_middle_(count) {}

  void restart(double t, const double* y, const double* z) {
    z_.assign(z, z + z_.size());
    z_begin_ = z_;
    time_ = begin_ = t;
    evaluate(t, y, rate_);
  }

  // Over the step from the last one's end to t; `y_middle` and `y` are there at half of it and at its end.
  void advance(double t, const double* y_middle, const double* y) {
    begin_ = time_;
    time_ = t;
    z_begin_ = z_;
    rate_begin_.swap(rate_);
    evaluate(0.5 * (begin_ + time_), y_middle, rate_middle_);
    evaluate(time_, y, rate_);
    for (std::size_t i = 0; i < z_.size(); ++i) {
      z_[i] += (time_ - begin_) / 6 * (rate_begin_[i] + 4 * rate_middle_[i] + rate_[i]);
    }
  }

  void interpolate(double t, double* z) const {
    const double h = time_ - begin_;
    const HermiteWeights hermite(h > 0 ? (t - begin_) / h : 1, h);
    for (std::size_t i = 0; i < z_.size(); ++i) {
      z[i] = hermite.w[0] * z_begin_[i] + hermite.w[1] * rate_begin_[i] + hermite.w[2] * z_[i] +
             hermite.w[3] * rate_[i];
    }
  }

 private:
  void evaluate(double t, const double* y, std::vector<double>& rate) {
    if (!system_.quadrature(t, y, rate.data())) throw IntegrationFailed("forces or accelerations are not finite");
  }

  OdeSystem& system_;
  std::vector<double> z_, z_begin_, rate_, rate_begin_, rate_middle_;
  double begin_ = 0, time_ = 0;
};

}  // namespace quayside::harness
