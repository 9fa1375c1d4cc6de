// The text of a case with its overrides applied, as it travels inside an FMU.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "cases/case.h"
#include "harness/fmi/archive.h"

namespace quayside::cases {
namespace {

// What the text loads as is what file and overrides load as: its own text, and so every value, is the same again.
TEST(CaseText, LoadsAsTheCaseItself) {
  const harness::TemporaryFolder folder;
  const auto copy = folder.path() / "case.yaml";
  const std::vector<std::string> overrides{"duration=25.5", "containers.load.mass=20000", "gravity.2=-1.62",
                                           "title=\"a \\\"quoted\\\" title: #1, {x}\""};
  for (const char* file : {"tests/unit/cases/every_key.yaml", "cases/land_on_stack.yaml"}) {
    auto applicable = overrides;
    if (file[0] == 'c') applicable.erase(applicable.begin() + 2);  // it has no gravity of its own to index
    const std::string text = case_text(file, applicable);
    std::ofstream(copy) << text;
    EXPECT_EQ(case_text(copy), text);
    const Case original = load_case(file, applicable), again = load_case(copy);
    EXPECT_EQ(again.title, "a \"quoted\" title: #1, {x}");
    EXPECT_EQ(again.duration, 25.5);
    EXPECT_EQ(again.containers.at(0).mass, 20000);
    EXPECT_EQ(again.gravity, original.gravity);
    EXPECT_EQ(again.script.size(), original.script.size());
    EXPECT_EQ(again.expectations.size(), original.expectations.size());
    EXPECT_EQ(again.connections.size(), original.connections.size());
  }
}

}  // namespace
}  // namespace quayside::cases
