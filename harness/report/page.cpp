#include "harness/report/page.h"

#include <fstream>
#include <stdexcept>
#include <string_view>

namespace quayside::harness::report {

// Generated from page/ (embed_page.cmake).
std::string_view page_template();

namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') out += "&amp;";
    else if (c == '<') out += "&lt;";
    else if (c == '"') out += "&quot;";
    else out += c;
  }
  return out;
}

// JSON that no "</script>" or "<!--" within a name can end; bytes that are no UTF-8 become U+FFFD.
std::string embedded_json(const nlohmann::ordered_json& data) {
  const std::string text = data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '<') out += "\\u003c";
    else out += c;
  }
  return out;
}

}  // namespace

std::string page(const std::string& kind, const std::string& title, const nlohmann::ordered_json& data) {
  const std::string_view source = page_template();
  std::string html;
  std::size_t done = 0;
  while (true) {
    const std::size_t begin = source.find("{{", done), end = source.find("}}", begin);
    if (begin == std::string_view::npos || end == std::string_view::npos) break;
    const std::string_view key = source.substr(begin + 2, end - begin - 2);
    html += source.substr(done, begin - done);
    if (key == "title") html += escaped(title);
    else if (key == "kind") html += kind;
    else if (key == "data") html += embedded_json(data);
    else html += source.substr(begin, end + 2 - begin);
    done = end + 2;
  }
  return html + std::string(source.substr(done));
}

void write_page(const std::string& file, const std::string& html) {
  std::ofstream stream(file, std::ios::binary);
  stream << html;
  stream.close();
  if (!stream) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace quayside::harness::report
