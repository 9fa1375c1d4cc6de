// A YAML file as a tree of plain values that remember where they come from. Knows YAML, nothing of cases.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace quayside::cases {

// Where a value was written: a line of the file, or an override.
struct Origin {
  int line = 0;               // from 1
  std::string override_text;  // "key.path=value"; empty: from the file
};

struct Key {
  std::string text;
  Origin origin;
};

struct Node {
  enum class Kind { nothing, scalar, list, mapping };
  Kind kind = Kind::nothing;
  Origin origin;
  std::string text;         // scalar
  bool quoted = false;      // scalar that was written in quotes
  std::vector<Key> keys;    // mapping: one per item, none twice
  std::vector<Node> items;  // list, mapping

  const Node* find(const std::string& key) const;  // item of a mapping, or null
};

// "file:line" or "file: override 'key.path=value'".
std::string location(const std::filesystem::path& file, const Origin& origin);

// Reads a file that holds one YAML document. Throws CaseError for what is no such file: missing, a directory, too
// large, empty, not text, ill-formed, nested too deeply, with duplicate keys, aliases, tags or keys that are not text.
Node read_document(const std::filesystem::path& file);
// The same from a text, as if it stood in `file`.
Node read_document(const std::string& text, const std::filesystem::path& file);

// The tree as YAML in one line a top-level key: reads back as the same tree, but for lines and overrides.
std::string to_text(const Node& root);

// Applies "key.path=value" to the tree; the value is YAML. Entries of lists are addressed by index or by their `name`,
// mappings that are missing on the way are made. Throws CaseError.
void apply_override(Node& root, const std::filesystem::path& file, const std::string& text);

}  // namespace quayside::cases
