// As much of JSON Schema as the case format uses, for the tests that hold loader and schema together.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cases/document.h"

namespace quayside::cases {

using nlohmann::json;

// A document as JSON: unquoted scalars become booleans and numbers where they are such.
json to_json(const Node& node);

class SchemaCheck {
 public:
  explicit SchemaCheck(json root) : root_(std::move(root)) {}

  // What is wrong with the instance, "path: reason" each; empty if nothing. Throws std::logic_error for a keyword it
  // does not know.
  std::vector<std::string> problems(const json& instance) const { return problems(root_, instance, ""); }

  // Visits every value of a valid instance with its path ("containers.0.mass") and the schema that describes it:
  // references resolved, alternatives chosen.
  using Visitor = std::function<void(const std::string& path, const json& schema, const json& value)>;
  void walk(const json& instance, const Visitor& visit) const { walk(root_, instance, "", visit); }

  // Visits the schemas of all mappings, references resolved.
  void mappings(const std::function<void(const json& schema)>& visit) const { mappings(root_, visit); }

 private:
  json resolve(json schema) const;
  std::vector<std::string> problems(const json& schema, const json& value, const std::string& path) const;
  void walk(const json& schema, const json& value, const std::string& path, const Visitor& visit) const;
  void mappings(const json& schema, const std::function<void(const json&)>& visit) const;

  json root_;
};

}  // namespace quayside::cases
