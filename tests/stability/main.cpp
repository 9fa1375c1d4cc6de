// Runs the hard cases and prints, or writes, what they found.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "harness/csv.h"
#include "harness/terminal.h"
#include "tests/stability/hard_case.h"

namespace quayside::harness {
namespace {

struct Result {
  HardCase hard_case;
  std::vector<Finding> findings;
  double wall_s = 0;
};

std::string verdict(const Finding& finding) { return finding.holds() ? "pass" : "FAIL"; }

// 1 in full, a number near it by its difference: "1 − 3.2e-07".
std::string measured_text(const Finding& f) {
  if (f.expected == 0 || std::isnan(f.measured)) return format_quantity(f.measured, f.unit, 3);
  const double difference = f.measured - f.expected;
  const std::string expected = format_quantity(f.expected, f.unit, 4);
  if (difference == 0) return expected;
  return fmt::format("{} {} {}", expected, difference < 0 ? "−" : "+", format_number(std::abs(difference), 3));
}

void print(const Result& result, const Style& style) {
  fmt::print("{}  {}  {}\n", style.strong(result.hard_case.name), result.hard_case.what,
             style.faint(fmt::format("{:.2g} s", result.wall_s)));
  Table table({Table::Align::left, Table::Align::left, Table::Align::right, Table::Align::right});
  for (const Finding& f : result.findings) {
    table.add({f.holds() ? style.good("pass") : style.bad("FAIL"), f.quantity, measured_text(f),
               fmt::format("± {}", format_number(f.threshold, 3))});
    if (!f.holds() && !f.shortfall.empty()) table.add({"", "  " + f.shortfall});
  }
  fmt::print("{}\n", table.text());
}

void write_csv(const std::filesystem::path& file, const std::vector<Result>& results) {
  CsvWriter csv(file);
  for (const char* column : {"case", "quantity", "unit", "expected", "threshold", "measured", "verdict", "reason", "shortfall"}) csv.cell(column);
  csv.end_row();
  for (const Result& result : results) {
    for (const Finding& f : result.findings) {
      for (const std::string& text : {result.hard_case.name, f.quantity, f.unit}) csv.cell(text);
      for (const double number : {f.expected, f.threshold, f.measured}) csv.cell(number);
      for (const std::string& text : {verdict(f), f.reason, f.holds() ? std::string() : f.shortfall}) csv.cell(text);
      csv.end_row();
    }
  }
  csv.close();
}

void write_markdown(const std::filesystem::path& file, const std::vector<Result>& results) {
  std::string text = "# Hard cases\n\nMade by `tests/stability/run`. A number passes when it is within the threshold of what is expected.\n";
  std::vector<std::pair<std::string, std::string>> missed;  // why, and what
  std::size_t count = 0, passed = 0;
  for (const Result& result : results) {
    text += fmt::format("\n## {}: {}\n\n| | expected | threshold | measured | | threshold because |\n| --- | --- | --- | --- | --- | --- |\n",
                        result.hard_case.name, result.hard_case.what);
    for (const Finding& f : result.findings) {
      text += fmt::format("| {} | {} | {} | {} | {} | {} |\n", f.quantity, format_quantity(f.expected, f.unit, 4),
                          format_number(f.threshold, 3), measured_text(f), f.holds() ? "pass" : "**FAIL**", f.reason);
      ++count;
      passed += f.holds();
      if (f.holds()) continue;
      const std::string why = f.shortfall.empty() ? "not explained yet" : f.shortfall;
      const std::string what = fmt::format("{}: {}", result.hard_case.name, f.quantity);
      const auto same = std::find_if(missed.begin(), missed.end(), [&](const auto& entry) { return entry.first == why; });
      if (same == missed.end()) missed.emplace_back(why, what);
      else same->second += "; " + f.quantity;
    }
  }
  text += fmt::format("\n{} of {} pass.\n", passed, count);
  if (!missed.empty()) text += "\n## Missed, and why\n\n";
  for (const auto& [why, what] : missed) text += fmt::format("- {}. {}.\n", what, why);
  std::ofstream stream(file);
  if (!(stream << text).flush()) throw std::runtime_error("cannot write '" + file.string() + "'");
}

int run(const std::vector<std::string>& only, contact_nn::Model model, bool whole, const std::string& csv, const std::string& markdown) {
  const Style style = style_for(1);
  std::vector<Result> results;
  std::size_t count = 0, passed = 0;
  bool acceptable = true;
  for (const HardCase& hard_case : hard_cases()) {
    if (!only.empty() && std::find(only.begin(), only.end(), hard_case.name) == only.end()) continue;
    const auto start = std::chrono::steady_clock::now();
    Findings findings;
    hard_case.run({model, whole}, findings);
    Result result{hard_case, findings.take(), std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
    print(result, style);
    for (const Finding& f : result.findings) ++count, passed += f.holds(), acceptable &= f.acceptable();
    results.push_back(std::move(result));
  }
  fmt::print("{} of {} pass\n", passed, count);
  if (!csv.empty()) write_csv(csv, results);
  if (!markdown.empty()) write_markdown(markdown, results);
  return acceptable ? 0 : 1;
}

}  // namespace
}  // namespace quayside::harness

int main(int argc, char** argv) {
  using namespace quayside;
  CLI::App app{"Hard cases for the simulator, each with what must come out and how near.", "hard_cases"};
  std::vector<std::string> only, names;
  for (const auto& hard_case : harness::hard_cases()) names.push_back(hard_case.name);
  std::string csv, markdown;
  bool exact = false, quick = false;
  app.add_option("--only", only, "These cases alone")->check(CLI::IsMember(names));
  app.add_flag("--exact", exact, "Contacts by the exact module, without the network");
  app.add_flag("--quick", quick, "As the tests run them: the longest parts shortened or left out");
  app.add_option("--csv", csv, "Write every number to this file");
  app.add_option("--markdown", markdown, "Write tables to this file");
  CLI11_PARSE(app, argc, argv);
  return harness::run(only, exact ? contact_nn::Model::exact : contact_nn::Model::committee, !quick, csv, markdown);
}
