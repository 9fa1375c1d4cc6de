// Recorded signals made small enough for a page: polylines within a stated distance of every recorded value.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace quayside::harness::report {

struct Vertex {
  double time;  // [s]
  double value;
};

// A polyline through some of the samples, within `tolerance` of each of the others. Times have to increase. Values that
// are not finite stay vertices, so that a gap stays a gap.
std::vector<Vertex> polyline(const std::vector<double>& times, const std::vector<double>& values, double tolerance);

// The signals of one engine.
struct CurveTable {
  struct Curve {
    std::string name, unit;
    std::vector<double> times, values;
  };
  std::string engine;
  std::vector<Curve> curves;
};

// {"duration": s, "tolerance": {"m": 2e-5, ...},
//  "engines": {"simbody": {"names": [...], "units": [...], "counts": [...], "data": "base64"}}}
//
// `data` holds one curve after another, little endian: its vertices' times as uint32 in units of duration / 2³², then their
// values as float32. So a reader can decode one curve without the others. The tolerance of a unit is a share of the largest magnitude that any of its
// signals has; that share starts at a millionth and is doubled until the data take no more than `most_bytes`.
nlohmann::ordered_json pack_curves(const std::vector<CurveTable>& tables, double duration, std::size_t most_bytes);

}  // namespace quayside::harness::report
