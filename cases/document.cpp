#include "cases/document.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <functional>
#include <sstream>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include "cases/case.h"
#include "cases/edit_distance.h"
#include "cases/limits.h"

namespace quayside::cases {
namespace {

using limits::kMaxDepth, limits::kMaxFileBytes, limits::kMaxNodes;

// Where a text comes from: what its lines are called in messages.
struct Source {
  const std::filesystem::path& file;
  std::string override_text;

  Origin origin(const YAML::Mark& mark) const { return {std::max(mark.line, 0) + 1, override_text}; }
  [[noreturn]] void fail(const Origin& origin, const std::string& message) const {
    throw CaseError(location(file, origin) + ": " + message);
  }
};

// Builds the tree from the parser's events, so that hostile input is refused while it is read: the tree is never deeper
// or larger than the limits, and aliases are never expanded.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const Source& source) : source_(source) {}

  Node take() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { add(make(Node::Kind::nothing, mark)); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    fail(mark, "an alias (*name) is not supported, expected the value itself");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t, const std::string& value) override {
    check_tag(mark, tag);
    Node node = make(Node::Kind::scalar, mark);
    node.text = value;
    node.quoted = tag == "!";
    add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    open(Node::Kind::list, mark, tag);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open(Node::Kind::mapping, mark, tag);
  }
  void OnMapEnd() override { close(); }

 private:
  // A list or mapping that is being read; a mapping takes keys and values in turn.
  struct Open {
    Node node;
    bool has_key() const { return node.keys.size() > node.items.size(); }
    bool wants_key() const { return node.kind == Node::Kind::mapping && !has_key(); }
  };

  Node make(Node::Kind kind, const YAML::Mark& mark) {
    if (++count_ > kMaxNodes) fail(mark, fmt::format("too many values, expected at most {} in a file", kMaxNodes));
    Node node;
    node.kind = kind;
    node.origin = source_.origin(mark);
    return node;
  }

  void open(Node::Kind kind, const YAML::Mark& mark, const std::string& tag) {
    check_tag(mark, tag);
    if (open_.size() >= kMaxDepth) fail(mark, fmt::format("nested too deeply, expected at most {} levels", kMaxDepth));
    if (!open_.empty() && open_.back().wants_key())
      fail(mark, "a list or mapping as a key, expected a word (is a closing bracket missing?)");
    open_.push_back({make(kind, mark)});
  }

  void close() {
    Node node = std::move(open_.back().node);
    open_.pop_back();
    add(std::move(node));
  }

  void add(Node node) {
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = open_.back();
    if (parent.wants_key()) {
      add_key(parent.node, node);
    } else {
      parent.node.items.push_back(std::move(node));
    }
  }

  void add_key(Node& mapping, const Node& key) {
    if (key.kind != Node::Kind::scalar) source_.fail(key.origin, path() + "an empty key, expected a word");
    for (const Key& other : mapping.keys) {
      if (other.text == key.text) {
        source_.fail(key.origin, path() + fmt::format("duplicate key '{}', expected it once (first on line {})",
                                                      key.text, other.origin.line));
      }
    }
    mapping.keys.push_back({key.text, key.origin});
  }

  void check_tag(const YAML::Mark& mark, const std::string& tag) const {
    if (!tag.empty() && tag != "?" && tag != "!")
      fail(mark, "the tag '" + tag + "' is not supported, expected a plain value");
  }

  // Path of the innermost open node, as a prefix of a message.
  std::string path() const {
    std::string path;
    for (const Open& open : open_) {
      if (&open == &open_.back()) break;
      path += (path.empty() ? "" : ".") +
              (open.has_key() ? open.node.keys.back().text : std::to_string(open.node.items.size()));
    }
    return path.empty() ? path : path + ": ";
  }

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& message) const {
    source_.fail(source_.origin(mark), path() + message);
  }

  const Source& source_;
  std::vector<Open> open_;
  std::size_t count_ = 0;
  Node root_;
};

// yaml-cpp takes byte 4 for the end of the file: what follows would be lost without a word. Text holds no such bytes.
void refuse_control_characters(const Source& source, const std::string& text) {
  int line = 1;
  for (const char c : text) {
    if (c == '\n') ++line;
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 && c != '\n' && c != '\r' && c != '\t') {
      source.fail({line, source.override_text}, fmt::format("not a text (byte 0x{:02x}), expected YAML", byte));
    }
  }
}

Node parse(const Source& source, const std::string& text) {
  refuse_control_characters(source, text);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    TreeBuilder builder(source);
    if (!parser.HandleNextDocument(builder)) return {};
    Node root = builder.take();
    TreeBuilder rest(source);
    if (parser.HandleNextDocument(rest)) {
      source.fail(rest.take().origin,
                  "a second document begins here, expected one case in a file (is the indentation right?)");
    }
    return root;
  } catch (const YAML::Exception& error) {
    source.fail(source.origin(error.mark), "not well-formed YAML (" + error.msg + "), expected 'key: value' lines");
  }
}

// " (did you mean 'cases/land_on_stack.yaml'?)" for a name that is nearly that of a case in its folder or in `cases`, with or
// without its ending; else nothing.
std::string nearly(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  const std::string wanted = file.stem().string();
  std::size_t nearest = 2 + wanted.size() / 3;  // so many letters off is another name
  fs::path found;
  for (const fs::path& folder : {file.has_parent_path() ? file.parent_path() : fs::path("."), fs::path("cases")}) {
    std::error_code none;
    for (fs::directory_iterator entry(folder, none), end; !none && entry != end; entry.increment(none)) {
      if (entry->path().extension() != ".yaml") continue;
      const std::size_t distance = edit_distance(wanted, entry->path().stem().string());
      if (distance >= nearest) continue;
      nearest = distance;
      found = entry->path().lexically_normal();
    }
  }
  return found.empty() ? "" : fmt::format(" (did you mean '{}'?)", found.string());
}

std::string read_text(const Source& source) {
  const auto refuse = [&](const std::string& message) { throw CaseError(source.file.string() + ": " + message); };
  std::error_code ignored;
  if (!std::filesystem::exists(source.file, ignored)) refuse(fmt::format("no such file{}, expected a case file (YAML)", nearly(source.file)));
  if (std::filesystem::is_directory(source.file, ignored)) refuse("a directory, expected a case file (YAML)");
  errno = 0;
  std::ifstream stream(source.file, std::ios::binary);
  if (!stream) refuse(fmt::format("cannot be read ({}), expected a readable case file", std::strerror(errno)));
  std::string text(kMaxFileBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad()) refuse("reading failed, expected a readable case file");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kMaxFileBytes) {
    refuse(fmt::format("too large, expected a case file of at most {} kB", kMaxFileBytes / 1000));
  }
  return text;
}

// The item that a part of an override's path stands for; made if a mapping does not have it.
Node& descend(Node& node, const std::string& part, const Origin& origin, const std::string& path,
              const std::function<void(const std::string&)>& refuse) {
  if (node.kind == Node::Kind::nothing) node.kind = Node::Kind::mapping;
  if (node.kind == Node::Kind::mapping) {
    for (std::size_t i = 0; i < node.keys.size(); ++i) {
      if (node.keys[i].text == part) return node.items[i];
    }
    node.keys.push_back({part, origin});
    node.items.emplace_back().origin = origin;
    return node.items.back();
  }
  if (node.kind == Node::Kind::scalar) refuse(fmt::format("{} is '{}', it has no key '{}'", path, node.text, part));
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
  if (error == std::errc() && end == part.data() + part.size() && index < node.items.size()) return node.items[index];
  for (Node& item : node.items) {
    const Node* name = item.find("name");
    if (name && name->text == part) return item;
  }
  refuse(fmt::format("{} has no entry '{}', expected a name or an index below {}", path, part, node.items.size()));
  return node;
}

}  // namespace

const Node* Node::find(const std::string& key) const {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i].text == key) return &items[i];
  }
  return nullptr;
}

std::string location(const std::filesystem::path& file, const Origin& origin) {
  return origin.override_text.empty() ? fmt::format("{}:{}", file.string(), origin.line)
                                      : fmt::format("{}: override '{}'", file.string(), origin.override_text);
}

Node read_document(const std::filesystem::path& file) { return read_document(read_text({file, ""}), file); }

Node read_document(const std::string& text, const std::filesystem::path& file) {
  Node root = parse({file, ""}, text);
  if (root.kind == Node::Kind::nothing) throw CaseError(file.string() + ": empty, expected a case");
  return root;
}

void apply_override(Node& root, const std::filesystem::path& file, const std::string& text) {
  const Source source{file, text};
  const Origin origin{1, text};
  const auto refuse = [&](const std::string& message) { source.fail(origin, message); };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) refuse("no '=', expected key.path=value");
  Node value = parse(source, text.substr(equals + 1));
  if (value.kind == Node::Kind::nothing) refuse("no value, expected key.path=value");

  Node* node = &root;
  std::string path;  // of `node`
  for (std::size_t start = 0; start <= equals;) {
    const std::size_t dot = std::min(text.find('.', start), equals);
    const std::string part = text.substr(start, dot - start);
    if (part.empty()) refuse("an empty key, expected key.path=value");
    node = &descend(*node, part, origin, path.empty() ? "the case" : path, refuse);
    path += (path.empty() ? "" : ".") + part;
    start = dot + 1;
  }
  *node = std::move(value);
}

namespace {

// Numbers and words stand bare, since quotes would make texts of them; all else goes in quotes.
std::string scalar_text(const Node& node) {
  const auto letter = [](unsigned char c) { return c < 0x80 && std::isalnum(c); };
  const auto bare = [&](unsigned char c) { return letter(c) || c == '_' || c == '.' || c == '+' || c == '-'; };
  if (!node.quoted && std::any_of(node.text.begin(), node.text.end(), letter) &&
      std::all_of(node.text.begin(), node.text.end(), bare)) {
    return node.text;
  }
  std::string quoted = "\"";
  for (const char c : node.text) {
    if (c == '"' || c == '\\') {
      quoted += std::string("\\") + c;
    } else if (c == '\n') {
      quoted += "\\n";
    } else if (static_cast<unsigned char>(c) < 0x20) {
      quoted += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string flow_text(const Node& node) {
  if (node.kind == Node::Kind::nothing) return "null";
  if (node.kind == Node::Kind::scalar) return scalar_text(node);
  const bool mapping = node.kind == Node::Kind::mapping;
  std::string text = mapping ? "{" : "[";
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    if (i > 0) text += ", ";
    if (mapping) text += node.keys[i].text + ": ";
    text += flow_text(node.items[i]);
  }
  return text + (mapping ? "}" : "]");
}

}  // namespace

std::string to_text(const Node& root) {
  if (root.kind != Node::Kind::mapping) return flow_text(root) + "\n";
  std::string text;
  for (std::size_t i = 0; i < root.keys.size(); ++i) text += root.keys[i].text + ": " + flow_text(root.items[i]) + "\n";
  return text;
}

}  // namespace quayside::cases
