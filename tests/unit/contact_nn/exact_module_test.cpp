#include "contact_nn/exact_module.h"

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <string>

#include <gtest/gtest.h>

#include "tests/unit/contact_nn/poses.h"

// Counts what this binary allocates, to show that the step path does not.
namespace {
std::atomic<long> allocations{0};
}
void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace quayside::contact_nn {
namespace {

using namespace test;
using Eigen::Vector3d;

ContactSettings exact(Law law) {
  ContactSettings settings;
  settings.model = Model::exact;
  settings.law = law;
  return settings;
}

TEST(ExactModule, IsMadeFromTheSettingsForBothLaws) {
  ContactCounters counters;
  for (const Law law : {Law::potential, Law::points}) {
    const auto module = make_contact_module(exact(law));
    const Pose X_AB = pose({0, 0, 2.591 - 1e-3});
    const ContactForce f = module->force(kContainer, kContainer, X_AB, {}, counters);
    // 29.72 m² of contact for 29.7: 6e8 N/m · 1 mm to 0.1 %, borders included.
    EXPECT_NEAR(f.f_A.z(), 6e5, 6e2);
    EXPECT_EQ(module->query(kContainer, kContainer, X_AB, counters).count, 4);
  }
  EXPECT_EQ(counters.queries, 4u);
  EXPECT_EQ(counters.network_evaluations, 0u);
  EXPECT_EQ(counters.fallbacks, 0u);
}

TEST(ExactModule, RefusesSettingsOutOfRangeAndNamesThem) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const char* key, double ContactSettings::*member, double value) {
    ContactSettings settings = exact(Law::potential);
    settings.*member = value;
    try {
      make_contact_module(settings);
      ADD_FAILURE() << key << " = " << value << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(key), std::string::npos) << error.what();
    }
  };
  for (const double bad : {0.0, -1.0, inf, nan}) {
    refused("stiffness", &ContactSettings::stiffness, bad);
    refused("reference_speed", &ContactSettings::reference_speed, bad);
    refused("transition_speed", &ContactSettings::transition_speed, bad);
  }
  for (const double bad : {0.0, -0.1, 1.001, inf, nan}) refused("restitution", &ContactSettings::restitution, bad);
  for (const double bad : {-0.1, inf, nan}) refused("friction", &ContactSettings::friction, bad);
}

TEST(ExactModule, AllocatesNothingAndRepeatsToTheLastBit) {
  Random random(1);
  ContactCounters counters;
  for (const Law law : {Law::potential, Law::points}) {
    const auto module = make_contact_module(exact(law));
    for (int trial = 0; trial < 100; ++trial) {
      const Pose X_AB =
          at_depth(kContainer, kCube, pose({0, 0, 0}, random.rotation()), random.direction(), random.uniform(-0.1, 0.3));
      RelativeVelocity V;
      V.v_A = random.direction();
      V.w_A = random.direction();
      const long before = allocations;
      const ContactForce f = module->force(kContainer, kCube, X_AB, V, counters);
      const Manifold m = module->query(kContainer, kCube, X_AB, counters);
      EXPECT_EQ(allocations, before);
      const ContactForce g = module->force(kContainer, kCube, X_AB, V, counters);
      EXPECT_EQ(f.f_A, g.f_A);
      EXPECT_EQ(f.t_A, g.t_A);
      EXPECT_EQ(m.gap, module->query(kContainer, kCube, X_AB, counters).gap);
    }
  }
}

}  // namespace
}  // namespace quayside::contact_nn
