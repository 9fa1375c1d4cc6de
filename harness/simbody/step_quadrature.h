// Quadratures along the steps of a method that knows none: Simpson's rule, two evaluations a step, order four; between
// the ends of a step the cubic through values and rates there.
#pragma once

#include <cassert>
#include <functional>
#include <vector>

#include "harness/simbody/integrator.h"

namespace quayside::harness {

// A step's ends: values and rates there.
struct StepEnds {
  double t_begin, t_end;
  const std::vector<double>&begin, &rate_begin, &end, &rate_end;
};

// The cubic through them at t, as Simbody's own interpolation is.
inline void interpolate_cubic(const StepEnds& step, double t, double* out) {
  const double h = step.t_end - step.t_begin, s = h > 0 ? (t - step.t_begin) / h : 1;
  const double w_begin = (1 + 2 * s) * (1 - s) * (1 - s), w_rate_begin = h * s * (1 - s) * (1 - s);
  const double w_end = s * s * (3 - 2 * s), w_rate_end = h * s * s * (s - 1);
  for (std::size_t i = 0; i < step.end.size(); ++i) {
    out[i] = w_begin * step.begin[i] + w_rate_begin * step.rate_begin[i] + w_end * step.end[i] +
             w_rate_end * step.rate_end[i];
  }
}

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
    interpolate_cubic({begin_, time_, z_begin_, rate_begin_, z_, rate_}, t, z);
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
