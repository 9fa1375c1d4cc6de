// SUNDIALS' CVODES as this project uses it: BDF with Newton and a dense Jacobian by differences, one internal step at
// a time, with quadratures and dense output. SUNDIALS itself stays inside the .cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace quayside::harness {

// What is integrated: dy/dt = f(t, y) and quadratures dz/dt = g(t, y). The functions return false where they have no
// finite value; the integrator then tries a shorter step. Exceptions end the step and come out of it.
class OdeSystem {
 public:
  virtual ~OdeSystem() = default;
  virtual bool derivative(double t, const double* y, double* y_dot) = 0;
  virtual bool quadrature(double t, const double* y, double* z_dot) = 0;
  // The correction that takes y back onto the invariants of the system; `error`, when given, is projected alike.
  virtual void project(const double* y, double* correction, double* error) = 0;
};

// The integration cannot go on; the message says why in words.
class IntegrationFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class BdfIntegrator {
 public:
  // `tolerances`: what the local error of each component of y may be, absolutely. `max_step` 0: no bound. The system
  // must outlive this object.
  BdfIntegrator(OdeSystem& system, const std::vector<double>& tolerances, int quadratures, double max_step);
  ~BdfIntegrator();

  // Drops the history: the next step starts at order one from here. Steps depend on nothing that happened before.
  void restart(double t, const double* y, const double* z, int max_order);

  // Whether to look out for the ringing of orders three to five, which are unstable for stiff undamped oscillations,
  // and lower the order where it shows (CVODES' stability limit detection). Costs a little accuracy in smooth motion.
  void watch_stability(bool watch);

  // One internal step, not beyond `stop` (which is after `time()`). Returns the new time. After IntegrationFailed time
  // and history are those of the last good step.
  double step(double stop);

  double time() const;        // reached by the last step
  double step_begin() const;  // where the last step began: dense output reaches from there to `time()`
  void interpolate(double t, double* y, double* z) const;
  int order() const;          // of the last step

  // Counted over all restarts.
  std::uint64_t steps() const;
  std::uint64_t jacobians() const;
  std::uint64_t error_test_failures() const;

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace quayside::harness
