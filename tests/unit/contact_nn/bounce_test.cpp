// A free 40 ft box thrown elastically and without friction against a fixed one: does it come back with more energy?
// `quayside contact bounces` is the long version, over all laws.
#include "contact_nn/bounces.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "contact_nn/potential_law.h"

namespace quayside::contact_nn {
namespace {

Wrench potential(const Pose& X_AB) {
  const ContactForce f = potential_force(kBounceBox, kBounceBox, X_AB, {}, {6e8, 0, 0, 1e-3});
  return {f.f_A, f.t_A};
}

// The force is the gradient of a potential, so only the integrator can make energy: what is gained or lost must fall with
// its tolerance. It does: at most some 1e-5 of the start at 1e-9 m per step, less than 1e-6 at 1e-11 m. A law that makes
// energy would not care; the limit that matters to a simulation is 1e-3.
TEST(Bounces, AThousandElasticBouncesGainNoEnergy) {
  constexpr std::uint64_t kBounces = 1000;
  const auto largest_change = [](double tolerance) {
    BounceTrials trials;
    for (std::uint64_t i = 0; i < kBounces; ++i) trials.add(bounce(random_bounce_start(20240501 + i), potential, tolerance));
    EXPECT_GT(trials.touched, 0.95 * kBounces);
    EXPECT_LT(trials.unfinished, 5u);  // a box that turns beside the other may touch it again at the very end
    EXPECT_EQ(trials.gained, 0u);
    return std::max(trials.most_gained, trials.most_lost);
  };
  const double coarse = largest_change(1e-9), fine = largest_change(1e-11);
  RecordProperty("largest_change", std::to_string(fine));
  EXPECT_LT(fine, 1e-5);
  EXPECT_LT(fine, coarse / 5);
}

// The judge sees a law that makes energy: one that pushes out harder than it was pressed in. A spring of stiffness k while
// approaching and 1.1 k while leaving gives back a tenth more.
TEST(Bounces, ALawThatMakesEnergyIsFoundOut) {
  double deepest = 0;
  const ElasticLaw law = [&](const Pose& X_AB) {
    Wrench w = potential(X_AB);
    const double depth = -separation(kBounceBox, kBounceBox, X_AB);
    if (depth <= 0) deepest = 0;
    deepest = std::max(deepest, depth);
    const double factor = depth < 0.9 * deepest ? 1.1 : 1.0;
    return Wrench{factor * w.f_A, factor * w.t_A};
  };
  BounceTrials trials;
  for (std::uint64_t i = 0; i < 20; ++i) trials.add(bounce(random_bounce_start(i), law, 1e-9));
  EXPECT_GT(trials.gained, trials.touched / 2);
}

}  // namespace
}  // namespace quayside::contact_nn
