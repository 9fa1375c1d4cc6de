// Integrating the motion: one internal step at a time, with quadratures and dense output, whichever library does it.
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
  // ∂f/∂y at (t, y), column after column, where y_dot = f(t, y); to the few digits that Newton's iteration needs.
  virtual bool jacobian(double t, const double* y, const double* y_dot, double* jacobian) = 0;
  // The correction that takes y back onto the invariants of the system; `error`, when given, is projected alike.
  virtual void project(const double* y, double* correction, double* error) = 0;
};

// The integration cannot go on; the message says why in words.
class IntegrationFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct IntegratorSettings {
  std::vector<double> tolerances;  // what the local error of each component of y may be, absolutely
  int quadratures = 0;             // components of z, which take no part in the choice of steps
  double max_step = 0;             // 0: no bound
  std::vector<std::vector<int>> blocks{};  // components of y that belong to one body; see BlockLu
};

class Integrator {
 public:
  static constexpr int kHighestOrder = 5;

  virtual ~Integrator() = default;

  // Drops the history: the next step starts from here and depends on nothing that happened before. `max_order`, from 1
  // to kHighestOrder, is for those whose order varies.
  virtual void restart(double t, const double* y, const double* z, int max_order) = 0;

  // Whether to look out for the ringing of BDF of orders three to five, which are unstable for stiff undamped
  // oscillations, and lower the order where it shows. Costs a little accuracy in smooth motion.
  virtual void watch_stability(bool) {}

  // The next step begins with a new Jacobian. Returns whether it does.
  virtual bool renew_jacobian() { return false; }

  // One internal step, not beyond `stop` (which is after `time()`). Returns the new time. After IntegrationFailed time
  // and history are those of the last good step.
  virtual double step(double stop) = 0;

  virtual double time() const = 0;        // reached by the last step
  virtual double step_begin() const = 0;  // where the last step began: dense output reaches from there to `time()`
  virtual void interpolate(double t, double* y, double* z) const = 0;

  // Counted over all restarts.
  virtual std::uint64_t steps() const = 0;
  virtual std::uint64_t jacobians() const { return 0; }
};

// By name:
//   bdf       CVODES, backward differences of order one to five, Newton: stiff and smooth motion alike; the default
//   adams     CVODES, Adams-Moulton of order one to twelve, fixed-point iteration: smooth motion that is not stiff
//   erk       ARKODE, the explicit Runge-Kutta method of Dormand and Prince, order five
//   dirk      ARKODE, a diagonally implicit, L-stable Runge-Kutta method of order four, Newton
//   merson, feldberg, rk3   Simbody's explicit Runge-Kutta methods of order four, five and three
//   cpodes    Simbody's own BDF, Newton
// The semi-explicit methods of Simbody (Verlet, Euler) are left out: they take forces for functions of position, and
// friction and damping depend on velocity.
//
// The system must outlive the integrator. Throws std::invalid_argument for another name.
std::unique_ptr<Integrator> make_integrator(const std::string& name, OdeSystem& system,
                                            const IntegratorSettings& settings);

}  // namespace quayside::harness
