// The shipped crane cases, as a user runs them: engines against each other, the energy ledger, and the committee against the exact
// contact it stands for.
#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "cases/case.h"
#include "contact_nn/gate_training.h"
#include "harness/compare.h"
#include "harness/run.h"

namespace quayside::harness {
namespace {

cases::Case shipped(const std::string& name) { return cases::load_case("cases/" + name + ".yaml"); }

EngineRun run_with(const cases::Case& description, const std::string& engine) {
  RunOptions options;
  options.engines = {engine};
  EngineRun run = std::move(run_case(description, options).engines.front());
  EXPECT_FALSE(run.failure) << run.failure.value_or("");
  return run;
}

EngineRun simbody_at(cases::Case description, double relative_tolerance) {
  description.solver.relative_tolerance = relative_tolerance;
  return run_with(description, "simbody");
}

double distance(const EngineRun& a, const EngineRun& b) {
  return compare_signal(a.trajectory, b.trajectory, "load.position").rms;
}

class CraneCase : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Shipped, CraneCase, testing::Values("free_sway", "land_on_ground", "land_on_stack"),
                         [](const auto& info) { return std::string(info.param); });

// E(t) − E(0) = work of the drives − dissipation, both integrated with the motion. At a relative tolerance of 1e-8 the
// integrator leaves 1e-7 of the largest exchange; 1e-5 is the promise to the user.
TEST_P(CraneCase, EnergyLedgerCloses) {
  const EngineRun run = simbody_at(shipped(GetParam()), 1e-8);
  ASSERT_GT(run.energy.largest_exchange, 1e4);  // something happened: 10 kJ is the load 3 cm lower
  EXPECT_LE(std::abs(run.energy.residual()), 1e-5 * run.energy.largest_exchange);
}

// The same laws in two engines with two integrators (BDF with error control; Runge-Kutta of order four with a step from
// the stiffest time constant). Each converges to itself, and both to the same motion: what is left between them is bounded
// by 1e-6 m in free sway and by 1e-4 m in landings, where the switch that stops the hoist closes in a stiff contact.
TEST_P(CraneCase, BothEnginesConvergeToTheSameMotion) {
  const cases::Case description = shipped(GetParam());
  const EngineRun reference = simbody_at(description, 1e-9);
  const double coarse = distance(reference, simbody_at(description, 1e-5));
  const double fine = distance(reference, simbody_at(description, 1e-7));
  EXPECT_LT(fine, 0.2 * coarse);  // a hundredth of the tolerance: at least a fifth of the error, BDF's error being erratic

  const EngineRun same_law = run_with(description, "mujoco_same_law");
  const double bound = std::string(GetParam()) == "free_sway" ? 1e-6 : 1e-4;  // [m]
  EXPECT_LT(distance(reference, same_law), bound);

  cases::Case halved = description;
  halved.solver.mujoco_step = 0.5 * same_law.simulated_s / same_law.statistics.steps;
  EXPECT_LT(distance(same_law, run_with(halved, "mujoco_same_law")), bound);
}

// The gate only names where to look and what it leaves out is proved empty, so the committee's force is the exact one to the last
// bit and so is the motion, with trained and with random weights. Only the share of answers that had to be
// taken from the exact law tells them apart.
class Committee : public CraneCase {};
INSTANTIATE_TEST_SUITE_P(Shipped, Committee, testing::Values("land_on_ground", "land_on_stack"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(Committee, MovesTheLoadAsExactContactDoes) {
  cases::Case description = shipped(GetParam());
  description.solver.relative_tolerance = 1e-8;
  description.contact.model = "exact";
  const EngineRun exact = run_with(description, "simbody");

  description.contact.model = "committee";
  const EngineRun committee = run_with(description, "simbody");
  EXPECT_LT(distance(exact, committee), 1e-6);
  EXPECT_GT(committee.statistics.contact.network_evaluations, 0u);
  EXPECT_LE(committee.statistics.contact.fallbacks, 0.01 * committee.statistics.contact.queries);

  contact_nn::GateTrainingOptions untrained;
  untrained.epochs = 0;
  untrained.pairs = 100;
  const auto file = std::filesystem::temp_directory_path() /
                    ("quayside_random_gate_" + std::to_string(getpid()) + "_" + GetParam() + ".onnx");
  contact_nn::write_network(file.string(), contact_nn::train_gate(untrained));
  description.contact.network = file.string();
  const EngineRun random = run_with(description, "simbody");
  std::filesystem::remove(file);
  EXPECT_EQ(distance(committee, random), 0);
  EXPECT_GT(random.statistics.contact.fallbacks, 10 * committee.statistics.contact.fallbacks);
}

}  // namespace
}  // namespace quayside::harness
