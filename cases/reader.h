// Typed reading of a document: a cursor that knows the file, the line, the path of keys and what it expects there.
// Every refusal reads "file:line: key.path: what is wrong, expected ...".
#pragma once

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "cases/document.h"
#include "cases/limits.h"

namespace quayside::cases {

class Mapping;

// A value of the document, or the place where one is missing: reading a missing value is refused like any other wrong
// value. The document must outlive it.
class Value {
 public:
  Value(const std::filesystem::path& file, const Node& root) : file_(&file), node_(&root), origin_(root.origin) {}

  double number(const limits::Range& range) const;
  bool boolean() const;
  std::string text() const;  // one line of at most limits::kMaxText characters, not empty
  std::string name() const;  // a letter, then letters, digits, '_' and '-'
  template <int n>
  Eigen::Matrix<double, n, 1> vector(const limits::Range& range) const;
  std::string word(std::initializer_list<const char*> words) const;  // one of these
  template <class T>
  T choice(std::initializer_list<std::pair<const char*, T>> words) const;
  std::vector<Value> list(std::size_t most) const;
  Mapping mapping(std::initializer_list<const char*> accepted) const;

  bool is_scalar() const { return node_ && node_->kind == Node::Kind::scalar; }
  bool is_scalar(const char* text) const { return is_scalar() && node_->text == text; }
  bool is_mapping() const { return node_ && node_->kind == Node::Kind::mapping; }
  bool is_list() const { return node_ && node_->kind == Node::Kind::list; }

  bool is_number() const;

  // Whether a mapping has this key; to choose how to read it.
  bool has(const char* key) const { return is_mapping() && node_->find(key); }
  // The value of a key of this mapping, missing if it does not have it.
  Value child(const char* key) const;

  const Origin& origin() const { return origin_; }

  // Throws: "… found <this value>, expected <expectation>".
  [[noreturn]] void expected(const std::string& expectation) const;
  // Throws: "… <message>".
  [[noreturn]] void refuse(const std::string& message) const;

 private:
  friend class Mapping;
  Value(const Value& parent, const std::string& key, const Node* node, const Origin& origin);

  void check_length(const std::string& text, std::size_t most) const;
  std::size_t choose(const std::vector<std::string>& words) const;
  std::vector<double> numbers(std::size_t count, const limits::Range& range) const;

  const std::filesystem::path* file_;
  const Node* node_;  // null: missing
  Origin origin_;     // of the value, of its key, or of the mapping that lacks it
  std::string path_;
};

// A mapping whose keys are all known.
class Mapping {
 public:
  // Throws for another kind of value and for a key that is not accepted, with the nearest one that is.
  Mapping(const Value& value, std::initializer_list<const char*> accepted);

  // The value of an accepted key: missing, or empty, if it is not given.
  Value operator[](const char* key) const;
  std::optional<Value> find(const char* key) const;

  // Sets the target if the key is given.
  template <class Number>
  void number(const char* key, const limits::Range& range, Number& target) const {
    if (const auto value = find(key)) target = value->number(range);
  }
  void boolean(const char* key, bool& target) const {
    if (const auto value = find(key)) target = value->boolean();
  }
  template <int n, class Vector>
  void vector(const char* key, const limits::Range& range, Vector& target) const {
    if (const auto value = find(key)) target = value->vector<n>(range);
  }

 private:
  Value value_;
  std::vector<const char*> accepted_;
};

// " (did you mean 'x'?)" for the candidate with the fewest edits from `word`, or empty if none is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& candidates);

template <int n>
Eigen::Matrix<double, n, 1> Value::vector(const limits::Range& range) const {
  return Eigen::Map<const Eigen::Matrix<double, n, 1>>(numbers(n, range).data());
}

template <class T>
T Value::choice(std::initializer_list<std::pair<const char*, T>> words) const {
  std::vector<std::string> names;
  for (const auto& [name, value] : words) names.push_back(name);
  return (words.begin() + choose(names))->second;
}

}  // namespace quayside::cases
