// The linear two-mass oscillator: what can be known in closed form about cutting a system in two.
//
//   wall ──[k1, c1]── m1 ──[k, c]── m2
//
// It is cut in one of two ways:
//   displacement_force  left: m1 with the wall's spring, moved by a force, tells its motion; right: m2 with the spring
//                       between the masses, moved by that motion, tells the force, which follows from the motion at once
//   force_force         left and right: a mass each, moved by a force; spring: without state, motions in, forces out at
//                       once
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "harness/coupling/linear_unit.h"
#include "harness/master.h"

namespace quayside::harness {

enum class Cut { displacement_force, force_force };
const char* to_string(Cut cut);

struct TwoMassOscillator {
  double m1 = 2, m2 = 1;     // [kg]
  double k1 = 50, c1 = 0.2;  // to the wall [N/m], [N s/m]
  double k = 200, c = 2;     // between the masses
  Eigen::Vector4d start{0.1, 0, 0, 0};  // x1, v1, x2, v2 [m, m/s]; springs are at ease at 0

  Eigen::Matrix4d dynamics() const;         // z' = dynamics z
  Eigen::Vector4d at(double t) const;       // the exact solution: exp(dynamics t) start
};

// The units of a cut, ready to be stepped by `master`.
class CutOscillator {
 public:
  CutOscillator(const TwoMassOscillator& oscillator, Cut cut, const MasterSettings& settings);

  Master& master() { return master_; }
  Eigen::Vector4d state() const;    // x1, v1, x2, v2
  std::size_t unit_steps() const;   // of all units, those taken back as well

 private:
  std::vector<std::unique_ptr<LinearUnit>> units_;
  Master master_;
};

// What a macro step of h seconds makes of the state z = (x1, v1, x2, v2), by theory. With Φ and G from the exact steps of the
// masses with held inputs,
//   jacobi        z' = (Φ + G) z
//   gauss_seidel  the same, but that the right side holds what the left side has come to
//   iterated      z' = Φ z + G (z + z')/2, for the iteration that has converged
// Throws std::invalid_argument for another method.
Eigen::Matrix4d macro_step(const TwoMassOscillator& oscillator, Cut cut, const std::string& method, double h);

// By what the error of the force shrinks in every round of the iteration (above 1 in magnitude: it grows), without
// relaxation; with relaxation r it is 1 − r (1 − factor).
double iteration_factor(const TwoMassOscillator& oscillator, Cut cut, double h);

// The longest macro step [s] below which every step is stable: no eigenvalue of the macro step beyond 1. `longest` where all
// are stable up to there.
double stability_limit(const TwoMassOscillator& oscillator, Cut cut, const std::string& method, double longest);

}  // namespace quayside::harness
