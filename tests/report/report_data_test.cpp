// What a report is made of, before any browser sees it.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "harness/report/curves.h"
#include "harness/report/page.h"

namespace quayside::harness::report {
namespace {

double at(const std::vector<Vertex>& line, double time) {
  for (std::size_t i = 1; i < line.size(); ++i) {
    if (time > line[i].time) continue;
    const double part = (time - line[i - 1].time) / (line[i].time - line[i - 1].time);
    return line[i - 1].value + part * (line[i].value - line[i - 1].value);
  }
  return line.back().value;
}

std::vector<std::uint8_t> from_base64(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  std::uint32_t block = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    const int digit = c >= 'A' && c <= 'Z' ? c - 'A' : c >= 'a' && c <= 'z' ? c - 'a' + 26 : c >= '0' && c <= '9' ? c - '0' + 52 : c == '+' ? 62 : 63;
    block = block << 6 | static_cast<std::uint32_t>(digit);
    bits += 6;
    if (bits >= 8) bytes.push_back(static_cast<std::uint8_t>(block >> (bits -= 8)));
  }
  return bytes;
}

// A wave of 1 with steps in it: neither smooth nor noise.
void make_signal(int count, std::vector<double>& times, std::vector<double>& values) {
  for (int i = 0; i < count; ++i) {
    times.push_back(0.01 * i);
    values.push_back(std::sin(0.5 * times.back()) + (i % 400 > 300 ? 0.3 : 0));
  }
}

TEST(Polyline, StaysWithinItsToleranceOfEverySampleWithFewVertices) {
  std::vector<double> times, values;
  make_signal(4000, times, values);
  const double tolerance = 1e-4;
  const std::vector<Vertex> line = polyline(times, values, tolerance);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_LE(std::abs(at(line, times[i]) - values[i]), tolerance * (1 + 1e-9)) << times[i];
  // A chord of length h on a curve of second derivative ¼ departs from it by ¼ h²/8: 1e-4 is reached after 0.057 s, six
  // samples, at the steepest bends; 700 chords at most for 40 s.
  EXPECT_LT(line.size(), 700u);
  EXPECT_EQ(line.front().time, times.front());
  EXPECT_EQ(line.back().time, times.back());
}

TEST(Polyline, OfAConstantHasTwoVertices) {
  EXPECT_EQ(polyline({0, 1, 2, 3}, {5, 5, 5, 5}, 0).size(), 2u);
  EXPECT_EQ(polyline({0}, {5}, 0).size(), 1u);
  EXPECT_TRUE(polyline({}, {}, 0).empty());
}

TEST(Polyline, KeepsGapsAsGaps) {
  const double gap = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vertex> line = polyline({0, 1, 2, 3, 4, 5}, {0, 0, gap, gap, 1, 1}, 0.1);
  std::vector<double> finite;
  for (const Vertex& vertex : line)
    if (std::isfinite(vertex.value)) finite.push_back(vertex.time);
  EXPECT_EQ(finite, (std::vector<double>{0, 1, 4, 5}));
  EXPECT_GE(line.size(), 5u);
}

TEST(PackedCurves, ReadBackWithinTheStatedTolerance) {
  std::vector<double> times, values;
  make_signal(1000, times, values);
  const double duration = times.back();
  const auto packed = pack_curves({{"simbody", {{"a", "m", times, values}, {"b", "m", {0, duration}, {20, 20}}}}}, duration, 1'000'000);
  const double tolerance = packed["tolerance"]["m"];
  EXPECT_DOUBLE_EQ(tolerance, 20e-6);  // a millionth of the largest magnitude of the unit
  const auto& engine = packed["engines"]["simbody"];
  const std::vector<std::size_t> counts = engine["counts"];
  const std::vector<std::uint8_t> bytes = from_base64(engine["data"]);
  ASSERT_EQ(bytes.size(), 8 * (counts[0] + counts[1]));
  std::vector<Vertex> line(counts[0]);
  for (std::size_t i = 0; i < line.size(); ++i) {
    std::uint32_t tick = 0;
    float value = 0;
    std::memcpy(&tick, &bytes[4 * i], 4);
    std::memcpy(&value, &bytes[4 * (counts[0] + i)], 4);
    line[i] = {tick * duration / 4294967296.0, value};
  }
  // Besides the tolerance: a tick of 2.3 ns at slopes of 30/s (the steps), and half a float32 of 1.3.
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_LE(std::abs(at(line, times[i]) - values[i]), tolerance + 2e-7) << times[i];
}

// Noise is the worst there is: hardly a vertex can be left out until the tolerance has grown to the noise itself.
TEST(PackedCurves, KeepToTheirSizeAndSayWhatItCosts) {
  std::mt19937 random(1);
  std::vector<double> times, values;
  for (int i = 0; i < 20000; ++i) {
    times.push_back(i);
    values.push_back(std::uniform_real_distribution<double>(-1, 1)(random));
  }
  const auto fine = pack_curves({{"simbody", {{"noise", "N", times, values}}}}, times.back(), 1'000'000);
  const auto coarse = pack_curves({{"simbody", {{"noise", "N", times, values}}}}, times.back(), 150'000);
  EXPECT_LE(coarse["engines"]["simbody"]["data"].get<std::string>().size(), 150'004u);
  EXPECT_GT(fine["engines"]["simbody"]["data"].get<std::string>().size(), 150'004u);
  EXPECT_GT(coarse["tolerance"]["N"].get<double>(), fine["tolerance"]["N"].get<double>());
}

TEST(Page, HoldsItsDataWhateverTheyAreCalled) {
  const std::string html = page("run", "a <b> & \"c\"", {{"name", "</script><script>alert(1)</script>"}, {"bad", "\xff"}});
  EXPECT_NE(html.find("<title>a &lt;b> &amp; &quot;c&quot; "), std::string::npos);
  EXPECT_EQ(html.find("alert(1)</script>"), std::string::npos);
  EXPECT_NE(html.find("\\u003c/script>"), std::string::npos);
  EXPECT_EQ(html.find("{{"), std::string::npos);
}

// Offline in any browser: nothing is fetched. The one address is the name of SVG's namespace.
TEST(Page, AsksForNothingFromOutside) {
  const std::string html = page("run", "t", {});
  for (const char* key : {"src=", "@import", "fetch(", "XMLHttpRequest", "https://"}) EXPECT_EQ(html.find(key), std::string::npos) << key;
  for (std::size_t i = html.find("http:"); i != std::string::npos; i = html.find("http:", i + 1))
    EXPECT_EQ(html.compare(i, 26, "http://www.w3.org/2000/svg"), 0) << html.substr(i, 40);
}

}  // namespace
}  // namespace quayside::harness::report
