// The reference of the case format as Markdown, from the JSON Schema that the loader is tested against.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "cases/case.h"
#include "harness/commands/commands.h"

namespace quayside::harness {
namespace {

using Json = nlohmann::ordered_json;

class CaseFormat {
 public:
  CaseFormat() : schema_(Json::parse(cases::case_schema())) {}

  std::string markdown() const {
    std::string text =
        "# The case format\n\n"
        "Generated from `cases/schema.json` by `quayside case-format`; the guide with examples is `cases/README.md`.\n\n" +
        schema_.at("description").get<std::string>() + "\n\n";
    std::string top = kHeader, sections;
    for (const auto& [key, value] : schema_.at("properties").items()) {
      const Json node = resolved(value);
      top += row(is_section(node) ? fmt::format("[`{0}`](#{0})", key) : "`" + key + "`", node, is_required(schema_, key));
      if (is_section(node)) sections += section(key, node);
    }
    return text + top + sections;
  }

 private:
  static constexpr const char* kHeader = "| key | value | default | meaning |\n| --- | --- | --- | --- |\n";

  // A node with its $ref replaced by what it refers to; what stands beside the $ref goes first.
  Json resolved(Json node) const {
    while (node.contains("$ref")) {
      const std::string pointer = node["$ref"].get<std::string>().substr(1);  // without "#"
      node.erase("$ref");
      Json target = schema_.at(Json::json_pointer(pointer));
      target.update(node);
      node = target;
    }
    return node;
  }

  static bool is_required(const Json& object, const std::string& key) {
    if (!object.contains("required")) return false;
    for (const Json& name : object["required"])
      if (name == key) return true;
    return false;
  }

  // What an array or a choice is made of, as far as these are mappings.
  std::vector<Json> mappings(const Json& node) const {
    std::vector<Json> found;
    if (node.contains("properties")) found.push_back(node);
    if (node.contains("items") && node["items"].is_object())
      for (Json& inner : mappings(resolved(node["items"]))) found.push_back(std::move(inner));
    if (!node.contains("properties") && node.contains("oneOf"))
      for (const Json& choice : node["oneOf"])
        for (Json& inner : mappings(resolved(choice))) found.push_back(std::move(inner));
    return found;
  }
  bool is_section(const Json& node) const { return !mappings(node).empty(); }

  static std::string number(const Json& value) { return value.is_number() ? fmt::format("{:g}", value.get<double>()) : value.dump(); }

  static std::string bounds(const Json& node, const char* least, const char* most) {
    return fmt::format(" from {} to {}", number(node.at(least)), number(node.at(most)));
  }

  std::string value_text(const Json& node) const {
    if (node.contains("enum")) {
      std::vector<std::string> words;
      for (const Json& word : node["enum"]) words.push_back("`" + word.get<std::string>() + "`");
      return fmt::format("{}", fmt::join(words, ", "));
    }
    if (node.contains("oneOf") && !node.contains("properties")) {
      std::vector<std::string> choices;
      for (const Json& choice : node["oneOf"]) choices.push_back(value_text(resolved(choice)));
      return fmt::format("{}", fmt::join(choices, "; or "));
    }
    const std::string type = node.value("type", "");
    if (type == "number") return "number" + (node.contains("minimum") && node.contains("maximum") ? bounds(node, "minimum", "maximum") : "");
    if (type == "boolean") return "`true`, `false`";
    if (type == "string") return node.contains("pattern") ? "name" : "text";
    if (type == "array" && node.contains("minItems") && node.contains("items"))
      return fmt::format("[{} of: {}]", node["minItems"].get<int>(), value_text(resolved(node["items"])));
    if (type == "array") return "list";
    return type == "object" ? "mapping" : type;
  }

  std::string row(const std::string& key, const Json& node, bool required) const {
    std::string standard;
    if (node.contains("default")) standard = node["default"].is_string() ? "`" + node["default"].get<std::string>() + "`" : number(node["default"]);
    if (required) standard = "required";
    return fmt::format("| {} | {} | {} | {} |\n", key, value_text(node), standard, node.value("description", ""));
  }

  // Keys of a mapping and of the mappings in it, as paths.
  std::string rows(const Json& mapping, const std::string& path) const {
    std::string text;
    for (const auto& [key, value] : mapping.at("properties").items()) {
      const Json node = resolved(value);
      text += row("`" + path + key + "`", node, is_required(mapping, key));
      const std::string inner_path = path + key + (node.value("type", "") == "array" ? "[]." : ".");
      for (const Json& inner : mappings(node)) text += rows(inner, inner_path);
    }
    return text;
  }

  std::string section(const std::string& key, const Json& node) const {
    const bool list = node.value("type", "") == "array";
    std::string text = fmt::format("\n## {}\n{}", key, list ? "\nA list; each entry:\n" : "");
    for (const Json& mapping : mappings(node)) {
      if (mapping.contains("description")) text += "\n" + mapping["description"].get<std::string>() + "\n";
      text += std::string("\n") + kHeader + rows(mapping, "");
      for (const char* choice : {"oneOf", "anyOf"}) {
        if (!mapping.contains(choice)) continue;
        std::vector<std::string> keys;
        for (const Json& alternative : mapping[choice])
          if (alternative.contains("required")) keys.push_back("`" + alternative["required"].front().get<std::string>() + "`");
        text += fmt::format("\n{} of {}.\n", std::string(choice) == "oneOf" ? "Exactly one" : "At least one", fmt::join(keys, ", "));
      }
    }
    return text;
  }

  Json schema_;
};

}  // namespace

void add_case_format_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("case-format", "Print the reference of the case format: every key with its bounds, unit and default");
  command->footer(
      "Examples:\n"
      "  quayside case-format | less\n"
      "  quayside case-format > cases/format.md   # after a change of cases/schema.json");
  command->callback([] { fmt::print("{}", CaseFormat().markdown()); });
}

}  // namespace quayside::harness
