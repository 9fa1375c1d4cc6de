#include "harness/sweep.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "harness/error_budget.h"
#include "harness/sweep_table.h"

namespace quayside::harness {
namespace {

SweepPoint point(double rms, double wall, std::optional<std::string> failure = {}) {
  return {{"simbody", "bdf", "", 1e-6}, {wall}, rms, rms, 1, 1, failure};
}

// A box that falls 0.1 m on the ground and bounces once.
cases::Case falling_box() {
  cases::Case description;
  description.name = "falling_box";
  description.duration = 0.4;
  cases::BodySpec box;
  box.name = "box";
  box.size = {2, 1, 1};
  box.mass = 1000;
  box.position = {0, 0, 0.6};
  description.bodies = {box};
  return description;
}

TEST(Front, IsWhereNothingIsBothFasterAndNearer) {
  const std::vector<SweepPoint> all{point(1e-3, 1), point(1e-5, 2), point(1e-4, 3), point(1e-9, 0.1, "failed")};
  EXPECT_TRUE(on_front(all[0], all));
  EXPECT_TRUE(on_front(all[1], all));
  EXPECT_FALSE(on_front(all[2], all));  // the second is both
  EXPECT_FALSE(on_front(all[3], all));  // failed, and in nobody's way
}

TEST(Contenders, AreTheCombinationsThatMakeSense) {
  const auto all = contenders({"simbody", "mujoco_same_law", "mujoco"}, {"bdf", "erk", "rk4", "implicit"},
                              {"exact", "committee"}, {1e-6, 1e-4}, {1e-3});
  std::vector<std::string> labels;
  for (const Contender& c : all)
    if (labels.empty() || labels.back() != c.label()) labels.push_back(c.label());
  EXPECT_EQ(labels, (std::vector<std::string>{"simbody bdf, exact", "simbody bdf, committee", "simbody erk, exact",
                                              "simbody erk, committee", "mujoco_same_law rk4, exact",
                                              "mujoco_same_law rk4, committee", "mujoco rk4", "mujoco implicit"}));
  EXPECT_GT(all[0].setting, all[1].setting);  // from coarse to fine
}

TEST(Sweep, NearsTheReferenceAsTheToleranceFalls) {
  SweepOptions options;
  options.contenders = {{"simbody", "bdf", "", 1e-4}, {"simbody", "bdf", "", 1e-8}};
  options.repetitions = 2;
  const Sweep result = sweep(falling_box(), options);
  ASSERT_EQ(result.points.size(), 2u);
  EXPECT_EQ(result.points[0].wall_s.size(), 2u);
  EXPECT_LT(result.points[1].rms, 0.1 * result.points[0].rms);
  // A fixed step of h = 1e-5 s finds the kink where the force begins, and the one where it ends, up to a step late: v h =
  // 1.4e-5 m each at 1.4 m/s.
  EXPECT_LT(result.second_reference.rms, 3e-5);
}

TEST(Sweep, EndsWhereTheReferenceIsNotDoneInTime) {
  SweepOptions options;
  options.time_limit = 1e-9;
  EXPECT_THROW(sweep(falling_box(), options), std::runtime_error);
}

// At 1e-4 m: 10 s in 0.05 s are 5 ms/s; RK4 at the finer step, since the coarser one is too far off. At 1e-6 m nobody is.
TEST(SweepTable, TakesTheFastestSettingWithinTheError) {
  const auto file = std::filesystem::temp_directory_path() / "quayside_landing_sweep.csv";
  std::ofstream(file) << "engine,integrator,contact,setting,wall [s],real_time_factor,error_rms [m],error_max [m],steps,"
                         "rhs_evaluations,front,failure\n"
                         "simbody,bdf,,1e-4,0.05,200,8e-5,1e-4,1,1,yes,\"\"\n"
                         "simbody,bdf,,1e-6,0.1,100,2e-6,1e-5,1,1,yes,\"\"\n"
                         "simbody,merson,,1e-4,0.4,25,9e-6,1e-5,1,1,no,\"\"\n"
                         "mujoco_same_law,rk4,,1e-3,0.05,200,2e-4,1e-3,1,1,no,\"\"\n"
                         "mujoco_same_law,rk4,,1e-4,0.5,20,1e-8,1e-7,1,1,no,\"\"\n"
                         "mujoco,rk4,,1e-3,0.2,,,,1,1,no,\"fell, and failed\"\n"
                         "mujoco_same_law,rk4,exact,1e-5,5,2,3e-10,1e-9,1,1,reference,\"\"\n";
  const std::string table = sweep_table({file});
  std::filesystem::remove(file);
  EXPECT_NE(table.find("| 3e-10 | 1e-03 | 5 | – | × 8 | × 1 | – |"), std::string::npos) << table;
  EXPECT_NE(table.find("| 1e-04 | 5 | – | × 8 | × 10 | – |"), std::string::npos) << table;
  EXPECT_NE(table.find("| 1e-05 | 10 | – | × 4 | × 5 | – |"), std::string::npos) << table;
  EXPECT_NE(table.find("| 1e-06 | – | – | – | only | – |"), std::string::npos) << table;
}

TEST(ErrorBudget, HasALinePerShare) {
  cases::Case description = falling_box();
  const auto budget = error_budget(description);
  ASSERT_EQ(budget.size(), 5u);
  for (const BudgetLine& line : budget) EXPECT_FALSE(line.failure) << line.share << ": " << *line.failure;
  EXPECT_EQ(budget[0].share, "integration");
  // One impact at the default tolerance: some local errors of 1e-6 m.
  EXPECT_LT(budget[0].position.max, 1e-4);
  EXPECT_LT(budget[1].position.max, 1e-6);  // committee and exact evaluate the same closed forms
  EXPECT_LT(budget[2].position.max, 1e-6);  // nothing can be reduced
  // Falls from 0.1 m at 1.4 m/s: m v (1 + e) with e between 0 and 1.
  EXPECT_GT(budget[0].largest_impulse, 1400);
  EXPECT_LT(budget[0].largest_impulse, 3000);
  EXPECT_LT(budget[0].impulse, 1);
}

}  // namespace
}  // namespace quayside::harness
