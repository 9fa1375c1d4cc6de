// The table of hard cases, its longest parts shortened, as tests.
#include <cctype>
#include <ostream>

#include <gtest/gtest.h>

#include "tests/stability/hard_case.h"

namespace quayside::harness {

void PrintTo(const HardCase& hard_case, std::ostream* out) { *out << hard_case.name; }

namespace {

class Hard : public testing::TestWithParam<HardCase> {};

TEST_P(Hard, Case) {
  HardCaseSettings settings;
  settings.whole = false;
  Findings findings;
  GetParam().run(settings, findings);
  const auto list = findings.take();
  EXPECT_FALSE(list.empty());
  for (const Finding& finding : list) {
    EXPECT_TRUE(finding.acceptable()) << finding.quantity << ": " << finding.measured << " " << finding.unit << ", expected "
                                      << finding.expected << " ± " << std::max(finding.threshold, finding.accepted) << " ("
                                      << finding.reason << ")";
  }
}

INSTANTIATE_TEST_SUITE_P(Table, Hard, testing::ValuesIn(hard_cases()), [](const auto& info) {
  std::string name = info.param.name;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
});

}  // namespace
}  // namespace quayside::harness
