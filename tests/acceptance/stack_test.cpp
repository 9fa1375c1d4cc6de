// A stack of five containers, all of them moving bodies, each offset by 30/20 mm from the one below.
#include <gtest/gtest.h>

#include "tests/acceptance/scenes.h"

namespace quayside::harness {
namespace {

constexpr int kCount = 5;

crane_models::Scene stack(double stiffness) {
  crane_models::Scene scene;
  add_body(scene, ground());
  double top = 0;
  for (int i = 0; i < kCount; ++i) {
    top -= (kCount - i) * kContainerMass * kGravity / stiffness;  // sinks in by the weight above
    add_body(scene, free_box("box" + std::to_string(i), kContainerMass, kContainerSize,
                             at(0.03 * i, 0.02 * i, top + kContainerSize.z() / 2)));
    top += kContainerSize.z();
  }
  return scene;
}

// The offsets lean the stack by parts of a milliradian, into which it settles by rocking for some ten seconds: it
// starts upright. Then it stands: within 0.1 mm for 60 s. What is left is the creep of friction under that lean, v_t0
// tan(lean)/μ, a micron per second.
TEST(Stack, OfFiveOffsetContainersRests) {
  const contact_nn::ContactSettings contact = exact_contact();
  Simulation simulation(stack(contact.stiffness), contact, 1e-6);
  simulation.run_to(20, 0.1);
  std::vector<Eigen::Vector3d> start;
  for (int i = 0; i < kCount; ++i) start.push_back(simulation.vector("box" + std::to_string(i) + ".position"));
  double largest = 0;
  simulation.run_to(80, 0.1, [&] {
    for (int i = 0; i < kCount; ++i) {
      largest = std::max(largest, (simulation.vector("box" + std::to_string(i) + ".position") - start[i]).norm());
    }
  });
  EXPECT_LT(largest, 1e-4);
  EXPECT_LT(simulation.get("box4.tilt"), 1e-3);
  const EngineStatistics statistics = simulation.engine().statistics();
  std::cout << statistics.rhs_evaluations << " evaluations, " << statistics.steps << " steps; moved " << 1e3 * largest
            << " mm\n";
}

}  // namespace
}  // namespace quayside::harness
