#include "base/yaml/yaml_tree.h"

#include <algorithm>
#include <map>
#include <sstream>
#include <string_view>
#include <tuple>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/yaml/yaml_events.h"

namespace koboshi {
namespace {

// Far above the depth of any file.
constexpr std::size_t kMaxDepth = 100;

// Source of the text, for messages.
struct Source {
  YamlSource name;
  bool has_lines = true;  // false: a value of the command line
};

// Where a value or key begins: line and column from 1; 0 in a value of the command line.
struct Mark {
  int line = 0;
  int column = 0;
};

// Builds the tree from the parser's events. libfyaml's own tree has no columns of keys.
class TreeBuilder {
 public:
  TreeBuilder(std::string_view text, const Source& source) : text_(text), events_(text), source_(source) {}

  // Reads the next document. Returns false at the end of the text.
  bool read_document() {
    for (;;) {
      const fy_event& event = events_.next();
      switch (event.type) {
        case FYET_STREAM_END:
          return false;
        case FYET_DOCUMENT_END:
          return true;
        case FYET_DOCUMENT_START:
          mark_of(event.document_start.document_start);
          break;
        case FYET_SCALAR:
          add_scalar(event);
          break;
        case FYET_ALIAS:
          fail(mark_of(event.alias.anchor), "an alias", "the value itself");
        case FYET_SEQUENCE_START:
          begin(YamlNode::Kind::kList, event.sequence_start.sequence_start, event.sequence_start.tag);
          break;
        case FYET_MAPPING_START:
          begin(YamlNode::Kind::kMap, event.mapping_start.mapping_start, event.mapping_start.tag);
          break;
        case FYET_SEQUENCE_END:
        case FYET_MAPPING_END:
          close();
          break;
        default:
          break;
      }
    }
  }
  YamlNode take_root() { return std::move(root_); }

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

  [[noreturn]] void fail(const Mark& mark, const std::string& found, const std::string& expected) const {
    throw InputError(source_.name.path(), mark.line, found, expected);
  }
  void refuse_tag(const Mark& mark, fy_token* tag) const {
    if (tag != nullptr) fail(mark, "the tag " + one_line(std::string(text_of(tag))), "a value without a tag");
  }

  // Without a token: where the last value or key was.
  Mark mark_of(fy_token* token) {
    const fy_mark* const mark = token == nullptr ? nullptr : fy_token_start_mark(token);
    if (mark == nullptr || !source_.has_lines) return last_;
    return last_ = {mark->line + 1, mark->column + 1};
  }
  // A quoted text begins with its quote, a text in block style with its indicator, which its token leaves
  // out.
  Mark mark_of_scalar(fy_token* token, fy_scalar_style style) {
    if (style == FYSS_LITERAL || style == FYSS_FOLDED) return last_;
    Mark mark = mark_of(token);
    if (mark.column > 1 && (style == FYSS_SINGLE_QUOTED || style == FYSS_DOUBLE_QUOTED)) --mark.column;
    return mark;
  }

  void add_scalar(const fy_event& event) {
    fy_token* const token = event.scalar.value;
    const fy_scalar_style style = token == nullptr ? FYSS_PLAIN : fy_token_scalar_style(token);
    const std::string value(text_of(token));
    const Mark mark = mark_of_scalar(token, style);
    refuse_tag(mark, event.scalar.tag);
    const bool quoted = style != FYSS_PLAIN;
    const bool is_null = !quoted && is_null_text(value);
    add_leaf(is_null ? YamlNode::Kind::kNull : YamlNode::Kind::kScalar, mark, is_null ? "" : value, quoted);
  }
  // The null values of YAML's core schema.
  static bool is_null_text(std::string_view text) {
    return text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL";
  }
  void begin(YamlNode::Kind kind, fy_token* token, fy_token* tag) {
    const Mark mark = mark_of(token);
    refuse_tag(mark, tag);
    open(kind, mark);
  }

  void add_leaf(YamlNode::Kind kind, const Mark& mark, const std::string& value, bool quoted) {
    if (!levels_.empty() && levels_.back().awaits_key()) {
      take_key(kind, mark, value);
      return;
    }
    YamlNode node = make_node(kind, mark);
    node.scalar = value;
    node.quoted = quoted;
    attach(std::move(node));
  }

  void take_key(YamlNode::Kind kind, const Mark& mark, const std::string& key) {
    if (kind != YamlNode::Kind::kScalar || key.empty()) fail(mark, "an empty key", "a name");
    if (const std::string fault = name_fault(key); !fault.empty())
      fail(mark, "the key \"" + one_line(key) + "\"", "a name without " + fault);
    Level& level = levels_.back();
    const auto [first, is_new] = level.lines.emplace(key, mark.line);
    if (!is_new) {
      const std::string path = level.node.path.empty() ? key : level.node.path + "." + key;
      fail(mark,
           "a second " + one_line(path) + " (the first is in line " + std::to_string(first->second) + ")",
           "each key once");
    }
    // The token of a pair in a flow list, [a: 1], is its colon.
    YamlNode& map = level.node;
    const bool begins_before =
        mark.line < map.value_line || (mark.line == map.value_line && mark.column < map.value_column);
    if (begins_before) {
      if (map.key.empty()) std::tie(map.line, map.column) = std::pair(mark.line, mark.column);
      std::tie(map.value_line, map.value_column) = std::pair(mark.line, mark.column);
    }
    level.key = key;
    level.key_line = mark.line;
    level.key_column = mark.column;
    level.has_key = true;
  }

  void open(YamlNode::Kind kind, const Mark& mark) {
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

  YamlNode make_node(YamlNode::Kind kind, const Mark& mark) const {
    YamlNode node;
    node.kind = kind;
    node.source = source_.name;
    node.line = mark.line;
    node.column = mark.column;
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

  std::string_view text_;
  YamlEvents events_;
  Source source_;
  Mark last_;
  std::vector<Level> levels_;
  YamlNode root_;
};

// YAML 1.2.2, 5.1: no control characters but tab and ends of lines. libfyaml takes the first NUL for the end.
void refuse_control_characters(const std::string& text, const Source& source) {
  const auto is_control = [](char letter) {
    const auto code = static_cast<unsigned char>(letter);
    return (code < 0x20 && code != '\t' && code != '\n' && code != '\r') || code == 0x7F;
  };
  const auto found = std::ranges::find_if(text, is_control);
  if (found == text.end()) return;
  const auto line = source.has_lines ? 1 + std::count(text.begin(), found, '\n') : 0;
  throw InputError(source.name.path(), static_cast<int>(line),
                   one_line(std::string("the character ") + *found), "text without control characters");
}

YamlNode parse_any(const std::string& text, const Source& source) {
  require_utf8(text, source.name.path(), source.has_lines);
  refuse_control_characters(text, source);
  try {
    TreeBuilder builder(text, source);
    if (!builder.read_document()) return {};
    YamlNode root = builder.take_root();
    if (builder.read_document()) {
      throw InputError(source.name.path(), builder.take_root().line, "a second document", "one document");
    }
    return root;
  } catch (const YamlRefused& refused) {
    throw InputError(source.name.path(), source.has_lines ? refused.line : 0,
                     "malformed YAML: " + one_line(refused.what()), "well-formed YAML");
  }
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

Override text_override(std::string path, const std::string& text, std::string option) {
  YamlNode node;
  node.kind = YamlNode::Kind::kScalar;
  node.scalar = text;
  node.quoted = true;
  return {std::move(path), text.empty() ? "" : scalar_text(node), std::move(option)};
}

YamlNode parse_yaml(const std::string& text, const std::filesystem::path& source) {
  // A line that ends with CR alone is a line for libfyaml and not for an editor: line numbers would differ.
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
