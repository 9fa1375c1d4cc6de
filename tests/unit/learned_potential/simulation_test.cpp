// A free 40 ft box of 30 t on a fixed one under the law `learned`: bounces and rest.
#include <gtest/gtest.h>

#include "contact_nn/free_box.h"
#include "tests/unit/contact_nn/poses.h"

namespace quayside::contact_nn {
namespace {

using Eigen::Vector3d;
using test::kContainer;
using test::pose;

FreeBox::Force force_of(ContactSettings settings) {
  settings.law = Law::learned;
  settings.model = Model::exact;
  const std::shared_ptr<ContactModule> module = make_contact_module(settings);
  return [module](const Pose& X_AB, const RelativeVelocity& V_AB) {
    ContactCounters counters;
    return module->force(kContainer, kContainer, X_AB, V_AB, counters);
  };
}

// Starts over the whole domain of the network and beyond, so that some cross the seam while they rock. The force is the
// gradient of a potential: what is gained or lost is the integrator's and falls with its tolerance (4e-4 of the start at most
// with 1e-8 m a step, 1e-4 with 1e-9). A force that made energy would not care. (More of them: `quayside contact energy`.)
TEST(LearnedPotentialBounces, AThousandElasticBouncesGainNoEnergy) {
  ContactSettings settings;
  settings.friction = 0;
  settings.restitution = 1;
  const FreeBox::Force force = force_of(settings);
  const auto figures = [&](double tolerance) {
    Random random(1);
    std::vector<Rebound> bounces;
    for (int i = 0; i < 1000; ++i) bounces.push_back(rebound(throw_down(kContainer, kContainer, random), force, tolerance));
    return figures_of(bounces);
  };
  const ReboundFigures coarse = figures(1e-7), fine = figures(1e-8);
  RecordProperty("most_gained", std::to_string(fine.most_gained));
  EXPECT_GT(fine.touched, 950);
  EXPECT_EQ(fine.gained, 0);
  EXPECT_EQ(fine.lost, 0);
  EXPECT_LT(fine.median, coarse.median / 3);
}

// Set down, offset by 30/20 mm and at rest for 20 s. Sideways force is F_x/F times the load, and friction creeps under it at
// v_t0 F_x/(μ N): 2 µm in 20 s are F_x = 4e-5 of the load.
TEST(LearnedPotentialRest, ABoxAtRestDoesNotSlide) {
  constexpr double kGravity = 9.80665, kTolerance = 1e-9;
  const FreeBox box(kContainer, 30e3, force_of({}), kGravity);
  FreeBox::State y = FreeBox::state(pose({0.03, 0.02, 2 * kContainer.half.z() - 4.9e-4}), Vector3d::Zero(), Vector3d::Zero());
  box.follow(y, 2, kTolerance);
  const Vector3d settled = y.head<3>();
  box.follow(y, 20, kTolerance);
  const double slide = (y.head<3>() - settled).head<2>().norm(), sink = std::abs(y[2] - settled[2]);
  RecordProperty("slide", std::to_string(slide * 1e6) + " um");
  EXPECT_LT(slide, 2e-6);
  EXPECT_LT(sink, 1e-6);
}

}  // namespace
}  // namespace quayside::contact_nn
