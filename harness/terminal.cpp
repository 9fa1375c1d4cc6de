#include "harness/terminal.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace quayside::harness {

namespace {

constexpr double kShownAfter = 1.0;       // a bar for what is over in a moment only flickers [s]
constexpr double kRedrawInterval = 0.1;   // [s]
constexpr std::size_t kBarCells = 30;
constexpr std::size_t kUsualWidth = 80;   // of a terminal that does not tell
constexpr double kTrustedFraction = 0.01; // of the work, before which the time left is a guess

std::size_t terminal_width(int file_descriptor) {
  winsize size{};
  return ioctl(file_descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsualWidth;
}

}  // namespace

std::string format_number(double value, int digits) { return fmt::format("{:.{}g}", value, digits); }

std::string format_quantity(double value, const std::string& unit, int digits) {
  const std::string number = format_number(value, digits);
  return unit.empty() || unit == "1" ? number : number + " " + unit;
}

std::string format_duration(double seconds) {
  if (!std::isfinite(seconds)) return format_number(seconds) + " s";
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const long whole = std::lround(seconds);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::size_t display_width(const std::string& text) {
  std::size_t width = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\033') {  // a colour: up to its 'm'
      while (i < text.size() && text[i] != 'm') ++i;
      continue;
    }
    const bool continues_a_character = (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80;
    if (!continues_a_character) ++width;
  }
  return width;
}

void Table::add(std::vector<std::string> cells) {
  assert(cells.size() <= columns_.size());
  cells.resize(columns_.size());
  rows_.push_back(std::move(cells));
}

std::string Table::text(const std::string& indent) const {
  std::vector<std::size_t> widths(columns_.size(), 0);
  for (const auto& row : rows_)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], display_width(row[c]));

  std::string text;
  for (const auto& row : rows_) {
    std::string line = indent;
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (widths[c] == 0) continue;
      const std::string padding(widths[c] - display_width(row[c]), ' ');
      line += columns_[c] == Align::right ? padding + row[c] : row[c] + padding;
      line += "  ";
    }
    const auto last = line.find_last_not_of(' ');
    line.resize(last == std::string::npos ? 0 : last + 1);
    text += line + "\n";
  }
  return text;
}

std::string Style::painted(const std::string& text, const char* code) const {
  return colours ? fmt::format("\033[{}m{}\033[0m", code, text) : text;
}

Style style_for(int file_descriptor) {
  const char* no_color = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  const bool refused = (no_color != nullptr && *no_color != '\0') || (term != nullptr && std::strcmp(term, "dumb") == 0);
  return {isatty(file_descriptor) == 1 && !refused};
}

std::string progress_line(const std::string& label, double fraction, double elapsed_s, std::size_t width) {
  fraction = std::clamp(fraction, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(fraction * kBarCells);
  std::string line = fmt::format("{}  [{}{}] {:3.0f} %", label, std::string(filled, '#'),
                                 std::string(kBarCells - filled, '-'), std::floor(100 * fraction));
  if (fraction >= kTrustedFraction) line += "  " + format_duration(elapsed_s * (1 - fraction) / fraction) + " left";
  // By characters of UTF-8, so that none is cut in two.
  while (display_width(line) > width) {
    while (!line.empty() && (static_cast<unsigned char>(line.back()) & 0xC0) == 0x80) line.pop_back();
    line.pop_back();
  }
  return line;
}

ProgressBar::ProgressBar(std::string label, bool wanted)
    : label_(std::move(label)), active_(wanted && isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::clear() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

void ProgressBar::update(double fraction) {
  if (!active_) return;
  const auto now = Clock::now();
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  if (elapsed < kShownAfter || std::chrono::duration<double>(now - last_drawn_).count() < kRedrawInterval) return;
  last_drawn_ = now;
  drawn_ = true;
  const std::string line = progress_line(label_, fraction, elapsed, terminal_width(STDERR_FILENO) - 1);
  std::fprintf(stderr, "\r%s\033[K", line.c_str());
  std::fflush(stderr);
}

}  // namespace quayside::harness
