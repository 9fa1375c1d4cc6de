// Text for people: numbers, plain tables, colours where there is a terminal, a progress bar.
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace quayside::harness {

// A number with at most `digits` significant ones, "5.182", "1.2e-07".
std::string format_number(double value, int digits = 6);

// With its unit where it has one: "5.182 m"; "1" and "" are none.
std::string format_quantity(double value, const std::string& unit, int digits = 6);

// Seconds as people say them: "0.4 s", "12 s", "3 min 20 s", "2 h 5 min".
std::string format_duration(double seconds);

// Columns that a text takes on the terminal: characters of UTF-8, without colours.
std::size_t display_width(const std::string& text);

// Rows of cells, every column as wide as its widest cell, two spaces between.
class Table {
 public:
  enum class Align { left, right };
  explicit Table(std::vector<Align> columns) : columns_(std::move(columns)) {}

  void add(std::vector<std::string> cells);  // missing cells at the end are empty
  bool empty() const { return rows_.empty(); }
  std::string text(const std::string& indent = "  ") const;  // one line per row, each ended

 private:
  std::vector<Align> columns_;
  std::vector<std::vector<std::string>> rows_;
};

// Colours, or none: on a terminal that does not say NO_COLOR or TERM=dumb.
struct Style {
  bool colours = false;
  std::string good(const std::string& text) const { return painted(text, "32"); }
  std::string bad(const std::string& text) const { return painted(text, "31"); }
  std::string strong(const std::string& text) const { return painted(text, "1"); }
  std::string faint(const std::string& text) const { return painted(text, "2"); }

 private:
  std::string painted(const std::string& text, const char* code) const;
};
Style style_for(int file_descriptor);

// "label  [#####-----]  43 %  12 s left", cut to `width`.
std::string progress_line(const std::string& label, double fraction, double elapsed_s, std::size_t width);

// On stderr, where that is a terminal and the work takes longer than a second; gone when it is destroyed or cleared.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label, bool wanted = true);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(double fraction);
  void clear();  // to print something else; the next update draws it again
  void relabel(std::string label) { label_ = std::move(label); }

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool active_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_drawn_ = start_;
};

}  // namespace quayside::harness
