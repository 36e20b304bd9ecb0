#include "tools/edit/yaml_document.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "sim_board/input/error.h"
#include "sim_board/input/text.h"
#include "sim_board/record/output_file.h"
#include "tools/edit/yaml_places.h"

namespace koboshi::tools {

using sim::YamlNode;

// Bytes from begin to end become `text`.
struct YamlDocument::Change {
  std::size_t begin;
  std::size_t end;
  std::string text;
};

namespace {

// A path into a document: its text, its bytes, and its values.
struct Spot {
  YamlNode* node = nullptr;  // null: a key that the map lacks, or the end of a list
  const YamlPlace* place = nullptr;
  YamlNode* parent = nullptr;
  const YamlPlace* parent_place = nullptr;
  std::size_t index = 0;  // in the parent
  std::string key{};      // the last step
};

class Finder {
 public:
  Finder(const std::filesystem::path& source, const YamlPath& path) : source_(source), path_(path) {}

  Spot find(YamlNode& root, const YamlPlace& place) const {
    Spot spot{.node = &root, .place = &place};
    for (const std::string& step : path_.steps()) spot = into(spot, step);
    return spot;
  }

  sim::InputError error(const YamlNode* node, const std::string& expected) const {
    return {source_, node != nullptr ? node->line : 0, sim::one_line(path_.text()), expected};
  }

 private:
  Spot into(const Spot& outer, const std::string& step) const {
    if (outer.node == nullptr) throw error(outer.parent, "a path of which only the last step may be new");
    YamlNode& node = *outer.node;
    Spot spot{.parent = &node, .parent_place = outer.place, .index = node.items.size(), .key = step};
    if (node.kind == YamlNode::Kind::kMap) {
      const auto item = std::ranges::find(node.items, step, &YamlNode::key);
      spot.index = static_cast<std::size_t>(item - node.items.begin());
    } else if (node.kind == YamlNode::Kind::kList) {
      const auto number = sim::parse_integer(step);
      if (!number || *number < 0 || *number > static_cast<std::int64_t>(node.items.size()))
        throw error(&node, "an item of a list of " + std::to_string(node.items.size()));
      spot.index = static_cast<std::size_t>(*number);
    } else {
      throw error(&node, "a path through maps and lists");
    }
    if (spot.index < node.items.size()) {
      spot.node = &node.items[spot.index];
      spot.place = &outer.place->items[spot.index];
    }
    return spot;
  }

  const std::filesystem::path& source_;
  const YamlPath& path_;
};

// The lines of a text.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}

  std::size_t begin(std::size_t at) const {
    const std::size_t newline = at == 0 ? std::string_view::npos : text_.rfind('\n', at - 1);
    return newline == std::string_view::npos ? 0 : newline + 1;
  }
  // The first byte of the next line, or the end of the text.
  std::size_t next(std::size_t at) const {
    const std::size_t newline = text_.find('\n', at);
    return newline == std::string_view::npos ? text_.size() : newline + 1;
  }
  // The first byte of the line after a value's last one. A text in block style ends with its line.
  std::size_t after(const YamlPlace& place) const {
    const bool ends_a_line = place.end > place.begin && text_[place.end - 1] == '\n';
    return ends_a_line ? place.end : next(place.end);
  }
  bool is_first_on_line(std::size_t at) const { return text_.find_first_not_of(' ', begin(at)) == at; }
  std::size_t column(std::size_t at) const { return at - begin(at); }
  // The first of the comment lines directly above `at` and as far indented, or else the line of `at`.
  std::size_t with_comments_above(std::size_t at) const {
    std::size_t line = begin(at);
    while (line > 0) {
      const std::size_t above = begin(line - 1);
      const std::size_t first = text_.find_first_not_of(' ', above);
      if (text_[first] != '#' || first - above != column(at)) break;
      line = above;
    }
    return line;
  }

 private:
  std::string_view text_;
};

// First byte of an entry or item, with its key or dash.
std::size_t start_of(std::string_view text, const YamlPlace& parent, const YamlPlace& item) {
  if (parent.is_map()) return item.key_begin;
  return parent.is_flow() ? item.begin : text.rfind('-', item.begin - 1);
}

std::string entry_text(const Spot& spot, std::string_view value) {
  return spot.parent_place->is_map() ? spot.key + ": " + std::string(value) : std::string(value);
}

bool same_values(const YamlNode& one, const YamlNode& other) {
  return one.kind == other.kind && one.key == other.key && one.scalar == other.scalar &&
         one.quoted == other.quoted && std::ranges::equal(one.items, other.items, same_values);
}

// Throws InputError unless the text is one value on one line, without a comment.
YamlNode parsed_value(std::string_view value, const std::filesystem::path& source) {
  const std::string text = "value: " + std::string(value);
  YamlNode root = sim::parse_yaml(text, source);
  const bool is_alone = text.find('\n') == std::string::npos && root.items.size() == 1 &&
                        locate_yaml(text, source).items.front().end == text.size();
  if (!is_alone) throw sim::InputError(source, 0, sim::one_line(value), "a value on one line, in flow style");
  return std::move(root.items.front());
}

}  // namespace

YamlPath::YamlPath(std::string_view dotted) {
  for (std::size_t begin = 0; begin <= dotted.size();) {
    const std::size_t end = std::min(dotted.find('.', begin), dotted.size());
    steps_.emplace_back(dotted.substr(begin, end - begin));
    begin = end + 1;
  }
}

std::string YamlPath::text() const {
  std::string text;
  for (const std::string& step : steps_) text += (text.empty() ? "" : ".") + step;
  return text;
}

YamlDocument::YamlDocument(std::filesystem::path file)
    : YamlDocument(file, sim::read_text_file(file, "a YAML file")) {}

YamlDocument::YamlDocument(std::filesystem::path source, std::string text)
    : source_(std::move(source)), text_(std::move(text)), tree_(sim::parse_yaml(text_, source_)) {}

void YamlDocument::set(const YamlPath& path, std::string_view value) {
  const YamlPlace places = locate_yaml(text_, source_);
  YamlNode intended = tree_;
  const Spot spot = Finder(source_, path).find(intended, places);
  if (spot.node == nullptr) return insert(path, value);
  YamlNode replacement = parsed_value(value, source_);
  replacement.key = spot.node->key;
  *spot.node = std::move(replacement);

  const YamlPlace& place = *spot.place;
  const bool is_inline = place.kind == YamlPlace::Kind::kScalar || place.is_flow();
  Change change{place.begin, place.end, std::string(value)};
  if (spot.parent_place->is_map() && !(is_inline && place.end > place.begin)) {
    change.begin = text_.find(':', place.key_end) + 1;
    change.text.insert(0, " ");
  } else if (place.begin == place.end) {
    change.text.insert(0, " ");
  }
  if (place.kind == YamlPlace::Kind::kBlockText) change.text += "\n";
  apply(change, intended);
}

void YamlDocument::insert(const YamlPath& path, std::string_view value) {
  const YamlPlace places = locate_yaml(text_, source_);
  YamlNode intended = tree_;
  const Finder finder(source_, path);
  const Spot spot = finder.find(intended, places);
  const YamlPlace& parent = *spot.parent_place;
  if (parent.is_map() && spot.node != nullptr) throw finder.error(spot.node, "a key that the map lacks");
  const std::string entry = entry_text(spot, value);
  YamlNode added = parsed_value(value, source_);
  added.key = parent.is_map() ? spot.key : "";
  spot.parent->items.insert(spot.parent->items.begin() + static_cast<std::ptrdiff_t>(spot.index),
                            std::move(added));

  const Lines lines(text_);
  if (parent.is_flow()) {
    const std::size_t count = parent.items.size();
    if (count == 0) return apply({parent.end - 1, parent.end - 1, entry}, intended);
    if (spot.index == count) {
      const std::size_t end = parent.items.back().end;
      return apply({end, end, ", " + entry}, intended);
    }
    const std::size_t begin = start_of(text_, parent, *spot.place);
    return apply({begin, begin, entry + ", "}, intended);
  }
  const std::string indent(lines.column(parent.begin), ' ');
  const std::string line = (parent.is_list() ? "- " : "") + entry + "\n";
  if (spot.index == parent.items.size()) {
    const std::size_t at = lines.after(parent.items.back());
    const bool is_open = at > 0 && text_[at - 1] != '\n';
    return apply({at, at, (is_open ? "\n" : "") + indent + line}, intended);
  }
  const std::size_t begin = start_of(text_, parent, *spot.place);
  if (!lines.is_first_on_line(begin)) return apply({begin, begin, line + indent}, intended);
  const std::size_t at = lines.with_comments_above(begin);
  apply({at, at, indent + line}, intended);
}

void YamlDocument::erase(const YamlPath& path) {
  const YamlPlace places = locate_yaml(text_, source_);
  YamlNode intended = tree_;
  const Finder finder(source_, path);
  const Spot spot = finder.find(intended, places);
  if (spot.node == nullptr) throw finder.error(spot.parent, "a value that is there");
  const YamlPlace& parent = *spot.parent_place;
  const std::size_t count = parent.items.size();
  const bool is_last = spot.index + 1 == count;
  spot.parent->items.erase(spot.parent->items.begin() + static_cast<std::ptrdiff_t>(spot.index));

  const Lines lines(text_);
  const auto start = [&](std::size_t item) { return start_of(text_, parent, parent.items[item]); };
  const std::size_t begin = start(spot.index);
  if (parent.is_flow()) {
    if (!is_last) return apply({begin, start(spot.index + 1), ""}, intended);
    const std::size_t from = spot.index > 0 ? parent.items[spot.index - 1].end : begin;
    return apply({from, spot.place->end, ""}, intended);
  }
  if (count == 1) {
    if (&parent == &places) throw finder.error(spot.parent, "another key beside it in the file");
    const std::string_view empty = parent.is_map() ? "{}" : "[]";
    const bool after_key = text_.rfind('\n', parent.begin) != std::string::npos && parent.key_end > 0;
    const std::size_t from = after_key ? text_.find(':', parent.key_end) + 1 : parent.begin;
    return apply({from, parent.end, (after_key ? " " : "") + std::string(empty)}, intended);
  }
  if (!lines.is_first_on_line(begin) && !is_last) return apply({begin, start(spot.index + 1), ""}, intended);
  apply({lines.begin(begin), lines.after(*spot.place), ""}, intended);
}

void YamlDocument::rename(const YamlPath& path, std::string_view key) {
  const YamlPlace places = locate_yaml(text_, source_);
  YamlNode intended = tree_;
  const Finder finder(source_, path);
  const Spot spot = finder.find(intended, places);
  if (spot.node == nullptr || !spot.parent_place->is_map()) throw finder.error(spot.parent, "a key of a map");
  spot.node->key = key;
  apply({spot.place->key_begin, spot.place->key_end, std::string(key)}, intended);
}

void YamlDocument::apply(const Change& change, const YamlNode& intended) {
  std::string text = text_;
  text.replace(change.begin, change.end - change.begin, change.text);
  YamlNode tree = sim::parse_yaml(text, source_);
  if (!same_values(tree, intended)) {
    const auto line =
        std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(change.begin), '\n');
    throw sim::InputError(source_, static_cast<int>(line) + 1, "a layout in which this edit changes more",
                          "keys and values in block or flow style");
  }
  text_ = std::move(text);
  tree_ = std::move(tree);
}

void YamlDocument::save() const { sim::write_whole_file(source_, text_); }

}  // namespace koboshi::tools
