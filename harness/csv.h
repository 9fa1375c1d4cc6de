// Comma-separated values (RFC 4180) with numbers that read back to the same bits.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace quayside::harness {

// Collects cells and writes them row by row. Throws std::runtime_error when the file cannot be written.
class CsvWriter {
 public:
  explicit CsvWriter(const std::filesystem::path& file);
  void cell(const std::string& text);  // quoted where it has to be
  void cell(double number);            // shortest decimal that reads back to the same double
  void end_row();
  void close();

 private:
  void separate();

  std::filesystem::path file_;
  std::ofstream stream_;
  std::string row_;
  bool first_ = true;
};

// Reads row by row; takes CR LF, a byte order mark and empty lines as they come. Every complaint is a std::runtime_error
// "file:line: what is wrong".
class CsvReader {
 public:
  explicit CsvReader(const std::filesystem::path& file);
  // The cells of the next row that is not empty; false at the end of the file.
  bool next_row(std::vector<std::string>& cells);
  double number(const std::string& cell, const std::string& column) const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::filesystem::path file_;
  std::ifstream stream_;
  std::string text_;
  int line_ = 0;
};

}  // namespace quayside::harness
