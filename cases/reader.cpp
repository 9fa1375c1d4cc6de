#include "cases/reader.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cases/case.h"
#include "cases/edit_distance.h"

namespace quayside::cases {
namespace {

constexpr std::size_t kQuoted = 40;  // characters of a wrong value that a message repeats

std::string quoted(const std::string& text) {
  return text.size() <= kQuoted ? "'" + text + "'" : "'" + text.substr(0, kQuoted) + "...'";
}

std::string describe(const Node* node) {
  if (!node) return "missing";
  switch (node->kind) {
    case Node::Kind::nothing:
      return "found nothing";
    case Node::Kind::scalar:
      return "found " + quoted(node->text) + (node->quoted ? " (in quotes)" : "");
    case Node::Kind::list:
      return fmt::format("found a list of {}", node->items.size());
    case Node::Kind::mapping:
      return "found a mapping";
  }
  return "";
}

std::string describe(const limits::Range& range) {
  const std::string unit = *range.unit ? fmt::format(" {}", range.unit) : "";
  return fmt::format("a number from {} to {}{}", range.low, range.high, unit);
}

// A decimal number and nothing else; YAML's names for infinity and NaN are read as well, for the range to refuse.
std::optional<double> parse_number(std::string text) {
  if (!text.empty() && text[0] == '+') text.erase(0, 1);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (end != text.data() + text.size() || text.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return HUGE_VAL;
  if (error != std::errc()) return std::nullopt;
  return number;
}

}  // namespace

// Two slips, or one in three letters, are taken for a misspelling; words that share no letter are not alike.
std::string suggestion(const std::string& word, const std::vector<std::string>& candidates) {
  if (word.size() > limits::kMaxName) return "";
  std::string nearest;
  std::size_t fewest = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t edits = edit_distance(word, candidate);
    if (edits < fewest && edits < std::max(word.size(), candidate.size())) {
      fewest = edits;
      nearest = candidate;
    }
  }
  return nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest);
}

Value::Value(const Value& parent, const std::string& key, const Node* node, const Origin& origin)
    : file_(parent.file_), node_(node), origin_(origin), path_(parent.path_.empty() ? key : parent.path_ + "." + key) {}

void Value::refuse(const std::string& message) const {
  throw CaseError(fmt::format("{}: {}{}{}", location(*file_, origin_), path_, path_.empty() ? "" : ": ", message));
}

void Value::expected(const std::string& expectation) const { refuse(describe(node_) + ", expected " + expectation); }

Value Value::child(const char* key) const {
  assert(is_mapping());
  for (std::size_t i = 0; i < node_->keys.size(); ++i) {
    if (node_->keys[i].text != key) continue;
    // A list or mapping may begin on the line after its key; people look for the key.
    const Node& item = node_->items[i];
    const bool by_key = item.kind != Node::Kind::scalar && item.origin.override_text.empty();
    return Value(*this, key, &item, by_key ? node_->keys[i].origin : item.origin);
  }
  return Value(*this, key, nullptr, origin_);
}

bool Value::is_number() const { return is_scalar() && !node_->quoted && parse_number(node_->text); }

double Value::number(const limits::Range& range) const {
  const auto number = is_number() ? parse_number(node_->text) : std::nullopt;
  if (!number || !(*number >= range.low && *number <= range.high)) expected(describe(range));
  return *number;
}

bool Value::boolean() const { return choice<bool>({{"true", true}, {"false", false}}); }

void Value::check_length(const std::string& text, std::size_t most) const {
  if (text.empty() || text.size() > most) expected(fmt::format("a text of 1 to {} characters", most));
  if (text.find('\n') != std::string::npos) expected("a text of one line");
}

std::string Value::text() const {
  if (!is_scalar()) expected("a text");
  check_length(node_->text, limits::kMaxText);
  return node_->text;
}

std::string Value::name() const {
  if (!is_scalar()) expected("a name");
  check_length(node_->text, limits::kMaxName);
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto is_inner = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-'; };
  const std::string& name = node_->text;
  if (!is_letter(name[0]) || !std::all_of(name.begin(), name.end(), is_inner)) {
    expected("a name: a letter, then letters, digits, '_' or '-'");
  }
  return name;
}

std::size_t Value::choose(const std::vector<std::string>& words) const {
  const std::string list = fmt::format("one of: {}", fmt::join(words, ", "));
  if (!is_scalar()) expected(list);
  const auto found = std::find(words.begin(), words.end(), node_->text);
  if (found == words.end()) {
    refuse(fmt::format("{}{}, expected {}", describe(node_), suggestion(node_->text, words), list));
  }
  return static_cast<std::size_t>(found - words.begin());
}

std::string Value::word(std::initializer_list<const char*> words) const {
  const std::vector<std::string> names(words.begin(), words.end());
  return names[choose(names)];
}

std::vector<Value> Value::list(std::size_t most) const {
  if (!is_list()) expected("a list");
  if (node_->items.size() > most) expected(fmt::format("a list of at most {}", most));
  std::vector<Value> values;
  for (std::size_t i = 0; i < node_->items.size(); ++i) {
    values.push_back(Value(*this, std::to_string(i), &node_->items[i], node_->items[i].origin));
  }
  return values;
}

std::vector<double> Value::numbers(std::size_t count, const limits::Range& range) const {
  const auto expect_list = [&] { expected(fmt::format("a list of {} numbers, each {}", count, describe(range))); };
  if (!is_list() || node_->items.size() != count) expect_list();
  std::vector<double> numbers;
  for (const Value& value : list(count)) numbers.push_back(value.number(range));
  return numbers;
}

Mapping Value::mapping(std::initializer_list<const char*> accepted) const { return Mapping(*this, accepted); }

Mapping::Mapping(const Value& value, std::initializer_list<const char*> accepted) : value_(value), accepted_(accepted) {
  const std::vector<std::string> names(accepted.begin(), accepted.end());
  const std::string list = fmt::format("{}", fmt::join(names, ", "));
  if (!value.is_mapping()) value.expected("a mapping with the keys: " + list);
  for (const Key& key : value.node_->keys) {
    if (std::find(names.begin(), names.end(), key.text) != names.end()) continue;
    Value at_key = value;
    at_key.origin_ = key.origin;
    at_key.refuse(
        fmt::format("unknown key {}{}, expected one of: {}", quoted(key.text), suggestion(key.text, names), list));
  }
}

Value Mapping::operator[](const char* key) const {
  assert(std::find(accepted_.begin(), accepted_.end(), std::string(key)) != accepted_.end());
  return value_.child(key);
}

std::optional<Value> Mapping::find(const char* key) const {
  const Value value = (*this)[key];
  return value_.has(key) ? std::optional(value) : std::nullopt;
}

}  // namespace quayside::cases
