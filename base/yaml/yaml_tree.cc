#include "base/yaml/yaml_tree.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi {
namespace {

// Far below the depth at which yaml-cpp gives up with "bad file" (500), and far above that of any file.
constexpr std::size_t kMaxDepth = 100;

// Source of the text, for messages.
struct Source {
  YamlSource name;
  bool has_lines = true;  // false: a value of the command line
};

int line_of(const YAML::Mark& mark, const Source& source) { return source.has_lines ? mark.line + 1 : 0; }
int column_of(const YAML::Mark& mark, const Source& source) { return source.has_lines ? mark.column + 1 : 0; }

// Builds the tree from the parser's events. yaml-cpp's own tree does not record duplicate keys or whether a
// scalar was quoted.
class TreeBuilder final : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const Source& source) : source_(source) {}

  YamlNode take_root() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    add_leaf(YamlNode::Kind::kNull, mark, "", false);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    fail(mark, "an alias", "the value itself");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                const std::string& value) override {
    const bool quoted = tag == "!";
    if (!quoted) refuse_tag(mark, tag);
    add_leaf(YamlNode::Kind::kScalar, mark, value, quoted);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    refuse_tag(mark, tag);
    open(YamlNode::Kind::kList, mark);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    refuse_tag(mark, tag);
    open(YamlNode::Kind::kMap, mark);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    YamlNode node;
    std::string key;  // read, still without a value
    int key_line = 0;
    int key_column = 0;
    bool has_key = false;
    std::map<std::string, int> lines = {};  // of the keys, so that a long map takes no quadratic time

    bool awaits_key() const { return node.kind == YamlNode::Kind::kMap && !has_key; }
  };

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& found,
                         const std::string& expected) const {
    throw InputError(source_.name.path(), line_of(mark, source_), found, expected);
  }
  void refuse_tag(const YAML::Mark& mark, const std::string& tag) const {
    if (!tag.empty() && tag != "?") fail(mark, "the tag " + one_line(tag), "a value without a tag");
  }

  void add_leaf(YamlNode::Kind kind, const YAML::Mark& mark, const std::string& value, bool quoted) {
    if (!levels_.empty() && levels_.back().awaits_key()) {
      take_key(kind, mark, value);
      return;
    }
    YamlNode node = make_node(kind, mark);
    node.scalar = value;
    node.quoted = quoted;
    attach(std::move(node));
  }

  void take_key(YamlNode::Kind kind, const YAML::Mark& mark, const std::string& key) {
    if (kind != YamlNode::Kind::kScalar || key.empty()) fail(mark, "an empty key", "a name");
    if (const std::string fault = name_fault(key); !fault.empty())
      fail(mark, "the key \"" + one_line(key) + "\"", "a name without " + fault);
    Level& level = levels_.back();
    const auto [first, is_new] = level.lines.emplace(key, line_of(mark, source_));
    if (!is_new) {
      const std::string path = level.node.path.empty() ? key : level.node.path + "." + key;
      fail(mark,
           "a second " + one_line(path) + " (the first is in line " + std::to_string(first->second) + ")",
           "each key once");
    }
    level.key = key;
    level.key_line = line_of(mark, source_);
    level.key_column = column_of(mark, source_);
    level.has_key = true;
  }

  void open(YamlNode::Kind kind, const YAML::Mark& mark) {
    if (!levels_.empty() && levels_.back().awaits_key()) fail(mark, "a map or list as a key", "a name");
    if (levels_.size() == kMaxDepth) {
      const std::string limit = std::to_string(kMaxDepth);
      fail(mark, "maps and lists nested deeper than " + limit + " levels", "at most " + limit + " levels");
    }
    levels_.push_back({.node = make_node(kind, mark), .key = {}});
  }

  void close() {
    YamlNode node = std::move(levels_.back().node);
    levels_.pop_back();
    attach(std::move(node));
  }

  YamlNode make_node(YamlNode::Kind kind, const YAML::Mark& mark) const {
    YamlNode node;
    node.kind = kind;
    node.source = source_.name;
    node.line = line_of(mark, source_);
    node.column = column_of(mark, source_);
    node.value_line = node.line;
    node.value_column = node.column;
    if (levels_.empty()) return node;
    const Level& parent = levels_.back();
    if (parent.node.kind == YamlNode::Kind::kList) {
      node.path = parent.node.path + "[" + std::to_string(parent.node.items.size()) + "]";
    } else {
      // A value takes the line of its key, which is where a reader looks.
      node.line = parent.key_line;
      node.column = parent.key_column;
      node.key = parent.key;
      node.path = parent.node.path.empty() ? parent.key : parent.node.path + "." + parent.key;
    }
    return node;
  }

  void attach(YamlNode node) {
    if (levels_.empty()) {
      root_ = std::move(node);
      return;
    }
    levels_.back().has_key = false;
    levels_.back().node.items.push_back(std::move(node));
  }

  Source source_;
  std::vector<Level> levels_;
  YamlNode root_;
};

YamlNode parse_any(const std::string& text, const Source& source) {
  require_utf8(text, source.name.path(), source.has_lines);
  TreeBuilder builder(source);
  TreeBuilder rest(source);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) return builder.take_root();
    if (parser.HandleNextDocument(rest)) {
      throw InputError(source.name.path(), rest.take_root().line, "a second document", "one document");
    }
  } catch (const YAML::Exception& error) {
    throw InputError(source.name.path(), line_of(error.mark, source), one_line(error.msg),
                     "well-formed YAML");
  }
  return builder.take_root();
}

// Sets path and source of a command-line value and its contents.
void relocate(YamlNode& node, const std::string& path) {
  node.path = path;
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    YamlNode& item = node.items[i];
    relocate(item, item.key.empty() ? path + "[" + std::to_string(i) + "]" : path + "." + item.key);
  }
}

// Plain scalars stay unquoted, because a quoted number is text.
std::string scalar_text(const YamlNode& node) {
  if (!node.quoted && node.scalar.find_first_of(",[]{}#:&*!|>'\"%@`\\\n\t") == std::string::npos)
    return node.scalar;
  std::string text = "\"";
  for (const char letter : node.scalar) {
    if (letter == '"' || letter == '\\') text += '\\';
    text += letter == '\n'   ? std::string("\\n")
            : letter == '\t' ? std::string("\\t")
                             : std::string(1, letter);
  }
  return text + "\"";
}

std::string flow_text(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kNull) return "~";
  if (node.kind == YamlNode::Kind::kScalar) return scalar_text(node);
  const bool is_map = node.kind == YamlNode::Kind::kMap;
  std::string text;
  for (const YamlNode& item : node.items)
    text += (text.empty() ? "" : ", ") + (is_map ? item.key + ": " : std::string()) + flow_text(item);
  return is_map ? "{" + text + "}" : "[" + text + "]";
}

YamlNode& step_into_list(YamlNode& list, const std::string& index, const Override& override_value) {
  const auto number = parse_integer(index);
  if (!number || *number < 0 || *number >= static_cast<std::int64_t>(list.items.size())) {
    throw InputError(override_value.option, 0, one_line(override_value.path),
                     "an item of " + list.path + ", which has " + std::to_string(list.items.size()));
  }
  return list.items[static_cast<std::size_t>(*number)];
}

YamlNode& step_into_map(YamlNode& map, const std::string& key, const Override& override_value) {
  if (map.kind == YamlNode::Kind::kNull) map.kind = YamlNode::Kind::kMap;
  if (map.kind != YamlNode::Kind::kMap) {
    throw InputError(override_value.option, 0, one_line(override_value.path), map.path + " to be a map");
  }
  const auto place =
      std::find_if(map.items.begin(), map.items.end(), [&](const YamlNode& item) { return item.key == key; });
  if (place != map.items.end()) return *place;
  YamlNode added;
  added.source = YamlSource(override_value.option);
  added.key = key;
  added.path = map.path.empty() ? key : map.path + "." + key;
  map.items.push_back(std::move(added));
  return map.items.back();
}

}  // namespace

const YamlNode* YamlNode::find(const std::string& name) const {
  const auto place =
      std::find_if(items.begin(), items.end(), [&](const YamlNode& item) { return item.key == name; });
  return place == items.end() ? nullptr : &*place;
}

Override parse_override(const std::string& argument) {
  const auto equals = argument.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == argument.size()) {
    throw InputError("--set", 0, one_line(argument), "KEY=VALUE");
  }
  return {argument.substr(0, equals), argument.substr(equals + 1)};
}

YamlNode parse_yaml(const std::string& text, const std::filesystem::path& source) {
  // yaml-cpp takes a comment that ends with CR alone to the next LF, and all lines up to there with it.
  for (std::size_t at = text.find('\r'); at != std::string::npos; at = text.find('\r', at + 1)) {
    if (text.substr(at + 1, 1) == "\n") continue;
    const auto before = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    throw InputError(source, static_cast<int>(before) + 1, "a line that ends with CR alone", "LF or CR LF");
  }
  YamlNode root = parse_any(text, {YamlSource(source)});
  if (root.kind == YamlNode::Kind::kNull)
    throw InputError(source, 1, "an empty file", "a map of keys and values");
  if (root.kind != YamlNode::Kind::kMap) {
    throw InputError(source, root.line, "a document that is no map", "a map of keys and values");
  }
  return root;
}

std::string yaml_text(const YamlNode& root) {
  std::string text;
  for (const YamlNode& item : root.items) {
    text += item.key + ":";
    if (item.kind != YamlNode::Kind::kList || item.items.empty()) {
      text += " " + flow_text(item) + "\n";
      continue;
    }
    text += "\n";
    for (const YamlNode& entry : item.items) text += "  - " + flow_text(entry) + "\n";
  }
  return text;
}

void apply_override(YamlNode& root, const Override& override_value) {
  YamlNode* node = &root;
  std::istringstream steps(override_value.path);
  for (std::string step; std::getline(steps, step, '.');) {
    node = node->kind == YamlNode::Kind::kList ? &step_into_list(*node, step, override_value)
                                               : &step_into_map(*node, step, override_value);
  }
  YamlNode value = parse_any(override_value.value, {YamlSource(override_value.option), false});
  value.key = node->key;
  relocate(value, node->path);
  *node = std::move(value);
}

}  // namespace koboshi
