// A free 40 ft box thrown elastically and without friction against a fixed one: does it come back with more energy?
// `quayside contact energy` is the long version, over all laws.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "contact_nn/free_box.h"
#include "contact_nn/potential_law.h"
#include "tests/unit/contact_nn/poses.h"

namespace quayside::contact_nn {
namespace {

using test::kContainer;

ContactForce potential(const Pose& X_AB, const RelativeVelocity&) {
  return potential_force(kContainer, kContainer, X_AB, {}, {6e8, 0, 0, 1e-3});
}

std::vector<Rebound> rebounds(int count, const FreeBox::Force& law, double tolerance) {
  std::vector<Rebound> all;
  Random random(20240501);
  for (int i = 0; i < count; ++i) all.push_back(rebound(throw_from_anywhere(kContainer, kContainer, random), law, tolerance));
  return all;
}

// The force is the gradient of a potential, so only the integrator can make energy: what is gained or lost must fall with
// its tolerance. It does: at most some 1e-5 of the start at 1e-9 m per step, less than 1e-6 at 1e-11 m. A law that makes
// energy would not care; the limit that matters to a simulation is 1e-3.
TEST(Bounces, AThousandElasticBouncesGainNoEnergy) {
  constexpr int kBounces = 1000;
  const auto largest_change = [](double tolerance) {
    double largest = 0;
    int touched = 0;
    for (const Rebound& b : rebounds(kBounces, potential, tolerance)) {
      touched += b.touched;
      largest = std::max(largest, std::abs(b.gain));
    }
    EXPECT_GT(touched, 0.95 * kBounces);
    return largest;
  };
  const double coarse = largest_change(1e-9), fine = largest_change(1e-11);
  RecordProperty("largest_change", std::to_string(fine));
  EXPECT_LT(fine, 1e-5);
  EXPECT_LT(fine, coarse / 5);
}

// The judge sees a law that makes energy: a tenth stiffer while leaving than while approaching.
TEST(Bounces, ALawThatMakesEnergyIsFoundOut) {
  const FreeBox::Force law = [](const Pose& X_AB, const RelativeVelocity& V_AB) {
    ContactForce f = potential(X_AB, V_AB);
    const Eigen::Vector3d v = V_AB.v_A + V_AB.w_A.cross(f.impact_point_A - X_AB.translation());
    if (f.f_A.dot(v) > 0) f.f_A *= 1.1, f.t_A *= 1.1;
    return f;
  };
  const ReboundFigures figures = figures_of(rebounds(20, law, 1e-9));
  EXPECT_GT(figures.gained, figures.touched / 2);
}

}  // namespace
}  // namespace quayside::contact_nn
