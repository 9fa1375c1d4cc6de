#include "contact_nn/restitution.h"

#include <cassert>
#include <cmath>

namespace quayside::contact_nn {
namespace {

// Bisection halves until neighbouring doubles: 64 steps for one binade, some more to find it.
constexpr int kBisections = 200;

// Root of an increasing function of one sign change in (low, high).
template <class Function>
double bisect(Function f, double low, double high) {
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// ln[(1 + x)/(1 − x e)] − x (1 + e): negative between 0 and the root, since it begins as −(1 − e²) x²/2, and +∞ as
// x e → 1. For small x the leading terms cancel, so they are summed as a series: Σ_{k≥2} x^k (e^k − (−1)^k)/k.
double mismatch(double x, double e) {
  if (x > 0.01) return std::log1p(x) - std::log1p(-x * e) - x * (1 + e);
  double sum = 0, power_x = x, power_e = e, sign = 1;
  for (int k = 2; k < 12; ++k) {  // x^12 < 1e-24
    power_x *= x;
    power_e *= e;
    sum += power_x * (power_e - sign) / k;
    sign = -sign;
  }
  return sum;
}

}  // namespace

double damping_for(double restitution, double speed) {
  assert(restitution > 0 && restitution <= 1 && speed > 0);
  if (restitution == 1) return 0;
  return bisect([=](double x) { return mismatch(x, restitution); }, 0, 1 / restitution) / speed;
}

double restitution_of(double damping, double speed) {
  assert(damping >= 0 && speed >= 0);
  const double x = damping * speed;
  if (x == 0) return 1;
  return bisect([=](double e) { return mismatch(x, e); }, 0, std::fmin(1, 1 / x));
}

}  // namespace quayside::contact_nn
