#include "harness/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace quayside::harness {
namespace {

// Geometry of the sheet, in CSS pixels.
constexpr double kWidth = 820, kPanelHeight = 190, kGap = 42, kLeft = 84, kRight = 20, kTop = 84, kBottom = 46;
constexpr double kLegendTop = 44, kLegendRow = 20;

// Okabe and Ito's palette, told apart by colour-blind readers as well; dashes carry the same distinction in print.
constexpr std::array<const char*, 6> kColours{"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"};
constexpr std::array<const char*, 6> kDashes{"", "7 4", "2 3", "9 3 2 3", "12 4", "4 2"};

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void include(double v) {
    if (!std::isfinite(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  // Never empty: a constant gets room on both sides.
  Range padded(double share) const {
    if (!(low <= high)) return {0, 1};
    const double room = low == high ? std::max(1e-12, 0.05 * std::abs(low)) : share * (high - low);
    return {low - room, high + room};
  }
};

// Round numbers, at most `most` of them, in [low, high].
std::vector<double> ticks(const Range& range, int most) {
  const double raw = (range.high - range.low) / most;
  const double decade = std::pow(10, std::floor(std::log10(raw)));
  double step = 10 * decade;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= raw) {
      step = factor * decade;
      break;
    }
  }
  std::vector<double> out;
  for (double k = std::ceil(range.low / step); k * step <= range.high; ++k) out.push_back(k * step);
  return out;
}

// Decades, at most `most` of them, or 1, 2, 5 of each where that are few; `range` and result in powers of ten.
std::vector<double> decades(const Range& range, int most) {
  const double span = range.high - range.low, step = std::max(1.0, std::ceil(span / most));
  std::vector<double> out;
  for (double k = std::floor(range.low); k <= range.high; k += step)
    for (const double factor : {1.0, 2.0, 5.0})
      if (const double tick = k + std::log10(factor); (factor == 1 || 3 * span < most) && tick >= range.low && tick <= range.high)
        out.push_back(tick);
  return out;
}

// What is drawn of a value along an axis: itself or its power of ten.
double drawn(double value, bool log) {
  if (!log) return value;
  return value > 0 ? std::log10(value) : std::numeric_limits<double>::quiet_NaN();
}

std::string tick_label(double position, bool log) {
  return fmt::format("{:.6g}", log ? std::pow(10, position) : position == 0 ? 0.0 : position);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') out += "&amp;";
    else if (c == '<') out += "&lt;";
    else if (c == '>') out += "&gt;";
    else out += c;
  }
  return out;
}

}  // namespace

std::string svg_plot(const std::string& title, const Axes& axes, const std::vector<Panel>& panels) {
  std::vector<std::string> labels;  // in order of first appearance
  Range x_range;
  for (const Panel& panel : panels) {
    if (panel.curves.empty()) throw std::invalid_argument("plot: panel '" + panel.title + "' has no curve");
    for (const Curve& curve : panel.curves) {
      if (curve.x.size() != curve.y.size())
        throw std::invalid_argument("plot: curve '" + curve.label + "' has x and y of different lengths");
      if (std::find(labels.begin(), labels.end(), curve.label) == labels.end()) labels.push_back(curve.label);
      for (const double x : curve.x) x_range.include(drawn(x, axes.log_x));
    }
  }
  x_range = x_range.padded(axes.markers ? 0.05 : 0);

  std::vector<std::pair<double, double>> legend;  // where each label stands
  double legend_x = kLeft, legend_y = kLegendTop;
  for (const std::string& label : labels) {
    const double width = 36 + 7.6 * label.size() + 24;
    if (legend_x > kLeft && legend_x + width > kWidth) {
      legend_x = kLeft;
      legend_y += kLegendRow;
    }
    legend.emplace_back(legend_x, legend_y);
    legend_x += width;
  }
  const double first_top = kTop + legend_y - kLegendTop;

  const double height = first_top + panels.size() * (kPanelHeight + kGap) - kGap + kBottom;
  const double plot_width = kWidth - kLeft - kRight;
  const auto place = [&](const std::string& label) {
    return static_cast<std::size_t>(std::find(labels.begin(), labels.end(), label) - labels.begin());
  };
  const auto colour = [&](const std::string& label) { return kColours[place(label) % kColours.size()]; };
  const auto style = [&](const std::string& label) {
    const std::size_t dash = place(label) + place(label) / kColours.size();  // another one in each round of colours
    return fmt::format("stroke=\"{}\" stroke-dasharray=\"{}\"", colour(label), kDashes[dash % kDashes.size()]);
  };

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\" "
      "font-family=\"system-ui, sans-serif\" font-size=\"13\">\n<title>{2}</title>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
      "<text x=\"{3}\" y=\"24\" font-size=\"16\" fill=\"#111\">{2}</text>\n",
      kWidth, height, escaped(title), kLeft);

  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto [x, y] = legend[i];
    svg += fmt::format(
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke-width=\"2.2\" {}/>"
        "<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"#111\">{}</text>\n",
        x, y, x + 30, y, style(labels[i]), x + 36, y + 4, escaped(labels[i]));
  }

  for (std::size_t k = 0; k < panels.size(); ++k) {
    const Panel& panel = panels[k];
    const double top = first_top + k * (kPanelHeight + kGap), bottom = top + kPanelHeight;
    Range y_range;
    for (const Curve& curve : panel.curves)
      for (const double y : curve.y) y_range.include(drawn(y, axes.log_y));
    y_range = y_range.padded(0.05);
    const auto px = [&](double x) { return kLeft + plot_width * (x - x_range.low) / (x_range.high - x_range.low); };
    const auto py = [&](double y) { return bottom - kPanelHeight * (y - y_range.low) / (y_range.high - y_range.low); };

    svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\" fill=\"#111\">{}</text>\n", kLeft, top - 7, escaped(panel.title));
    for (const double y : axes.log_y ? decades(y_range, 8) : ticks(y_range, 5))
      svg += fmt::format(
          "<line x1=\"{0}\" y1=\"{2:.1f}\" x2=\"{1}\" y2=\"{2:.1f}\" stroke=\"#ddd\"/>"
          "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\" fill=\"#333\">{5}</text>\n",
          kLeft, kWidth - kRight, py(y), kLeft - 8, py(y) + 4.5, tick_label(y, axes.log_y));
    for (const double x : axes.log_x ? decades(x_range, 10) : ticks(x_range, 10)) {
      svg += fmt::format("<line x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2}\" stroke=\"#eee\"/>", px(x), top, bottom);
      if (k + 1 == panels.size())
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\" fill=\"#333\">{}</text>", px(x),
                           bottom + 18, tick_label(x, axes.log_x));
      svg += '\n';
    }
    svg += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#888\"/>\n", kLeft, top,
                       plot_width, kPanelHeight);
    for (const Curve& curve : panel.curves) {
      std::string path;
      bool pen_down = false;
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        const double x = drawn(curve.x[i], axes.log_x), y = drawn(curve.y[i], axes.log_y);
        const bool drawable = std::isfinite(x) && std::isfinite(y);
        if (drawable) path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", px(x), py(y));
        const bool filled = i < curve.emphasized.size() && curve.emphasized[i];
        if (drawable && axes.markers)
          svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\" stroke-width=\"1.7\" stroke=\"{}\"/>\n",
                             px(x), py(y), filled ? colour(curve.label) : "#ffffff", colour(curve.label));
        pen_down = drawable;
      }
      svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke-width=\"1.7\" stroke-linejoin=\"round\" {}/>\n", path,
                         style(curve.label));
    }
  }
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" fill=\"#333\">{}</text>\n</svg>\n",
                     kLeft + plot_width / 2, height - 8, escaped(axes.x_title));
  return svg;
}

}  // namespace quayside::harness
