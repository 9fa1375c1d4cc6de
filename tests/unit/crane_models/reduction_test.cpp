#include "crane_models/reduction.h"

#include <gtest/gtest.h>

#include "crane_models/load_bodies.h"
#include "crane_models/rope_crane.h"

namespace quayside::crane_models {
namespace {

// A crane with a skewed load, and a box on the ground that load and spreader may meet.
Scene yard() {
  Scene scene;
  RopeCrane crane = quayside_crane();
  crane.trolley_position = 20;
  crane.trolley_height = 32;
  crane.rope_length = 20;
  crane.anchor_skew = 0.1;
  crane.load_side.loads = {{"load", 30480}};
  crane.load_side.loads[0].centre_of_gravity = {0.5, 0.1, -0.2};
  add_rope_crane(crane, scene);
  Body box = box_body("box", {2, 2, 2}, 1000);
  scene.bodies.push_back(box);
  Body ground = box_body("ground", {100, 100, 2}, 0);
  fix_to_world(ground);
  scene.bodies.push_back(ground);
  // trolley 0, spreader 1, load 2, box 3, ground 4
  scene.pairs = {{1, 0, 2, 0}, {1, 0, 3, 0}, {1, 0, 4, 0}, {2, 0, 3, 0}, {2, 0, 4, 0}, {3, 0, 4, 0}};
  check(scene);
  return scene;
}

ScriptUse use(bool trolley, bool hoist, bool twistlocks) { return {{trolley, hoist}, {twistlocks}}; }

TEST(Reduction, LeavesAloneWhatTheScriptUses) {
  const Scene full = yard();
  ReductionReport report;
  const Scene reduced = reduce(full, use(true, true, true), report);
  EXPECT_EQ(reduced.bodies.size(), full.bodies.size());
  EXPECT_EQ(reduced.locks.size(), 1u);
  EXPECT_EQ(reduced.pairs.size(), full.pairs.size());
  EXPECT_TRUE(report.entries.empty());
  EXPECT_EQ(report.degrees_of_freedom_after, report.degrees_of_freedom_before);
}

TEST(Reduction, MergesALoadThatStaysLocked) {
  const Scene full = yard();
  ReductionReport report;
  const Scene reduced = reduce(full, use(true, true, false), report);
  EXPECT_NO_THROW(check(reduced));
  ASSERT_EQ(reduced.bodies.size(), 4u);
  EXPECT_TRUE(reduced.locks.empty());
  EXPECT_EQ(degrees_of_freedom(full) - degrees_of_freedom(reduced), 6);
  EXPECT_EQ(report.bodies_before, 5);
  EXPECT_EQ(report.bodies_after, 4);
  EXPECT_EQ(report.pairs_after, 5);  // all but spreader against load
  ASSERT_EQ(report.entries.size(), 2u);
  EXPECT_EQ(report.entries[0].what, "load merged into spreader");

  // Mass, centre of mass and inertia in the world are those of both together.
  const auto in_world = [](const Body& body) { return spreader::moved(mass_properties(body), body.X_WB); };
  const auto expected = spreader::combined(in_world(full.bodies[1]), in_world(full.bodies[2]));
  const auto merged = in_world(reduced.bodies[1]);
  EXPECT_NEAR(merged.mass, expected.mass, 1e-9);
  EXPECT_TRUE(merged.p_BBcm.isApprox(expected.p_BBcm, 1e-13));
  EXPECT_TRUE(merged.I_BBcm_B.isApprox(expected.I_BBcm_B, 1e-12));

  // What is reported stays where it was, under its name.
  ASSERT_EQ(reduced.frames.size(), full.frames.size());
  for (std::size_t i = 0; i < full.frames.size(); ++i) {
    EXPECT_EQ(reduced.frames[i].name, full.frames[i].name);
    EXPECT_TRUE((reduced.bodies[reduced.frames[i].body].X_WB * reduced.frames[i].X_BR)
                    .isApprox(full.bodies[full.frames[i].body].X_WB * full.frames[i].X_BR, 1e-13));
  }
  // Contacts keep their names, and their boxes stand where they stood.
  for (const ContactPair& pair : reduced.pairs) EXPECT_NE(pair.body_a, pair.body_b);
  const auto& load_pair = reduced.pairs[2];
  EXPECT_EQ(contact_name(reduced, load_pair.body_a, load_pair.box_a), "load");
  EXPECT_EQ(contact_name(reduced, load_pair.body_b, load_pair.box_b), "box");
  const Body& with_load = reduced.bodies[load_pair.body_a];
  EXPECT_TRUE((with_load.X_WB * with_load.boxes[load_pair.box_a].X_BG).isApprox(full.bodies[2].X_WB, 1e-13));
  EXPECT_EQ(reduced.landed_switches[0].bodies, std::vector<int>{1});
}

TEST(Reduction, FreezesADriveThatNothingMoves) {
  const Scene full = yard();
  ReductionReport report;
  const Scene reduced = reduce(full, use(false, false, true), report);
  EXPECT_NO_THROW(check(reduced));
  const Body& trolley = reduced.bodies[0];
  EXPECT_TRUE(trolley.is_static());
  EXPECT_TRUE((trolley.joint.X_PF * trolley.joint.X_BM.inverse()).isApprox(trolley.X_WB, 1e-14));
  for (const auto& rope : reduced.ropes) {
    EXPECT_TRUE(rope.drives.empty());
    EXPECT_EQ(rope.rest_length, 20);
  }
  EXPECT_EQ(reduced.drives.size(), 2u);  // a script may still name them
}

TEST(Reduction, KeepsBodiesApartThatMoveDifferently) {
  Scene full = yard();
  full.bodies[2].v_WB = {0, 0.1, 0};
  ReductionReport report;
  EXPECT_EQ(reduce(full, use(true, true, false), report).locks.size(), 1u);
}

TEST(Reduction, DropsALockThatStaysOpen) {
  Scene full = yard();
  full.commands[0].start = full.locks[0].closed = false;
  ReductionReport report;
  const Scene reduced = reduce(full, use(true, true, false), report);
  EXPECT_TRUE(reduced.locks.empty());
  EXPECT_EQ(reduced.bodies.size(), full.bodies.size());
}

TEST(Reduction, DropsPairsOfBodiesThatCannotMove) {
  Scene full = yard();
  fix_to_world(full.bodies[3]);
  ReductionReport report;
  const Scene reduced = reduce(full, use(true, true, true), report);
  EXPECT_EQ(reduced.pairs.size(), 5u);
  ASSERT_EQ(report.entries.size(), 1u);
  EXPECT_EQ(report.entries[0].what, "1 contact pair left out");
}

}  // namespace
}  // namespace quayside::crane_models
