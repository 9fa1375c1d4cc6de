#include "harness/csv.h"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

namespace quayside::harness {

CsvWriter::CsvWriter(const std::filesystem::path& file) : file_(file), stream_(file, std::ios::binary | std::ios::trunc) {
  if (!stream_) throw std::runtime_error(fmt::format("cannot write {}: {}", file.string(), std::strerror(errno)));
}

void CsvWriter::separate() {
  if (!first_) row_ += ',';
  first_ = false;
}

void CsvWriter::cell(const std::string& text) {
  separate();
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    row_ += text;
    return;
  }
  row_ += '"';
  for (const char c : text) row_.append(c == '"' ? 2 : 1, c);
  row_ += '"';
}

void CsvWriter::cell(double number) {
  separate();
  char digits[32];  // the longest shortest form has 24 characters
  row_.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
}

void CsvWriter::end_row() {
  row_ += '\n';
  stream_ << row_;
  row_.clear();
  first_ = true;
}

void CsvWriter::close() {
  stream_.close();
  if (!stream_) throw std::runtime_error(fmt::format("cannot write {} to its end: {}", file_.string(), std::strerror(errno)));
}

CsvReader::CsvReader(const std::filesystem::path& file) : file_(file), stream_(file, std::ios::binary) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    throw std::runtime_error(fmt::format("{}: is a directory, expected a CSV file", file.string()));
  }
  if (!stream_) throw std::runtime_error(fmt::format("cannot read {}: {}", file.string(), std::strerror(errno)));
}

void CsvReader::fail(const std::string& what) const {
  throw std::runtime_error(fmt::format("{}:{}: {}", file_.string(), line_, what));
}

bool CsvReader::next_row(std::vector<std::string>& cells) {
  do {
    if (!std::getline(stream_, text_)) {
      if (stream_.bad()) fail(fmt::format("cannot read on: {}", std::strerror(errno)));
      return false;
    }
    ++line_;
    if (line_ == 1 && text_.compare(0, 3, "\xEF\xBB\xBF") == 0) text_.erase(0, 3);
    if (!text_.empty() && text_.back() == '\r') text_.pop_back();
  } while (text_.empty());

  cells.assign(1, "");
  bool quoted = false;
  for (std::size_t i = 0; i < text_.size(); ++i) {
    const char c = text_[i];
    if (quoted && c == '"' && text_.compare(i, 2, "\"\"") == 0) {
      cells.back() += c;
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  if (quoted) fail("a quotation mark is not closed on its line");
  return true;
}

double CsvReader::number(const std::string& cell, const std::string& column) const {
  const std::size_t begin = cell.find_first_not_of(" \t");
  const std::size_t end = cell.find_last_not_of(" \t") + 1;
  double value = 0;
  const char* last = cell.data() + end;
  const auto [rest, error] = std::from_chars(cell.data() + (begin == std::string::npos ? end : begin), last, value);
  if (error == std::errc::result_out_of_range) fail(fmt::format("column \"{}\": {} does not fit a double", column, cell));
  if (error != std::errc() || rest != last) fail(fmt::format("column \"{}\": expected a number, found \"{}\"", column, cell));
  return value;
}

}  // namespace quayside::harness
