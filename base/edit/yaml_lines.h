#pragma once

#include <algorithm>
#include <string_view>
#include <utility>

#include "base/edit/yaml_places.h"
#include "base/yaml/yaml_tree.h"

namespace koboshi {

// First byte of an entry or item, with its key or dash.
inline std::size_t start_of(std::string_view text, const YamlPlace& parent, const YamlPlace& item) {
  if (parent.is_map()) return item.key_begin;
  return parent.is_flow() ? item.begin : text.rfind('-', item.begin - 1);
}

// The lines of a YAML text.
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
  // The first byte after an item that begins in this column: after its last line, and the comments below that
  // are indented deeper than the item.
  std::size_t after_with_comments(const YamlPlace& place, std::size_t item_column) const {
    std::size_t end = after(place);
    for (std::size_t line = end; line < text_.size(); line = next(line)) {
      const std::size_t first = text_.find_first_not_of(' ', line);
      if (first == std::string_view::npos) break;
      if (text_[first] == '\n') continue;
      if (text_[first] != '#' || first - line <= item_column) break;
      end = next(line);
    }
    return end;
  }
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
  // The bytes of some items of a block with all comments between them, directly above and below.
  std::pair<std::size_t, std::size_t> run_with_comments(const YamlPlace& block, std::size_t first,
                                                        std::size_t count) const {
    const std::size_t begin = start_of(text_, block, block.items[first]);
    return {with_comments_above(begin), after_with_comments(block.items[first + count - 1], column(begin))};
  }

 private:
  std::string_view text_;
};

// Whether two trees have the same keys and values, wherever they stand.
inline bool same_values(const YamlNode& one, const YamlNode& other) {
  return one.kind == other.kind && one.key == other.key && one.scalar == other.scalar &&
         one.quoted == other.quoted && std::ranges::equal(one.items, other.items, same_values);
}

}  // namespace koboshi
