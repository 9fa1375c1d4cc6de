#include "harness/validation.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/harness_output/hand_made_run.h"

namespace quayside::harness {
namespace {

std::vector<ValidationRow> rows_of(Likeness likeness, const EngineRun& a, const EngineRun& b) {
  const EngineComparison comparison = compare_engines(a, b);
  return validation_rows(likeness, comparison.trajectory, comparison.events);
}

const ValidationRow& find(const std::vector<ValidationRow>& rows, const std::string& subject, const std::string& measure) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const ValidationRow& row) {
    return row.subject.rfind(subject, 0) == 0 && row.measure == measure;
  });
  if (found == rows.end()) throw std::out_of_range(subject + " " + measure);
  return *found;
}

TEST(Validation, ARunIsWithinAllTolerancesOfItself) {
  const EngineRun run = sinking_load("simbody");
  const auto rows = rows_of(Likeness::same_law, run, run);
  EXPECT_TRUE(std::all_of(rows.begin(), rows.end(), [](const ValidationRow& row) { return row.within() && row.value == 0; }));
  EXPECT_EQ(find(rows, "load.position", "rms").unit, "m");
}

// 5 mm aside all the time: within what another model may differ by (10 mm rms), not within what another integrator may.
TEST(Validation, TellsAnIntegratorFromAModel) {
  const EngineRun a = sinking_load("simbody"), b = sinking_load("mujoco", 0.005);
  const auto same = rows_of(Likeness::same_law, a, b), native = rows_of(Likeness::native, a, b);
  EXPECT_FALSE(find(same, "load.position", "rms").within());
  EXPECT_TRUE(find(native, "load.position", "rms").within());
  EXPECT_NE(find(same, "load.position", "rms").reason, find(native, "load.position", "rms").reason);
}

// Events 10 ms late.
TEST(Validation, MeasuresEventsAndImpacts) {
  EngineRun a = sinking_load("simbody"), b = sinking_load("mujoco", 0, 0.01);
  b.events[3].impulse += 600;      // of 15,000 N s: 4 %
  b.events[3].peak_force += 9e4;   // of 600 kN: 15 %
  const auto rows = rows_of(Likeness::same_law, a, b);
  EXPECT_NEAR(find(rows, "landed", "time_shift").value, 0.01, 1e-12);  // rounding
  EXPECT_FALSE(find(rows, "landed", "time_shift").within());
  EXPECT_NEAR(find(rows, "contact_broken load/upper", "impulse").value, 600, 1e-9);
  EXPECT_FALSE(find(rows, "contact_broken load/upper", "impulse").within());
  EXPECT_TRUE(find(rows_of(Likeness::native, a, b), "contact_broken load/upper", "impulse").within());
  EXPECT_TRUE(find(rows_of(Likeness::native, a, b), "contact_broken load/upper", "peak_force").within());
}

TEST(Validation, AnImpactThatIsMissingIsBeyondAnyTolerance) {
  EngineRun a = sinking_load("simbody"), b = a;
  b.open_contacts.clear();
  const auto rows = rows_of(Likeness::native, a, b);
  EXPECT_FALSE(find(rows, "contact_broken load/lower", "missing").within());
  EXPECT_NE(validation_text(rows).find("farthest out: contact_broken load/lower"), std::string::npos);
}

TEST(Validation, TheTableHasAsManyColumnsAsItsHeader) {
  const EngineRun a = sinking_load("simbody");
  const std::string csv = csv_text("sinking", "simbody", "mujoco", rows_of(Likeness::native, a, sinking_load("mujoco", 0.1)));
  const std::string first = csv.substr(0, csv.find('\n')), header = kValidationHeader;
  // The reason, last and quoted, holds commas of its own.
  EXPECT_EQ(std::count(first.begin(), first.begin() + static_cast<long>(first.find('"')), ','),
            std::count(header.begin(), header.end(), ','));
}

}  // namespace
}  // namespace quayside::harness
