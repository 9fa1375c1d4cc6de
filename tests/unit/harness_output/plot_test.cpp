#include "harness/plot.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <tinyxml2.h>

namespace quayside::harness {
namespace {

int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(Plot, IsOneWellFormedDocumentWithAPathPerCurve) {
  const std::string svg =
      svg_plot("a < b & c", {"time [s]"}, {{"height [m]", {{"one", {0, 1}, {0, 2}}, {"two", {0, 1}, {1, 1}}}},
                                           {"speed [m/s]", {{"one", {0, 1}, {-1, 1}}}}});
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.Parse(svg.c_str()), tinyxml2::XML_SUCCESS) << document.ErrorStr();
  EXPECT_STREQ(document.RootElement()->FirstChildElement("title")->GetText(), "a < b & c");
  EXPECT_EQ(count(svg, "<path"), 3);
}

// A value that cannot be drawn, NaN or not positive on a logarithmic axis, interrupts a curve: two strokes for the two stretches.
TEST(Plot, ValuesThatCannotBeDrawnInterruptACurve) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string linear = svg_plot("", {"x"}, {{"y", {{"c", {0, 1, 2, 3, 4}, {1, 2, nan, 2, 1}}}}});
  EXPECT_EQ(count(linear.substr(linear.find("<path")), "M"), 2);
  const std::string log = svg_plot("", {"x", true, true}, {{"y", {{"c", {1, 10, 0, 100, 1000}, {1, 2, 3, 4, 5}}}}});
  EXPECT_EQ(count(log.substr(log.find("<path")), "M"), 2);
}

TEST(Plot, RefusesCurvesWithoutPartners) {
  EXPECT_THROW(svg_plot("", {"x"}, {{"empty", {}}}), std::invalid_argument);
  EXPECT_THROW(svg_plot("", {"x"}, {{"y", {{"c", {1, 2}, {1}}}}}), std::invalid_argument);
}

}  // namespace
}  // namespace quayside::harness
