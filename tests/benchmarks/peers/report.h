// The measurement as a table for machines, and as tables and a chart for people.
#pragma once

#include <string>

#include "tests/benchmarks/peers/measure.h"

namespace quayside::peers {

// Rows of numbers below '#' lines that say on what machine, with what libraries and settings they were made.
std::string csv(const Measurement& measurement, const Contenders& contenders, const std::vector<std::string>& circumstances);

// Time against error, both logarithmic: a column for each scene in contact, rows for depth, normal and impact point. One
// self-contained SVG document. Throws std::invalid_argument when no scene is in contact.
std::string chart(const Measurement& measurement, const std::vector<Scene>& scenes, const std::string& subtitle);

// For people, as Markdown: tables of methods against scenes with times, ratios to Bullet and MuJoCo, what was missed, errors.
std::string markdown(const Measurement& measurement, const std::vector<std::string>& circumstances);

}  // namespace quayside::peers
