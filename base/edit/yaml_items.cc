#include <algorithm>
#include <utility>

#include "base/edit/yaml_document.h"
#include "base/edit/yaml_lines.h"
#include "base/text/error.h"
#include "base/text/text.h"

namespace koboshi {
namespace {

// A collection in the tree and in the text.
struct Collection {
  YamlNode* node = nullptr;
  const YamlPlace* place = nullptr;
  bool in_flow = false;  // within a collection in flow style
};

std::size_t index_of(const YamlNode& node, const std::string& step) {
  if (node.kind == YamlNode::Kind::kMap)
    return static_cast<std::size_t>(std::ranges::find(node.items, step, &YamlNode::key) - node.items.begin());
  const auto number = parse_integer(step);
  return number && *number >= 0 ? static_cast<std::size_t>(*number) : node.items.size();
}

Collection find_collection(const std::filesystem::path& source, const YamlPath& path, YamlNode& root,
                           const YamlPlace& places) {
  Collection found{&root, &places};
  for (const std::string& step : path.steps()) {
    const std::size_t index = index_of(*found.node, step);
    if (index >= found.node->items.size())
      throw InputError(source, found.node->line, one_line(path.text()), "a list or map of the file");
    found.in_flow = found.in_flow || found.place->is_flow();
    found.node = &found.node->items[index];
    found.place = &found.place->items[index];
  }
  if (found.node->kind == YamlNode::Kind::kScalar)
    throw InputError(source, found.node->line, one_line(path.text()), "a list or map");
  return found;
}

// Shifts all lines that are not empty, to the left as far as they have blanks.
std::string shifted(std::string_view block, std::ptrdiff_t columns) {
  std::string text;
  for (std::size_t begin = 0; begin < block.size();) {
    const std::size_t end = std::min(block.find('\n', begin), block.size());
    std::string_view line = block.substr(begin, end - begin);
    if (columns > 0 && !line.empty()) text.append(static_cast<std::size_t>(columns), ' ');
    if (columns < 0) {
      const std::size_t blanks = std::min(line.find_first_not_of(' '), line.size());
      line.remove_prefix(std::min(blanks, static_cast<std::size_t>(-columns)));
    }
    text.append(line).append("\n");
    begin = end + 1;
  }
  return text;
}

// The items of a tree as a block with one line each.
std::string block_of(const YamlNode& collection, std::size_t first, std::size_t count) {
  YamlNode list;
  list.kind = YamlNode::Kind::kList;
  list.key = "items";
  for (std::size_t i = first; i < first + count; ++i) {
    YamlNode item = collection.items[i];
    if (collection.kind == YamlNode::Kind::kMap) {
      YamlNode map;
      map.kind = YamlNode::Kind::kMap;
      map.items.push_back(std::move(item));
      item = std::move(map);
    }
    list.items.push_back(std::move(item));
  }
  YamlNode root;
  root.kind = YamlNode::Kind::kMap;
  root.items.push_back(std::move(list));
  const std::string text = yaml_text(root);
  const std::string block = shifted(std::string_view(text).substr(text.find('\n') + 1), -2);
  if (collection.kind != YamlNode::Kind::kMap) return block;
  std::string entries;  // "- {key: value}" becomes "key: value"
  for (std::size_t begin = 0; begin < block.size();) {
    const std::size_t end = block.find('\n', begin);
    entries += block.substr(begin + 3, end - begin - 4) + "\n";
    begin = end + 1;
  }
  return entries;
}

// Entries of a block with one line each, as they stand in flow style.
std::string flow_of(const std::string& block, bool is_map) {
  std::string text;
  for (std::size_t begin = 0; begin < block.size();) {
    const std::size_t end = block.find('\n', begin);
    const std::size_t dash = is_map ? 0 : 2;
    text += (text.empty() ? "" : ", ") + block.substr(begin + dash, end - begin - dash);
    begin = end + 1;
  }
  return text;
}

}  // namespace

std::string YamlDocument::items_text(const YamlPath& collection, std::size_t first, std::size_t count) const {
  YamlNode& root = const_cast<YamlNode&>(tree_);  // only read
  const auto [node, place, in_flow] = find_collection(source_, collection, root, places());
  if (first + count > node->items.size())
    throw InputError(source_, node->line, std::to_string(first + count) + " items",
                     "at most " + std::to_string(node->items.size()));
  if (count == 0) return {};
  const Lines lines(text_);
  const std::size_t begin = start_of(text_, *place, place->items[first]);
  if (place->is_flow() || !lines.is_first_on_line(begin)) return block_of(*node, first, count);
  const auto [from, to] = lines.run_with_comments(*place, first, count);
  return shifted(std::string_view(text_).substr(from, to - from),
                 -static_cast<std::ptrdiff_t>(lines.column(begin)));
}

void YamlDocument::insert_items(const YamlPath& collection, std::size_t index, std::string_view block) {
  YamlNode intended = tree_;
  const auto [node, place, in_flow] = find_collection(source_, collection, intended, places());
  if (index > node->items.size())
    throw InputError(source_, node->line, "a place after item " + std::to_string(index),
                     "at most " + std::to_string(node->items.size()));
  YamlNode added = parse_yaml("items:\n" + shifted(block, 2), source_).items.front();
  const bool fits =
      added.kind == node->kind ||
      (node->items.empty() && (added.kind == YamlNode::Kind::kMap || added.kind == YamlNode::Kind::kList));
  if (!fits)
    throw InputError(source_, node->line, one_line(block),
                     node->kind == YamlNode::Kind::kMap ? "keys and values" : "lines that begin with \"- \"");
  const bool was_empty = node->items.empty();
  const bool is_map = added.kind == YamlNode::Kind::kMap;
  node->kind = added.kind;
  node->items.insert(node->items.begin() + static_cast<std::ptrdiff_t>(index), added.items.begin(),
                     added.items.end());

  const Lines lines(text_);
  if (was_empty && !in_flow && place->key_end > 0) {
    // "steps: []" becomes a block of its own, indented by two more than its key.
    const std::size_t colon = text_.find(':', place->key_end) + 1;
    const std::size_t at = lines.next(colon);
    const auto columns = static_cast<std::ptrdiff_t>(lines.column(place->key_begin)) + 2;
    const bool is_open = text_[at - 1] != '\n';
    return apply({{colon, place->end > colon ? place->end : colon, ""},
                  {at, at, (is_open ? "\n" : "") + shifted(block, columns)}},
                 std::move(intended));
  }
  if (was_empty || place->is_flow()) {
    const std::string entries = flow_of(block_of(added, 0, added.items.size()), is_map);
    if (was_empty) {
      const std::string value = is_map ? "{" + entries + "}" : "[" + entries + "]";
      return apply({{place->begin, place->end, (place->begin == place->end ? " " : "") + value}},
                   std::move(intended));
    }
    if (index == place->items.size())
      return apply({{place->items.back().end, place->items.back().end, ", " + entries}}, std::move(intended));
    const std::size_t begin = start_of(text_, *place, place->items[index]);
    return apply({{begin, begin, entries + ", "}}, std::move(intended));
  }
  const std::size_t column = lines.column(place->begin);
  const std::string text = shifted(block, static_cast<std::ptrdiff_t>(column));
  if (index == place->items.size()) {
    const std::size_t at = lines.after_with_comments(place->items.back(), column);
    const bool is_open = at > 0 && text_[at - 1] != '\n';
    return apply({{at, at, (is_open ? "\n" : "") + text}}, std::move(intended));
  }
  const std::size_t begin = start_of(text_, *place, place->items[index]);
  const std::size_t at = lines.is_first_on_line(begin) ? lines.with_comments_above(begin) : begin;
  const bool is_inner = at == begin && column > 0;  // the first item stands behind a dash or a key
  apply({{at, at, is_inner ? text.substr(column) + std::string(column, ' ') : text}}, std::move(intended));
}

void YamlDocument::erase_items(std::span<const YamlItems> runs, Comments comments) {
  YamlNode intended = tree_;
  std::vector<Change> changes;
  // From the end on, so that the tree has the indices of the text.
  for (std::size_t i = runs.size(); i-- > 0;) add_erasure(runs[i], comments, intended, changes);
  apply(std::move(changes), std::move(intended));
}

void YamlDocument::add_erasure(const YamlItems& run, Comments comments, YamlNode& intended,
                               std::vector<Change>& changes) const {
  if (run.count == 0) return;
  const auto [node, place, in_flow] = find_collection(source_, run.collection, intended, places());
  const std::size_t end = run.first + run.count;
  if (end > node->items.size())
    throw InputError(source_, node->line, std::to_string(end) + " items",
                     "at most " + std::to_string(node->items.size()));
  const auto from = node->items.begin() + static_cast<std::ptrdiff_t>(run.first);
  node->items.erase(from, from + static_cast<std::ptrdiff_t>(run.count));

  const Lines lines(text_);
  const auto start = [&](std::size_t item) { return start_of(text_, *place, place->items[item]); };
  const bool is_last = end == place->items.size();
  if (place->is_flow()) {
    const std::size_t begin = is_last && run.first > 0 ? place->items[run.first - 1].end : start(run.first);
    changes.push_back({begin, is_last ? place->items.back().end : start(end), ""});
    return;
  }
  if (node->items.empty()) {
    const std::string empty = place->is_map() ? "{}" : "[]";
    const std::size_t colon = place->key_end > 0 ? text_.find(':', place->key_end) + 1 : 0;
    if (colon == 0 || lines.next(colon) > lines.begin(start(0))) {  // the key has no line of its own
      const std::size_t begin = colon == 0 ? place->begin : colon;
      changes.push_back({begin, place->end, (colon == 0 ? "" : " ") + empty});
      return;
    }
    changes.push_back({colon, colon, " " + empty});
  }
  const std::size_t first = start(run.first);
  if (!lines.is_first_on_line(first)) {  // stands behind a dash
    changes.push_back({first, is_last ? place->items.back().end : start(end), ""});
    return;
  }
  if (comments == Comments::kErase) {
    const auto [begin, behind] = lines.run_with_comments(*place, run.first, run.count);
    changes.push_back({begin, behind, ""});
    return;
  }
  for (std::size_t i = run.first; i < end; ++i)
    changes.push_back({lines.begin(start(i)), lines.after(place->items[i]), ""});
}

void YamlDocument::replace_items(const YamlItems& run, std::string_view block) {
  if (run.count == 0) return insert_items(run.collection, run.first, block);
  YamlNode intended = tree_;
  const auto [node, place, in_flow] = find_collection(source_, run.collection, intended, places());
  YamlNode added = parse_yaml("items:\n" + shifted(block, 2), source_).items.front();
  if (run.first + run.count > node->items.size() || added.kind != node->kind)
    throw InputError(source_, node->line, one_line(block), "as many items as there are, of their kind");
  const auto at = node->items.begin() + static_cast<std::ptrdiff_t>(run.first);
  node->items.erase(at, at + static_cast<std::ptrdiff_t>(run.count));
  node->items.insert(node->items.begin() + static_cast<std::ptrdiff_t>(run.first), added.items.begin(),
                     added.items.end());

  const Lines lines(text_);
  const std::size_t first = start_of(text_, *place, place->items[run.first]);
  if (place->is_flow()) {
    const std::string entries = flow_of(block_of(added, 0, added.items.size()), place->is_map());
    return apply({{first, place->items[run.first + run.count - 1].end, entries}}, std::move(intended));
  }
  const std::size_t column = lines.column(first);
  const auto [begin, end] = lines.run_with_comments(*place, run.first, run.count);
  const std::string text = shifted(block, static_cast<std::ptrdiff_t>(column));
  const bool is_inner = !lines.is_first_on_line(first);
  apply({{is_inner ? first : begin, end, is_inner ? text.substr(column) : text}}, std::move(intended));
}

}  // namespace koboshi
