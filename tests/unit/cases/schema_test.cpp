// The schema and the loader describe one format. The loader is only asked, by way of its refusals: it lists the keys
// and words it accepts and states the bounds of a number, and these must be the schema's. The questions are put to
// files that hold every key, so that nothing is left out.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "cases/case.h"
#include "tests/unit/cases/schema_check.h"

namespace quayside::cases {
namespace {

namespace fs = std::filesystem;

const SchemaCheck& schema() {
  static const SchemaCheck check(json::parse(case_schema()));
  return check;
}

// The files together hold every key.
std::vector<fs::path> good_files() {
  std::vector<fs::path> files{"tests/unit/cases/every_key.yaml", "tests/unit/cases/every_key_of_a_reach_stacker.yaml",
                               "tests/unit/cases/smallest.yaml"};
  for (const auto& entry : fs::directory_iterator("cases")) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  return files;
}

std::string refusal(const fs::path& file, const std::string& override_text) {
  try {
    load_case(file, {override_text});
    return "";
  } catch (const CaseError& error) {
    return error.what();
  }
}

// The words after "one of: " at the end of a refusal.
std::set<std::string> words(const std::string& message) {
  const std::string marker = "one of: ";
  const std::size_t begin = message.rfind(marker);
  std::set<std::string> words;
  if (begin == std::string::npos) return words;
  std::istringstream list(message.substr(begin + marker.size()));
  for (std::string word; std::getline(list >> std::ws, word, ',');) words.insert(word);
  return words;
}

std::set<std::string> keys(const json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.insert(key);
  return keys;
}

TEST(Schema, GoodFilesSatisfyIt) {
  for (const fs::path& file : good_files()) {
    for (const std::string& problem : schema().problems(to_json(read_document(file))))
      ADD_FAILURE() << file << " " << problem;
  }
}

TEST(Schema, RefusesWhatAnEditorCanSee) {
  const auto refused = [](const std::string& name) {
    return !schema().problems(to_json(read_document("tests/unit/cases/bad/" + name + ".yaml"))).empty();
  };
  for (const char* name : {"unknown_key",
                           "unknown_nested_key",
                           "missing_title",
                           "missing_rope_length",
                           "text_for_number",
                           "quoted_number",
                           "zero_mass",
                           "negative_size",
                           "huge_mass",
                           "short_vector",
                           "unknown_crane",
                           "unknown_container_type",
                           "no_place",
                           "two_places",
                           "two_orientations",
                           "zero_restitution",
                           "command_with_two_times",
                           "entry_without_command",
                           "condition_without_bound",
                           "value_without_tolerance",
                           "unknown_event",
                           "comparison_without_bound",
                           "name_with_blank"}) {
    EXPECT_TRUE(refused(name)) << name;
  }
}

TEST(Schema, EveryKeyIsInAGoodFile) {
  std::set<std::pair<std::string, std::string>> seen;  // schema of the mapping, key
  for (const fs::path& file : good_files()) {
    schema().walk(to_json(read_document(file)), [&](const std::string&, const json& rule, const json& value) {
      if (!value.is_object()) return;
      for (const std::string& key : keys(value)) seen.emplace(rule.dump(), key);
    });
  }
  schema().mappings([&](const json& rule) {
    for (const std::string& key : keys(rule["properties"])) {
      EXPECT_TRUE(seen.count({rule.dump(), key}))
          << key << " of " << rule.value("description", "") << keys(rule["properties"]).size();
    }
  });
}

TEST(Schema, HasTheKeysOfTheLoader) {
  int mappings = 0;
  for (const fs::path& file : good_files()) {
    schema().walk(to_json(read_document(file)), [&](const std::string& path, const json& rule, const json& value) {
      if (!value.is_object()) return;
      const std::string message = refusal(file, (path.empty() ? "" : path + ".") + "no_such_key=1");
      EXPECT_NE(message.find("unknown key 'no_such_key'"), std::string::npos) << file << " " << path << " " << message;
      EXPECT_EQ(words(message), keys(rule["properties"])) << file << " " << path;
      ++mappings;
    });
  }
  EXPECT_GT(mappings, 30);
}

TEST(Schema, HasTheBoundsAndWordsOfTheLoader) {
  int numbers = 0, choices = 0;
  for (const fs::path& file : good_files()) {
    schema().walk(to_json(read_document(file)), [&](const std::string& path, const json& rule, const json& value) {
      if (rule.contains("enum")) {
        EXPECT_EQ(words(refusal(file, path + "=no such word")), rule["enum"].get<std::set<std::string>>()) << path;
        ++choices;
      } else if (rule.value("type", "") == "boolean") {
        EXPECT_EQ(words(refusal(file, path + "=no such word")), (std::set<std::string>{"true", "false"})) << path;
      } else if (rule.value("type", "") == "number") {
        const std::string range = fmt::format("expected a number from {} to {}", rule.at("minimum").get<double>(),
                                              rule.at("maximum").get<double>());
        const std::string message = refusal(file, path + "=1e300");
        EXPECT_NE(message.find(range), std::string::npos)
            << file << " " << path << "\n  " << range << "\n  " << message;
        ++numbers;
      }
    });
  }
  EXPECT_GT(numbers, 80);
  EXPECT_GT(choices, 20);
}

TEST(Schema, RequiresWhatTheLoaderRequires) {
  const fs::path copy = fs::temp_directory_path() / fmt::format("quayside_schema_test_{}.yaml", getpid());
  const json whole = to_json(read_document("tests/unit/cases/every_key.yaml"));
  int required = 0;
  schema().walk(whole, [&](const std::string& path, const json& rule, const json& value) {
    if (!value.is_object()) return;
    std::string pointer = path.empty() ? "" : "/" + path;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    for (const std::string key : rule.value("required", json::array())) {
      json damaged = whole;
      damaged[json::json_pointer(pointer)].erase(key);
      std::ofstream(copy) << damaged.dump(1);  // JSON is YAML
      EXPECT_NE(refusal(copy, "ground=true"), "") << path << " without " << key;
      ++required;
    }
  });
  std::ofstream(copy) << whole.dump(1);
  EXPECT_EQ(refusal(copy, "ground=true"), "");
  fs::remove(copy);
  EXPECT_GT(required, 30);
}

// What the schema tells editors to assume is what the loader assumes.
TEST(Schema, HasTheDefaultsOfTheLoader) {
  const Case c = load_case("tests/unit/cases/smallest.yaml");
  const json root = json::parse(case_schema());
  const auto of = [&](const char* pointer) { return root.at(json::json_pointer(pointer)).at("default"); };
  EXPECT_EQ(of("/properties/ground"), c.ground);
  EXPECT_EQ(of("/properties/gravity"), json({0, 0, c.gravity.z()}));
  EXPECT_EQ(of("/properties/allow_overlap"), c.allow_overlap);
  EXPECT_EQ(of("/properties/output/properties/interval"), c.output_interval);
  const std::string contact = "/$defs/contact/properties/";
  EXPECT_EQ(of((contact + "model").c_str()), c.contact.model);
  EXPECT_EQ(of((contact + "law").c_str()), c.contact.law);
  EXPECT_EQ(of((contact + "stiffness").c_str()), c.contact.stiffness);
  EXPECT_EQ(of((contact + "restitution").c_str()), c.contact.restitution);
  EXPECT_EQ(of((contact + "reference_speed").c_str()), c.contact.reference_speed);
  EXPECT_EQ(of((contact + "friction/oneOf/0").c_str()), c.contact.friction);
  EXPECT_EQ(of((contact + "friction/oneOf/1/properties/law").c_str()), c.contact.friction_law);
  EXPECT_EQ(of((contact + "friction/oneOf/1/properties/transition_speed").c_str()), c.contact.transition_speed);
  EXPECT_EQ(of("/$defs/solver/properties/relative_tolerance"), c.solver.relative_tolerance);
}

}  // namespace
}  // namespace quayside::cases
