// The law `pads` in our own unit against MuJoCo's own contacts: the same springs, found by another collider and integrated by another
// engine.
#include <algorithm>

#include <gtest/gtest.h>

#include "harness/impacts/impact_response.h"
#include "harness/simbody/simbody_unit.h"
#include "tests/unit/mujoco/scenes.h"

namespace quayside::harness {
namespace {

struct Blow {
  Feature feature;
  Struck struck;
};

class Pads : public testing::TestWithParam<Blow> {};

double value(const std::vector<ResponseValue>& values, const std::string& name) {
  return std::find_if(values.begin(), values.end(), [&](const ResponseValue& v) { return v.name == name; })->value;
}

// An elastic blow without friction at 0.5 m/s. Both are then springs of K/4 at the same points: on MuJoCo's plane at the corners of a
// box, between boxes at the corners of the clipped faces, whose depths the 2.2.2 collider halves and our parameters double. MuJoCo
// steps ω h = 0.05 or less and misses peaks by up to (ω h)²/8 = 3e-4; a blow ends within a step of 1 % of it, and between
// boxes up to 3 % late, in the nanometres at which the boxes are apart but the last point is not.
TEST_P(Pads, StrikeLikeMujocosContacts) {
  const auto all = impact_matrix();
  const auto impact = std::find_if(all.begin(), all.end(), [](const Impact& i) {
    return i.feature == GetParam().feature && i.struck == GetParam().struck && i.speed == 0.5 && i.mass > 30e3 && i.friction == 0;
  });
  ASSERT_NE(impact, all.end());
  std::vector<ResponseValue> responses[2];
  for (const bool native : {false, true}) {
    ImpactSetup setup;
    setup.engine = native ? "mujoco" : "simbody";
    setup.contact.law = contact_nn::Law::pads;
    setup.contact.restitution = 1;
    setup.relative_tolerance = 1e-7;
    setup.until_rest = false;
    responses[native] = impact_response(*impact, setup);
  }
  EXPECT_NEAR(value(responses[1], "peak_force") / value(responses[0], "peak_force"), 1, 5e-4);
  EXPECT_NEAR(value(responses[1], "impulse") / value(responses[0], "impulse"), 1, 5e-4);
  EXPECT_NEAR(value(responses[1], "duration") / value(responses[0], "duration"), 1, 0.03);
  for (const char* component : {"velocity.x", "velocity.y", "velocity.z"}) {
    EXPECT_NEAR(value(responses[1], component), value(responses[0], component), 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Blows, Pads,
                         testing::Values(Blow{Feature::face, Struck::ground}, Blow{Feature::edge, Struck::ground},
                                         Blow{Feature::vertex, Struck::ground}, Blow{Feature::face, Struck::box},
                                         Blow{Feature::vertex, Struck::box}, Blow{Feature::vertex, Struck::hanging}));

// On a slope of tan α = r μ MuJoCo's friction is a damper below the limit, μ m g/v_t0 for the whole weight m g: it creeps at v_t0 sin α/μ,
// where ours creeps at v_t0 r/√(1 − r²), the same for small loads. Above the limit both slide with g (sin α − μ cos α).
TEST(PadsFriction, CreepsAndSlides) {
  using crane_models::Scene;
  for (const double r : {0.25, 0.5, 1.5}) {
    const double alpha = std::atan(0.4 * r), weight = 30480 * kGravity * std::cos(alpha);
    double speed[2];
    for (const bool is_native : {false, true}) {
      Scene scene;
      scene.bodies.push_back(ground());
      scene.bodies.push_back(box_body("box", 30480, {12.192, 2.438, 2.591}, {0, 0, 0.5 * 2.591 - weight / 6e8}));
      scene.pairs.push_back({0, 0, 1, 0});
      report(scene, "box");
      scene.gravity = kGravity * Eigen::Vector3d(std::sin(alpha), 0, -std::cos(alpha));
      auto contact = exact_contact();
      contact.law = contact_nn::Law::pads;
      const auto unit = is_native ? native(scene, {}, contact) : make_simbody_engine(scene, contact, {});
      start(*unit);
      run(*unit, 0, 2 * kSecond, 50 * kMillisecond);
      speed[is_native] = get(*unit, "box.velocity.x");
    }
    if (r < 1) {
      EXPECT_NEAR(speed[0] / (1e-3 * r / std::sqrt(1 - r * r)), 1, 1e-2);
      EXPECT_NEAR(speed[1] / (1e-3 * std::sin(alpha) / 0.4), 1, 1e-2);
    } else {
      EXPECT_NEAR(speed[1] / speed[0], 1, 2e-3);
    }
  }
}

}  // namespace
}  // namespace quayside::harness
