// A system with a known solution, for integrators.
#pragma once

#include <stdexcept>

#include "harness/simbody/integrator.h"

namespace quayside::harness {

// x'' = −x from x = 1: x = cos t, and ∫x dt = sin t. `broken_after`: no finite value beyond; `thrown_after`: a mistake.
class Oscillator final : public OdeSystem {
 public:
  double broken_after = 1e9, thrown_after = 1e9;

  bool derivative(double t, const double* y, double* y_dot) override {
    if (t > thrown_after) throw std::logic_error("a mistake");
    y_dot[0] = y[1];
    y_dot[1] = -y[0];
    return t <= broken_after;
  }
  bool quadrature(double, const double* y, double* z_dot) override {
    z_dot[0] = y[0];
    return true;
  }
  bool jacobian(double, const double*, const double*, double* jacobian) override {
    jacobian[0] = jacobian[3] = 0;
    jacobian[1] = -1;
    jacobian[2] = 1;
    return true;
  }
  void project(const double*, double* correction, double*) override { correction[0] = correction[1] = 0; }
};

}  // namespace quayside::harness
