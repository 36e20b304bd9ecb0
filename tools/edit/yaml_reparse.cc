#include <algorithm>
#include <set>
#include <utility>

#include "base/text/error.h"
#include "tools/edit/yaml_document.h"
#include "tools/edit/yaml_lines.h"

// Parsing only the items of a block list or map in which an edit lies: yaml-cpp takes six times as long as
// libfyaml for a text.
namespace koboshi::tools {
namespace {

constexpr std::string_view kWrapper = "x:\n";  // makes the root of some items a map

// Items of a collection in block style, with all lines from the first to the end.
struct Region {
  std::vector<std::size_t> collection;  // indices from the root
  const YamlPlace* place = nullptr;
  std::size_t first = 0;
  std::size_t last = 0;
  std::size_t begin = 0;  // bytes
  std::size_t end = 0;
};

// Returns the innermost items that contain a change. The region has no place if only the root has them.
Region find_region(std::string_view text, const YamlPlace& root, std::size_t begin, std::size_t end) {
  const Lines lines(text);
  Region found;
  std::vector<std::size_t> indices;
  for (const YamlPlace* place = &root; place->is_block() && !place->items.empty();) {
    const auto start = [&](std::size_t item) { return start_of(text, *place, place->items[item]); };
    const std::size_t count = place->items.size();
    if (begin <= start(0)) break;
    std::size_t first = 0;
    while (first + 1 < count && lines.begin(start(first + 1)) <= begin) ++first;
    std::size_t last = first;
    while (last + 1 < count && lines.begin(start(last + 1)) < end) ++last;
    std::size_t region_end =
        last + 1 < count ? lines.begin(start(last + 1)) : lines.after(place->items[last]);
    // At the end of a list, comments may follow that belong to it.
    if (end > region_end) region_end = end;
    const bool has_whole_lines = region_end == text.size() || text[region_end - 1] == '\n';
    if (place != &root && has_whole_lines && lines.is_first_on_line(start(first)))
      found = {indices, place, first, last, lines.begin(start(first)), region_end};
    if (first != last) break;
    indices.push_back(first);
    place = &place->items[first];
  }
  return found;
}

// Gives a node and its items another path, and moves them by some lines.
void relocate(YamlNode& node, int lines, std::size_t prefix, const std::string& path) {
  node.line += lines;
  node.value_line += lines;
  node.path.replace(0, prefix, path);
  for (YamlNode& item : node.items) relocate(item, lines, prefix, path);
}

// Moves all nodes behind a line.
void shift_lines(YamlNode& node, int after, int lines) {
  if (node.line > after) node.line += lines;
  if (node.value_line > after) node.value_line += lines;
  for (YamlNode& item : node.items) shift_lines(item, after, lines);
}

std::string item_path(const YamlNode& collection, std::size_t index) {
  if (collection.kind == YamlNode::Kind::kMap) return collection.path + "." + collection.items[index].key;
  return collection.path + "[" + std::to_string(index) + "]";
}

// Whether two texts have the same values in places of the same length, but for the items of the region.
// `count`: of its items in the other text.
bool same_but(const Region& region, std::size_t count, const YamlPlace& one, const YamlPlace& other) {
  if (one.kind != other.kind || one.key != other.key) return false;
  if (one.items.empty() && one.end - one.begin != other.end - other.begin) return false;
  const auto same = [&](const YamlPlace& item, const YamlPlace& other_item) {
    return same_but(region, count, item, other_item);
  };
  if (&one != region.place) return std::ranges::equal(one.items, other.items, same);
  const std::size_t behind = one.items.size() - region.last - 1;
  return other.items.size() == region.first + count + behind &&
         std::equal(one.items.begin(), one.items.begin() + static_cast<std::ptrdiff_t>(region.first),
                    other.items.begin(), same) &&
         std::equal(one.items.end() - static_cast<std::ptrdiff_t>(behind), one.items.end(),
                    other.items.end() - static_cast<std::ptrdiff_t>(behind), same);
}

// Whether libfyaml finds the maps, keys and lists that yaml-cpp has found.
bool fits(const YamlPlace& place, const YamlNode& node) {
  return place.is_map() == (node.kind == YamlNode::Kind::kMap) &&
         place.is_list() == (node.kind == YamlNode::Kind::kList) && place.key == node.key &&
         std::ranges::equal(place.items, node.items, fits);
}

// Whether a value ends with one that is missing. yaml-cpp places it at whatever comes next.
bool ends_empty(const YamlNode& node) {
  const bool is_leaf = node.items.empty();
  return is_leaf ? node.kind == YamlNode::Kind::kNull : ends_empty(node.items.back());
}

bool has_second_key(const YamlNode& collection) {
  if (collection.kind != YamlNode::Kind::kMap) return false;
  std::set<std::string_view> keys;
  return !std::ranges::all_of(collection.items,
                              [&](const YamlNode& item) { return keys.insert(item.key).second; });
}

template <typename Tree>
Tree& descend(Tree& root, const std::vector<std::size_t>& indices) {
  Tree* node = &root;
  for (const std::size_t index : indices) node = &node->items.at(index);
  return *node;
}

}  // namespace

// Returns the tree and the places of a text in which the bytes from `begin` on differ, up to `end` in the
// present text. Returns nothing if the change is not within items of a block, or if there is any doubt.
std::optional<YamlDocument::Parsed> YamlDocument::reparse_items(const std::string& text, std::size_t begin,
                                                                std::size_t end) const {
  const Region region = find_region(text_, places(), begin, end);
  if (region.place == nullptr) return std::nullopt;
  const std::size_t new_end = region.end + text.size() - text_.size();
  try {
    YamlNode wrapped =
        parse_yaml(std::string(kWrapper) + text.substr(region.begin, new_end - region.begin), source_);
    if (wrapped.items.size() != 1) return std::nullopt;
    YamlNode& items = wrapped.items.front();
    const std::size_t count = items.items.size();

    Parsed parsed{tree_, locate_yaml(text, source_)};
    YamlNode& collection = descend(parsed.tree, region.collection);
    const YamlPlace& new_place = descend(std::as_const(parsed.places), region.collection);
    if (count == 0 || items.kind != collection.kind || ends_empty(items)) return std::nullopt;
    if (!same_but(region, count, places(), parsed.places)) return std::nullopt;
    const Lines new_lines(text);
    const std::size_t first = start_of(text, new_place, new_place.items[region.first]);
    const bool begins_there = new_lines.begin(first) == region.begin;  // what comes before may point to it
    if (!begins_there || new_lines.after(new_place.items[region.first + count - 1]) > new_end)
      return std::nullopt;

    const auto lines_between = [](std::string_view in, std::size_t from, std::size_t to) {
      return static_cast<int>(std::ranges::count(in.substr(from, to - from), '\n'));
    };
    const int above = lines_between(text_, 0, region.begin);
    const int old_lines = lines_between(text_, region.begin, region.end);
    const int new_count = lines_between(text, region.begin, new_end);
    if (new_count != old_lines) shift_lines(parsed.tree, above + old_lines, new_count - old_lines);
    const std::size_t old_count = region.last - region.first + 1;
    const auto at = collection.items.begin() + static_cast<std::ptrdiff_t>(region.first);
    collection.items.erase(at, at + static_cast<std::ptrdiff_t>(old_count));
    collection.items.insert(collection.items.begin() + static_cast<std::ptrdiff_t>(region.first),
                            std::make_move_iterator(items.items.begin()),
                            std::make_move_iterator(items.items.end()));
    for (std::size_t i = region.first; i < collection.items.size(); ++i) {
      YamlNode& item = collection.items[i];
      const bool is_new = i < region.first + count;
      if (!is_new && count == old_count) break;  // those behind keep their places
      if (is_new && !fits(new_place.items[i], item)) return std::nullopt;
      relocate(item, is_new ? above - 1 : 0, item.path.size(), item_path(collection, i));
    }
    if (has_second_key(collection)) return std::nullopt;
    return parsed;
  } catch (const InputError&) {
    return std::nullopt;  // the whole text gives the message
  }
}

}  // namespace koboshi::tools
