#include "tests/benchmarks/peers/report.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include <fmt/format.h>

namespace quayside::peers {
namespace {

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::ours: return "ours";
    case Kind::box_routine: return "box routine";
    case Kind::convex: return "convex";
    case Kind::mesh: return "mesh";
  }
  return "?";
}

// Median time of a method on a scene [ns].
double median_time(const Measurement& measurement, const Scene& scene, const std::string& contender) {
  for (const Result& r : measurement.results) {
    if (r.scene == &scene && r.contender->name == contender) return r.times.median;
  }
  return Answer::kNone;
}

// Empty for a number that is not there.
std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.4g}", value) : ""; }

// ---- chart

// Geometry of the sheet, in CSS pixels.
constexpr double kPanelWidth = 214, kPanelHeight = 200, kBand = 56, kGapX = 14, kGapY = 22, kLeft = 84, kTop = 78, kLegend = 178;

// Okabe and Ito's colours, told apart by colour-blind readers; shapes tell methods of one kind apart.
const char* colour_of(Kind kind) {
  switch (kind) {
    case Kind::ours: return "#0072B2";
    case Kind::box_routine: return "#D55E00";
    case Kind::convex: return "#009E73";
    case Kind::mesh: return "#8B5FA8";
  }
  return "";
}

struct LogAxis {
  double low, high;  // powers of ten
  double from, to;   // pixels
  double at(double value) const {
    const double share = (std::log10(std::max(value, std::pow(10, low))) - low) / (high - low);
    return from + std::clamp(share, 0.0, 1.0) * (to - from);
  }
};

// The n-th shape, around a point. Six shapes, then the same hollow.
std::string marker(int n, double x, double y, const char* colour) {
  static const char* shapes[] = {"M-4.5,0a4.5,4.5 0 1,0 9,0a4.5,4.5 0 1,0 -9,0z", "M-4,-4H4V4H-4z", "M0,-5.2L4.8,3.8H-4.8z",
                                 "M0,-5.4L5.4,0L0,5.4L-5.4,0z", "M0,5.2L4.8,-3.8H-4.8z",
                                 "M-4.6,-1.6H-1.6V-4.6H1.6V-1.6H4.6V1.6H1.6V4.6H-1.6V1.6H-4.6z"};
  const bool hollow = n >= 6;
  return fmt::format(R"svg(<path transform="translate({:.1f} {:.1f})" d="{}" fill="{}" stroke="{}" stroke-width="{}"/>)svg", x, y,
                     shapes[n % 6], hollow ? "#ffffff" : colour, hollow ? colour : "#ffffff",
                     hollow ? 1.6 : 0.8) +
         "\n";
}

std::string text(double x, double y, const std::string& words, const char* style = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, style, words);
}

std::string power_of_ten(int exponent) {
  return fmt::format("10<tspan dy=\"-5\" font-size=\"8\">{}{}</tspan>", exponent < 0 ? "−" : "", std::abs(exponent));
}

struct Quantity {
  const char* title;
  std::vector<double> Accuracy::* errors;
  double floor;  // what is better is drawn in the band below, side by side
};

// Better than this no crane can tell.
constexpr Quantity kQuantities[] = {{"depth error [m]", &Accuracy::depth_error, 1e-10},
                                    {"normal error [degree]", &Accuracy::normal_error, 1e-6},
                                    {"impact point error [m]", &Accuracy::point_error, 1e-3}};

constexpr double kErrorQuantile = 0.95;

}  // namespace

std::string csv(const Measurement& measurement, const Contenders& contenders, const std::vector<std::string>& circumstances) {
  std::string out;
  for (const std::string& line : circumstances) out += "# " + line + "\n";
  out += fmt::format("# the clock's own {:.1f} ns are subtracted from median_ns and p99_ns, not from mean_ns\n",
                     measurement.clock_overhead);
  for (const auto& contender : contenders) out += fmt::format("# {}: {}\n", contender->name, contender->note());
  out +=
      "scene,method,kind,poses_timed,median_ns,p99_ns,mean_ns,median_over_bullet_float,median_over_bullet_double,"
      "median_over_mujoco,poses_judged,missed,phantom,depth_error_median_m,depth_error_p99_m,normal_error_median_deg,"
      "normal_error_p99_deg,point_error_median_m,point_error_p99_m,point_outside_p99_m\n";
  for (const Result& r : measurement.results) {
    const auto over = [&](const char* name) { return cell(r.times.median / median_time(measurement, *r.scene, name)); };
    const auto errors = [](const std::vector<double>& e) { return cell(quantile(e, 0.5)) + "," + cell(quantile(e, 0.99)); };
    out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", r.scene->name, r.contender->name,
                       name_of(r.contender->kind), r.times.poses, cell(r.times.median), cell(r.times.p99),
                       cell(r.times.mean), over("Bullet float"), over("Bullet double"), over("MuJoCo"), r.accuracy.poses,
                       r.accuracy.missed, r.accuracy.phantom, errors(r.accuracy.depth_error),
                       errors(r.accuracy.normal_error), errors(r.accuracy.point_error),
                       cell(quantile(r.accuracy.point_outside, 0.99)));
  }
  return out;
}

std::string chart(const Measurement& measurement, const std::vector<Scene>& scenes, const std::string& subtitle) {
  std::vector<const Scene*> columns;
  for (const Scene& scene : scenes) {
    if (scene.touching) columns.push_back(&scene);
  }
  if (columns.empty()) throw std::invalid_argument("a chart needs a scene in contact");
  const std::size_t rows = std::size(kQuantities);
  const double width = kLeft + static_cast<double>(columns.size()) * (kPanelWidth + kGapX) + 16;
  const double bottom = kTop + static_cast<double>(rows) * (kPanelHeight + kGapY);
  std::string svg = fmt::format(
      R"svg(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0:.0f} {1:.0f}" width="{0:.0f}" height="{1:.0f}" font-family="sans-serif" font-size="11">
<style>svg {{ background: #ffffff; fill: #222222 }}</style>
<rect width="100%" height="100%" fill="#ffffff"/>
)svg",
      width, bottom + kLegend);
  svg += text(kLeft, 24, "Where do two boxes touch? Time against error", "font-size=\"16\" font-weight=\"bold\"");
  svg += text(kLeft, 42, subtitle);

  double fastest = INFINITY, slowest = 0;
  for (const Result& r : measurement.results) {
    if (!r.scene->touching) continue;
    fastest = std::min(fastest, r.times.median);
    slowest = std::max(slowest, r.times.median);
  }
  const double low_time = std::floor(std::log10(0.9 * fastest)), high_time = std::ceil(std::log10(slowest));

  for (std::size_t row = 0; row < rows; ++row) {
    const Quantity& quantity = kQuantities[row];
    const auto error_of = [&](const Result& r) { return quantile(r.accuracy.*quantity.errors, kErrorQuantile); };
    double largest = 0;
    for (const Result& r : measurement.results) {
      if (std::isfinite(error_of(r))) largest = std::max(largest, error_of(r));
    }
    const double top = kTop + static_cast<double>(row) * (kPanelHeight + kGapY);
    const LogAxis y{std::log10(quantity.floor), std::ceil(std::log10(largest)), top + kPanelHeight - kBand, top + 8};
    svg += fmt::format("<text transform=\"translate(20 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                       top + kPanelHeight / 2, quantity.title);
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const double left = kLeft + static_cast<double>(column) * (kPanelWidth + kGapX);
      const LogAxis x{low_time, high_time, left + 6, left + kPanelWidth - 6};
      if (row == 0) svg += text(left + kPanelWidth / 2, top - 8, columns[column]->name, "text-anchor=\"middle\" font-weight=\"bold\"");
      svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#dddddd\"/>\n",
                         left, top, kPanelWidth, kPanelHeight);
      for (int power = static_cast<int>(x.low); power <= static_cast<int>(x.high); ++power) {
        const double at = x.at(std::pow(10, power));
        svg += fmt::format("<path d=\"M{0:.1f},{1:.1f}V{2:.1f}\" stroke=\"#dddddd\"/>\n", at, top, top + kPanelHeight);
        if (row + 1 < rows || (power - static_cast<int>(x.low)) % 2 == 1) continue;
        const std::string label = power < 3 ? fmt::format("{} ns", std::lround(std::pow(10, power)))
                                  : power < 6 ? fmt::format("{} µs", std::lround(std::pow(10, power - 3)))
                                              : fmt::format("{} ms", std::lround(std::pow(10, power - 6)));
        const char* anchor = power == static_cast<int>(x.low) ? "start" : power == static_cast<int>(x.high) ? "end" : "middle";
        svg += text(at, top + kPanelHeight + 14, label, fmt::format("text-anchor=\"{}\" font-size=\"9\"", anchor).c_str());
      }
      const int step = y.high - y.low > 7 ? 2 : 1;
      for (int power = static_cast<int>(std::lround(y.low)); power <= static_cast<int>(y.high); power += step) {
        const double at = y.at(std::pow(10, power));
        const bool floor = power == std::lround(y.low);
        svg += fmt::format("<path d=\"M{:.1f},{:.1f}h{}\" stroke=\"{}\"/>\n", left, at, kPanelWidth, floor ? "#999999" : "#dddddd");
        if (column == 0) {
          svg += text(left - 6, at + 4, power_of_ten(power), "text-anchor=\"end\"");
          if (floor) svg += text(left - 6, at + kBand / 2 + 4, "better", "text-anchor=\"end\"");
        }
      }
      // Where a method's error is drawn: in the band the methods of one kind share a line, so that none hides another.
      const auto height = [&](const Result& r) {
        const double error = error_of(r);
        return error > quantity.floor ? y.at(error) : y.from + kBand * (0.2 + 0.2 * static_cast<double>(r.contender->kind));
      };
      // The meshes of one kind are one method at several resolutions: a line.
      for (const bool all : {true, false}) {
        std::string path;
        for (const Result& r : measurement.results) {
          const bool mine = r.scene == columns[column] && r.contender->kind == Kind::mesh &&
                            (r.contender->name.find("all") != std::string::npos) == all;
          if (!mine || !std::isfinite(error_of(r))) continue;
          path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "M" : "L", x.at(r.times.median), height(r));
        }
        svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\"{}/>\n", path, colour_of(Kind::mesh),
                           all ? "" : " stroke-dasharray=\"4 3\"");
      }
      std::string markers;  // of the first methods on top
      int shape = 0;
      Kind kind = Kind::ours;
      for (const Result& r : measurement.results) {
        if (r.scene != columns[column]) continue;
        shape = r.contender->kind == kind ? shape : 0;
        kind = r.contender->kind;
        const int n = kind == Kind::mesh ? (r.contender->name.find("all") != std::string::npos ? 0 : 6) : shape++;
        if (!std::isfinite(error_of(r))) continue;
        markers = marker(n, x.at(r.times.median), height(r), colour_of(kind)) + markers;
        const double mesh = r.contender->mesh_resolution;
        if (n == 0 && kind == Kind::mesh && (mesh == 0.5 || mesh == 0.01)) {
          svg += text(x.at(r.times.median) + 7, height(r) + 3, fmt::format("{}", mesh), "font-size=\"9\"");
        }
      }
      svg += markers;
    }
  }
  svg += text(kLeft, bottom + 18, "time of one call, median over the poses; error that 95 % of the poses stay below", "fill=\"#222222\"");

  const double column_width = 260;
  const std::pair<Kind, const char*> kinds[] = {{Kind::ours, "Quayside"}, {Kind::box_routine, "box routines"},
                                                {Kind::convex, "methods for convex bodies"},
                                                {Kind::mesh, "triangle meshes in an OBB tree"}};
  for (std::size_t k = 0; k < std::size(kinds); ++k) {
    const double left = kLeft + static_cast<double>(k) * column_width;
    double line = bottom + 44;
    svg += text(left, line, kinds[k].second, "font-weight=\"bold\"");
    if (kinds[k].first == Kind::mesh) {
      for (const bool all : {true, false}) {
        line += 18;
        svg += marker(all ? 0 : 6, left + 6, line - 4, colour_of(Kind::mesh));
        svg += text(left + 18, line, all ? "all contacts, r as labelled" : "first contact");
      }
      continue;
    }
    int shape = 0;
    for (const Result& r : measurement.results) {
      if (r.scene != columns.front() || r.contender->kind != kinds[k].first) continue;
      line += 18;
      svg += marker(shape++, left + 6, line - 4, colour_of(r.contender->kind));
      svg += text(left + 18, line, r.contender->name);
    }
  }
  return svg + "</svg>\n";
}

namespace {

// A table of methods against scenes.
std::string table(const Measurement& measurement, const std::string& title, bool of_contacts,
                  const std::function<std::string(const Result&)>& cell) {
  std::vector<const Contender*> methods;
  std::vector<const Scene*> scenes;
  for (const Result& r : measurement.results) {
    if (of_contacts && !r.scene->touching) continue;
    if (std::find(methods.begin(), methods.end(), r.contender) == methods.end()) methods.push_back(r.contender);
    if (std::find(scenes.begin(), scenes.end(), r.scene) == scenes.end()) scenes.push_back(r.scene);
  }
  std::string out = "\n## " + title + "\n\n| method |", rule = "| --- |";
  for (const Scene* scene : scenes) out += " " + scene->name + " |", rule += " --- |";
  out += "\n" + rule + "\n";
  for (const Contender* method : methods) {
    out += "| " + method->name + " |";
    for (const Scene* scene : scenes) {
      for (const Result& r : measurement.results) {
        if (r.contender == method && r.scene == scene) out += " " + cell(r) + " |";
      }
    }
    out += "\n";
  }
  return out;
}

// A time of any size with three digits, in nanoseconds.
std::string time_text(double ns) {
  const double unit = ns < 1000 ? 1 : std::pow(10, std::floor(std::log10(ns)) - 2);
  return fmt::format("{:.0f}", std::round(ns / unit) * unit);
}

std::string pair_text(double first, double second, const char* format) {
  const auto one = [&](double v) { return std::isfinite(v) ? fmt::format(fmt::runtime(format), v) : std::string("–"); };
  return one(first) + " / " + one(second);
}

}  // namespace

std::string markdown(const Measurement& measurement, const std::vector<std::string>& circumstances) {
  std::string out;
  for (const std::string& line : circumstances) out += "- " + line + "\n";
  out += fmt::format("- the clock's own {:.1f} ns are subtracted from the times of single calls, not from those of passes\n",
                     measurement.clock_overhead);
  const auto errors = [](std::vector<double> Accuracy::* which, const char* format) {
    return [=](const Result& r) {
      const std::vector<double>& e = r.accuracy.*which;
      return pair_text(quantile(e, 0.5), quantile(e, 0.99), format);
    };
  };
  out += table(measurement, "Time of a single call, median / p99 over the poses [ns]", false, [](const Result& r) {
    return time_text(r.times.median) + " / " + time_text(r.times.p99);
  });
  out += table(measurement, "Time of a call in a pass over all poses, mean [ns]", false,
               [](const Result& r) { return time_text(r.times.mean); });
  out += table(measurement, "Median time over that of Bullet (float) / MuJoCo (routine)", false, [&](const Result& r) {
    return pair_text(r.times.median / median_time(measurement, *r.scene, "Bullet float"),
                     r.times.median / median_time(measurement, *r.scene, "MuJoCo"), "{:.2f}");
  });
  out += table(measurement, "Contacts missed, or in `separated` found where there are none, of poses judged", false,
               [](const Result& r) { return fmt::format("{} of {}", r.accuracy.missed + r.accuracy.phantom, r.accuracy.poses); });
  out += table(measurement, "Depth error, median / p99 [m]", true, errors(&Accuracy::depth_error, "{:.0e}"));
  out += table(measurement, "Normal error, median / p99 [degree]", true, errors(&Accuracy::normal_error, "{:.0e}"));
  out += table(measurement, "Impact point error, median / p99 [m]", true, errors(&Accuracy::point_error, "{:.2g}"));
  return out;
}

}  // namespace quayside::peers
