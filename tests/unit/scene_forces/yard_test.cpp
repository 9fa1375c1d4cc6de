// Stacks that nothing can touch are not built, and what may be touched is.
#include <gtest/gtest.h>

#include "harness/build_scene.h"

namespace quayside::harness {
namespace {

// A load hangs over the stack in the middle of a yard, five high.
cases::Case yard(int bays, int rows) {
  cases::Case description;
  description.file = "yard.yaml";
  description.duration = 10;
  description.crane.type = "quayside";
  description.crane.trolley_position = 20;
  description.crane.trolley_height = 36;
  description.crane.rope_length = 18;
  description.spreader = cases::SpreaderSpec{};
  cases::ContainerSpec load;
  load.name = "load";
  load.mass = 24000;
  load.on_spreader = true;
  description.containers = {load};
  cases::StackSpec stack;
  stack.name = "yard";
  stack.mass = 20000;
  stack.bays = bays;
  stack.rows = rows;
  stack.tiers = 5;
  stack.spacing = {14, 4};
  stack.position = {-14.0 * (bays / 2), 20 - 4.0 * (rows / 2), 0};
  description.stacks = {stack};
  cases::ScriptEntry down;
  down.speeds = {{"hoist", -0.3}};
  description.script = {down};
  return description;
}

TEST(Yard, OfTenThousandCostsWhatOneOfTenDoes) {
  LeftOut of_many, of_ten;
  const auto many = build_scene(yard(40, 50), of_many);
  const auto ten = build_scene(yard(1, 2), of_ten);
  EXPECT_EQ(of_many.containers, 10'000 - 5);
  EXPECT_EQ(of_ten.containers, 10 - 5);
  EXPECT_EQ(many.bodies.size(), ten.bodies.size());
  EXPECT_EQ(many.pairs.size(), ten.pairs.size());
  EXPECT_EQ(many.frames.size(), ten.frames.size());
}

TEST(Yard, StacksUnderAMovingTrolleyAndThoseTheyCanFellStay) {
  cases::Case description = yard(3, 40);
  cases::ScriptEntry across;
  across.speeds = {{"trolley", 1}};
  description.script.push_back(across);
  LeftOut left_out;
  build_scene(description, left_out);
  // A stack that falls reaches 13 m, and so the next three rows, and so on through the yard.
  EXPECT_EQ(left_out.containers, 0);
}

TEST(Yard, NothingIsLeftOutWhereReachHasNoBound) {
  cases::Case description = yard(3, 3);
  cases::BodySpec flying;
  flying.name = "flying";
  flying.mass = 100;
  flying.position = {0, 0, 30};
  flying.velocity = {1, 0, 0};
  description.bodies = {flying};
  LeftOut left_out;
  build_scene(description, left_out);
  EXPECT_EQ(left_out.containers, 0);
}

TEST(Yard, IsRefusedAsAWhole) { EXPECT_THROW(build_scene(yard(40, 50)), cases::CaseError); }

TEST(Yard, IsRefusedWhereItsBoxesOverlap) {
  cases::Case description = yard(3, 3);
  description.stacks[0].spacing.x() = 12;
  LeftOut left_out;
  EXPECT_THROW(build_scene(description, left_out), cases::CaseError);
}

}  // namespace
}  // namespace quayside::harness
