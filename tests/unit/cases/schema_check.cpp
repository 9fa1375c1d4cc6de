#include "tests/unit/cases/schema_check.h"

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <stdexcept>

namespace quayside::cases {
namespace {

std::string join(const std::string& path, const std::string& key) { return path.empty() ? key : path + "." + key; }

bool has_type(const json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "number") return value.is_number();
  if (type == "boolean") return value.is_boolean();
  throw std::logic_error("unknown type " + type);
}

}  // namespace

json to_json(const Node& node) {
  switch (node.kind) {
    case Node::Kind::nothing:
      return nullptr;
    case Node::Kind::list: {
      json list = json::array();
      for (const Node& item : node.items) list.push_back(to_json(item));
      return list;
    }
    case Node::Kind::mapping: {
      json mapping = json::object();
      for (std::size_t i = 0; i < node.keys.size(); ++i) mapping[node.keys[i].text] = to_json(node.items[i]);
      return mapping;
    }
    case Node::Kind::scalar:
      break;
  }
  if (node.quoted) return node.text;
  if (node.text == "true" || node.text == "false") return node.text == "true";
  char* end = nullptr;
  const double number = std::strtod(node.text.c_str(), &end);
  if (*end == '\0') return number;
  return node.text;
}

json SchemaCheck::resolve(json schema) const {
  while (schema.contains("$ref")) {
    const std::string reference = schema["$ref"];
    schema.erase("$ref");
    json target = root_.at(json::json_pointer(reference.substr(1)));  // "#/$defs/..."
    for (const auto& [key, value] : schema.items()) target[key] = value;
    schema = std::move(target);
  }
  return schema;
}

std::vector<std::string> SchemaCheck::problems(const json& unresolved, const json& value,
                                               const std::string& path) const {
  const json schema = resolve(unresolved);
  std::vector<std::string> found;
  const auto add = [&](const std::string& reason) { found.push_back(path + ": " + reason); };
  const auto append = [&](const std::vector<std::string>& more) {
    found.insert(found.end(), more.begin(), more.end());
  };
  const auto matches = [&](const json& alternatives) {
    int count = 0;
    for (const json& alternative : alternatives) count += problems(alternative, value, path).empty();
    return count;
  };
  const json& properties = schema.value("properties", json::object());
  for (const auto& [keyword, rule] : schema.items()) {
    if (keyword == "$schema" || keyword == "$defs" || keyword == "title" || keyword == "description" ||
        keyword == "default") {
      continue;  // no rules
    } else if (keyword == "type") {
      if (!has_type(value, rule)) add("not of type " + rule.get<std::string>());
    } else if (keyword == "enum") {
      if (std::find(rule.begin(), rule.end(), value) == rule.end()) add("not in " + rule.dump());
    } else if (keyword == "minimum") {
      if (value.is_number() && value < rule) add("below " + rule.dump());
    } else if (keyword == "maximum") {
      if (value.is_number() && value > rule) add("above " + rule.dump());
    } else if (keyword == "minLength") {
      if (value.is_string() && value.get<std::string>().size() < rule) add("too short");
    } else if (keyword == "maxLength") {
      if (value.is_string() && value.get<std::string>().size() > rule) add("too long");
    } else if (keyword == "pattern") {
      if (value.is_string() && !std::regex_search(value.get<std::string>(), std::regex(rule.get<std::string>()))) {
        add("does not match " + rule.dump());
      }
    } else if (keyword == "minItems") {
      if (value.is_array() && value.size() < rule) add("too few items");
    } else if (keyword == "maxItems") {
      if (value.is_array() && value.size() > rule) add("too many items");
    } else if (keyword == "items") {
      for (std::size_t i = 0; value.is_array() && i < value.size(); ++i) {
        append(problems(rule, value[i], join(path, std::to_string(i))));
      }
    } else if (keyword == "minProperties") {
      if (value.is_object() && value.size() < rule) add("too few keys");
    } else if (keyword == "maxProperties") {
      if (value.is_object() && value.size() > rule) add("too many keys");
    } else if (keyword == "required") {
      for (const std::string key : rule) {
        if (value.is_object() && !value.contains(key)) add("without " + key);
      }
    } else if (keyword == "dependentRequired") {
      for (const auto& [key, others] : rule.items()) {
        for (const std::string other : others) {
          if (value.is_object() && value.contains(key) && !value.contains(other)) add("without " + other);
        }
      }
    } else if (keyword == "properties") {
      if (!value.is_object()) continue;
      for (const auto& [key, item] : value.items()) {
        if (rule.contains(key)) append(problems(rule[key], item, join(path, key)));
      }
    } else if (keyword == "additionalProperties") {
      if (rule != false) throw std::logic_error("additionalProperties other than false");
      if (!value.is_object()) continue;
      for (const auto& [key, item] : value.items()) {
        if (!properties.contains(key)) add("unknown key " + key);
      }
    } else if (keyword == "oneOf") {
      if (matches(rule) != 1) add("not exactly one of " + std::to_string(rule.size()) + " alternatives");
    } else if (keyword == "anyOf") {
      if (matches(rule) == 0) add("none of " + std::to_string(rule.size()) + " alternatives");
    } else {
      throw std::logic_error("unknown keyword " + keyword);
    }
  }
  return found;
}

void SchemaCheck::walk(const json& unresolved, const json& value, const std::string& path, const Visitor& visit) const {
  const json schema = resolve(unresolved);
  // Alternatives that are whole descriptions, not mere lists of required keys.
  if (schema.contains("oneOf") && !schema.contains("properties")) {
    for (const json& alternative : schema["oneOf"]) {
      if (problems(alternative, value, path).empty()) walk(alternative, value, path, visit);
    }
    return;
  }
  visit(path, schema, value);
  if (value.is_object()) {
    for (const auto& [key, item] : value.items()) walk(schema["properties"][key], item, join(path, key), visit);
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i)
      walk(schema["items"], value[i], join(path, std::to_string(i)), visit);
  }
}

void SchemaCheck::mappings(const json& unresolved, const std::function<void(const json&)>& visit) const {
  const json schema = resolve(unresolved);
  if (schema.contains("properties")) {
    visit(schema);
    for (const auto& [key, property] : schema["properties"].items()) mappings(property, visit);
  }
  if (schema.contains("items")) mappings(schema["items"], visit);
  if (schema.contains("oneOf") && !schema.contains("properties")) {
    for (const json& alternative : schema["oneOf"]) mappings(alternative, visit);
  }
}

}  // namespace quayside::cases
