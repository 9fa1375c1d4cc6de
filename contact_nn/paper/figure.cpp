#include "contact_nn/paper/figure.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace quayside::contact_nn::paper {

std::string prediction_svg(const std::string& title, const std::string& y_title, const std::vector<double>& desired,
                           const std::vector<double>& predicted) {
  if (desired.size() != predicted.size() || desired.size() < 2) {
    throw std::invalid_argument("a figure needs at least two patterns, each with a desired and a predicted value");
  }
  constexpr double width = 960, height = 400, left = 60, right = 20, top = 40, bottom = 50;  // pixels
  const auto [low_a, high_a] = std::minmax_element(desired.begin(), desired.end());
  const auto [low_b, high_b] = std::minmax_element(predicted.begin(), predicted.end());
  const double low = std::floor(std::min(*low_a, *low_b)),
               high = std::max(std::ceil(std::max(*high_a, *high_b)), low + 1);
  const auto x = [&](std::size_t i) {
    return left + (width - left - right) * static_cast<double>(i) / static_cast<double>(desired.size() - 1);
  };
  const auto y = [&](double value) { return height - bottom - (height - top - bottom) * (value - low) / (high - low); };

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" font-family=\"sans-serif\" "
      "font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
      "<text x=\"{}\" y=\"24\" font-size=\"15\">{}</text>\n"
      "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">pattern</text>\n"
      "<text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      width, height, left, title, (left + width - right) / 2, height - 12, (top + height - bottom) / 2, y_title);
  for (double tick = low; tick <= high; ++tick) {
    svg += fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/>"
                       "<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:.0f}</text>\n",
                       left, width - right, y(tick), y(tick), left - 6, y(tick) + 4, tick);
  }
  const std::size_t every = std::max<std::size_t>(1, desired.size() / 10);
  for (std::size_t i = 0; i < desired.size(); i += every) {
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", x(i), height - bottom + 18, i);
  }
  svg += "<polyline fill=\"none\" stroke=\"#1f5a96\" points=\"";
  for (std::size_t i = 0; i < desired.size(); ++i) svg += fmt::format("{:.1f},{:.1f} ", x(i), y(desired[i]));
  svg += "\"/>\n<g fill=\"#c8501e\">\n";
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>\n", x(i), y(predicted[i]));
  }
  return svg + "</g>\n</svg>\n";
}

}  // namespace quayside::contact_nn::paper
