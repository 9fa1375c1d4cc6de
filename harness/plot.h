// Line plots as SVG: panels one below the other over a common horizontal axis.
#pragma once

#include <string>
#include <vector>

namespace quayside::harness {

struct Curve {
  std::string label;  // the same label has the same colour and dash in every panel
  std::vector<double> x, y;
  std::vector<char> emphasized{};  // points whose marker is filled; empty: none
};

struct Panel {
  std::string title;  // with the unit: "load.position.z [m]"
  std::vector<Curve> curves;
};

struct Axes {
  std::string x_title;
  bool log_x = false, log_y = false;  // values that are not positive interrupt a curve
  bool markers = false;               // a dot at every point, for curves of few points
};

// One self-contained SVG document, readable on light and dark pages. Values that are not finite interrupt a curve. Throws
// std::invalid_argument for a panel without curves or a curve whose x and y differ in length.
std::string svg_plot(const std::string& title, const Axes& axes, const std::vector<Panel>& panels);

}  // namespace quayside::harness
