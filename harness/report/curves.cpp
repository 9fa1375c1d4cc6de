#include "harness/report/curves.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace quayside::harness::report {
namespace {

// At this share of the largest magnitude the rounding to float32 (6e-8 of the value) does not show yet.
constexpr double kFinestShare = 1e-6;
constexpr std::size_t kVertexBytes = 8;

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static const char* const kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t rest = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t block = 0;
    for (std::size_t k = 0; k < 3; ++k) block = block << 8 | (k < rest ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= rest ? kDigits[block >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

void append(std::uint32_t word, std::vector<std::uint8_t>& bytes) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(word >> shift));
}

std::uint32_t ticks(double time, double duration) {
  constexpr double kLast = 4294967295.0;
  return static_cast<std::uint32_t>(std::clamp(std::round(time / duration * 4294967296.0), 0.0, kLast));
}

std::uint32_t float_bits(double value) {
  const auto narrow = static_cast<float>(value);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &narrow, sizeof bits);
  return bits;
}

std::map<std::string, double> largest_magnitudes(const std::vector<CurveTable>& tables) {
  std::map<std::string, double> largest;
  for (const CurveTable& table : tables) {
    for (const CurveTable::Curve& curve : table.curves) {
      double& magnitude = largest[curve.unit];
      for (const double value : curve.values)
        if (std::isfinite(value)) magnitude = std::max(magnitude, std::abs(value));
    }
  }
  return largest;
}

using Polylines = std::vector<std::vector<std::vector<Vertex>>>;  // per table, per curve

Polylines polylines(const std::vector<CurveTable>& tables, const std::map<std::string, double>& tolerance, std::size_t& vertices) {
  Polylines all;
  vertices = 0;
  for (const CurveTable& table : tables) {
    all.emplace_back();
    for (const CurveTable::Curve& curve : table.curves) {
      all.back().push_back(polyline(curve.times, curve.values, tolerance.at(curve.unit)));
      vertices += all.back().back().size();
    }
  }
  return all;
}

}  // namespace

// From the last vertex on, the samples passed so far leave a cone of slopes that keep within the tolerance of all of them.
// A sample whose own slope lies outside of it cannot end the segment: the one before it does, and begins the next.
std::vector<Vertex> polyline(const std::vector<double>& times, const std::vector<double>& values, double tolerance) {
  std::vector<Vertex> line;
  if (values.empty()) return line;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double low = -kInfinity, high = kInfinity;
  const auto keep = [&](std::size_t i) {
    line.push_back({times[i], values[i]});
    low = -kInfinity;
    high = kInfinity;
  };
  keep(0);
  for (std::size_t i = 1; i < values.size(); ++i) {
    const auto slope = [&](double value) { return (value - line.back().value) / (times[i] - line.back().time); };
    const bool fits = std::isfinite(values[i]) && std::isfinite(line.back().value) && slope(values[i]) >= low && slope(values[i]) <= high;
    if (!fits && line.back().time < times[i - 1]) keep(i - 1);
    if (!std::isfinite(values[i])) {
      keep(i);
      continue;
    }
    low = std::max(low, slope(values[i] - tolerance));
    high = std::min(high, slope(values[i] + tolerance));
  }
  if (line.back().time < times.back()) keep(values.size() - 1);
  return line;
}

nlohmann::ordered_json pack_curves(const std::vector<CurveTable>& tables, double duration, std::size_t most_bytes) {
  const std::map<std::string, double> largest = largest_magnitudes(tables);
  std::map<std::string, double> tolerance;
  Polylines lines;
  std::size_t vertices = 0;
  for (double share = kFinestShare; share <= 2; share *= 2) {
    for (const auto& [unit, magnitude] : largest) tolerance[unit] = share * magnitude;
    lines = polylines(tables, tolerance, vertices);
    if (vertices * kVertexBytes * 4 / 3 <= most_bytes) break;
  }

  nlohmann::ordered_json engines = nlohmann::ordered_json::object();
  for (std::size_t t = 0; t < tables.size(); ++t) {
    nlohmann::ordered_json names = nlohmann::ordered_json::array(), units = names, counts = names;
    std::vector<std::uint8_t> bytes;
    for (std::size_t c = 0; c < lines[t].size(); ++c) {
      names.push_back(tables[t].curves[c].name);
      units.push_back(tables[t].curves[c].unit);
      counts.push_back(lines[t][c].size());
      for (const Vertex& vertex : lines[t][c]) append(ticks(vertex.time, duration), bytes);
      for (const Vertex& vertex : lines[t][c]) append(float_bits(vertex.value), bytes);
    }
    engines[tables[t].engine] = {{"names", names}, {"units", units}, {"counts", counts}, {"data", base64(bytes)}};
  }
  return {{"duration", duration}, {"tolerance", tolerance}, {"engines", engines}};
}

}  // namespace quayside::harness::report
