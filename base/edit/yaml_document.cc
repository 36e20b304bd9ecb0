#include "base/edit/yaml_document.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "base/edit/yaml_lines.h"
#include "base/edit/yaml_places.h"
#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi {

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

  InputError error(const YamlNode* node, const std::string& expected) const {
    return {source_, node != nullptr ? node->line : 0, one_line(path_.text()), expected};
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
      const auto number = parse_integer(step);
      if (!number || *number < 0 || *number > static_cast<std::int64_t>(node.items.size()))
        throw error(&node, "an item of a list of " + std::to_string(node.items.size()));
      spot.index = static_cast<std::size_t>(*number);
    } else {
      throw error(&node, "a path through maps and lists");
    }
    if (spot.index < node.items.size()) {
      spot.node = &node.items[spot.index];
      spot.place = place_of(*outer.place, spot);
      if (spot.place == nullptr) throw error(&node, "a value that no other edit of the batch has added");
    }
    return spot;
  }

  // Edits of a batch change the keys of the tree before those of the text.
  static const YamlPlace* place_of(const YamlPlace& outer, const Spot& spot) {
    if (outer.is_list()) return &outer.items[spot.index];
    const auto item = std::ranges::find(outer.items, spot.key, &YamlPlace::key);
    return item == outer.items.end() ? nullptr : &*item;
  }

  const std::filesystem::path& source_;
  const YamlPath& path_;
};

std::string entry_text(const Spot& spot, std::string_view value) {
  return spot.parent_place->is_map() ? spot.key + ": " + std::string(value) : std::string(value);
}

// Throws InputError unless the text is one value on one line, without a comment.
YamlNode parsed_value(std::string_view value, const std::filesystem::path& source) {
  const std::string text = "value: " + std::string(value);
  YamlNode root = parse_yaml(text, source);
  const bool is_alone = text.find('\n') == std::string::npos && root.items.size() == 1 &&
                        locate_yaml(text, source).items.front().end == text.size();
  if (!is_alone) throw InputError(source, 0, one_line(value), "a value on one line, in flow style");
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
    : YamlDocument(file, read_text_file(file, "a YAML file")) {}

YamlDocument::YamlDocument(std::filesystem::path source, std::string text)
    : source_(std::move(source)), text_(std::move(text)), tree_(parse_yaml(text_, source_)) {}

const YamlPlace& YamlDocument::places() const {
  if (!places_) places_ = locate_yaml(text_, source_);
  return *places_;
}

void YamlDocument::set(const YamlPath& path, std::string_view value) {
  edit(std::vector<YamlEdit>{{YamlEdit::Kind::kSet, path, std::string(value)}});
}

void YamlDocument::insert(const YamlPath& path, std::string_view value) {
  YamlNode intended = tree_;
  const Change change = insert_change(path, value, intended);
  apply({change}, std::move(intended));
}

void YamlDocument::erase(const YamlPath& path) {
  edit(std::vector<YamlEdit>{{YamlEdit::Kind::kErase, path, {}}});
}

void YamlDocument::rename(const YamlPath& path, std::string_view key) {
  edit(std::vector<YamlEdit>{{YamlEdit::Kind::kRename, path, std::string(key)}});
}

void YamlDocument::edit(std::span<const YamlEdit> edits) {
  YamlNode intended = tree_;
  std::vector<Change> changes;
  for (const YamlEdit& edit : edits) {
    if (edit.kind == YamlEdit::Kind::kSet) changes.push_back(set_change(edit.path, edit.text, intended));
    if (edit.kind == YamlEdit::Kind::kErase) changes.push_back(erase_change(edit.path, intended));
    if (edit.kind == YamlEdit::Kind::kRename)
      changes.push_back(rename_change(edit.path, edit.text, intended));
  }
  apply(std::move(changes), std::move(intended));
}

YamlDocument::Change YamlDocument::set_change(const YamlPath& path, std::string_view value,
                                              YamlNode& intended) const {
  const Spot spot = Finder(source_, path).find(intended, places());
  if (spot.node == nullptr) return insert_change(path, value, intended);
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
  return change;
}

YamlDocument::Change YamlDocument::insert_change(const YamlPath& path, std::string_view value,
                                                 YamlNode& intended) const {
  const Finder finder(source_, path);
  const Spot spot = finder.find(intended, places());
  const YamlPlace& parent = *spot.parent_place;
  if (parent.is_map() && spot.node != nullptr) throw finder.error(spot.node, "a key that the map lacks");
  const std::string entry = entry_text(spot, value);
  YamlNode added = parsed_value(value, source_);
  added.key = parent.is_map() ? spot.key : "";
  const bool is_only = spot.parent->items.empty();
  spot.parent->items.insert(spot.parent->items.begin() + static_cast<std::ptrdiff_t>(spot.index),
                            std::move(added));

  const Lines lines(text_);
  const bool is_last = spot.place == nullptr;
  if (parent.is_flow()) {
    if (parent.items.empty()) return {parent.end - 1, parent.end - 1, (is_only ? "" : ", ") + entry};
    if (is_last) {
      const std::size_t end = parent.items.back().end;
      return {end, end, ", " + entry};
    }
    const std::size_t begin = start_of(text_, parent, *spot.place);
    return {begin, begin, entry + ", "};
  }
  const std::string indent(lines.column(parent.begin), ' ');
  const std::string line = (parent.is_list() ? "- " : "") + entry + "\n";
  if (is_last) {
    const std::size_t at = lines.after(parent.items.back());
    const bool is_open = at > 0 && text_[at - 1] != '\n';
    return {at, at, (is_open ? "\n" : "") + indent + line};
  }
  const std::size_t begin = start_of(text_, parent, *spot.place);
  if (!lines.is_first_on_line(begin)) return {begin, begin, line + indent};
  const std::size_t at = lines.with_comments_above(begin);
  return {at, at, indent + line};
}

YamlDocument::Change YamlDocument::erase_change(const YamlPath& path, YamlNode& intended) const {
  const Finder finder(source_, path);
  const Spot spot = finder.find(intended, places());
  if (spot.node == nullptr) throw finder.error(spot.parent, "a value that is there");
  const YamlPlace& parent = *spot.parent_place;
  const std::size_t count = parent.items.size();
  const auto index = static_cast<std::size_t>(spot.place - parent.items.data());
  const bool is_last = index + 1 == count;
  spot.parent->items.erase(spot.parent->items.begin() + static_cast<std::ptrdiff_t>(spot.index));

  const Lines lines(text_);
  const auto start = [&](std::size_t item) { return start_of(text_, parent, parent.items[item]); };
  const std::size_t begin = start(index);
  if (parent.is_flow()) {
    if (!is_last) return {begin, start(index + 1), ""};
    const std::size_t from = index > 0 ? parent.items[index - 1].end : begin;
    return {from, spot.place->end, ""};
  }
  if (count == 1) {
    if (&parent == &places()) throw finder.error(spot.parent, "another key beside it in the file");
    const std::string_view empty = parent.is_map() ? "{}" : "[]";
    const bool after_key = text_.rfind('\n', parent.begin) != std::string::npos && parent.key_end > 0;
    const std::size_t from = after_key ? text_.find(':', parent.key_end) + 1 : parent.begin;
    return {from, parent.end, (after_key ? " " : "") + std::string(empty)};
  }
  if (!lines.is_first_on_line(begin) && !is_last) return {begin, start(index + 1), ""};
  return {lines.begin(begin), lines.after(*spot.place), ""};
}

YamlDocument::Change YamlDocument::rename_change(const YamlPath& path, std::string_view key,
                                                 YamlNode& intended) const {
  const Finder finder(source_, path);
  const Spot spot = finder.find(intended, places());
  if (spot.node == nullptr || !spot.parent_place->is_map()) throw finder.error(spot.parent, "a key of a map");
  // The key may have quotes.
  spot.node->key = parse_yaml(std::string(key) + ": 0", source_).items.front().key;
  return {spot.place->key_begin, spot.place->key_end, std::string(key)};
}

void YamlDocument::apply(std::vector<Change> changes, YamlNode intended) {
  if (changes.empty()) return;
  std::ranges::stable_sort(changes, {}, &Change::begin);
  const auto refuse = [&](const Change& change) {
    const auto line =
        std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(change.begin), '\n');
    throw InputError(source_, static_cast<int>(line) + 1, "a layout in which this edit changes more",
                     "keys and values in block or flow style");
  };
  std::string text;
  std::size_t done = 0;
  for (const Change& change : changes) {
    if (change.begin < done) refuse(change);
    text.append(text_, done, change.begin - done).append(change.text);
    done = change.end;
  }
  text.append(text_, done);
  YamlNode tree = parse_yaml(text, source_);
  if (!same_values(tree, intended)) refuse(changes.front());
  text_ = std::move(text);
  tree_ = std::move(tree);
  places_.reset();
}

void YamlDocument::replace_text(std::string text) {
  YamlNode tree = parse_yaml(text, source_);
  YamlPlace places = locate_yaml(text, source_);
  text_ = std::move(text);
  tree_ = std::move(tree);
  places_ = std::move(places);
}

void YamlDocument::save() const { write_whole_file(source_, text_); }

}  // namespace koboshi
