#include "base/edit/unified_diff.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

namespace koboshi {
namespace {

constexpr std::size_t kContext = 3;  // lines

using LineTexts = std::vector<std::string_view>;

LineTexts split_lines(std::string_view text) {
  LineTexts lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    lines.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return lines;
}

// A run of lines that became another one.
struct Block {
  std::size_t before = 0;  // first line
  std::size_t before_count = 0;
  std::size_t after = 0;
  std::size_t after_count = 0;
};

// Finds the blocks. After a difference, the shortest pair of runs is left out that ends before equal lines.
std::vector<Block> find_blocks(const LineTexts& before, const LineTexts& after) {
  std::vector<Block> blocks;
  std::size_t a = 0;
  std::size_t b = 0;
  const auto resume = [&](std::size_t skipped) -> std::optional<std::size_t> {
    for (std::size_t of_a = 0; of_a <= skipped; ++of_a) {
      const std::size_t i = a + of_a;
      const std::size_t j = b + skipped - of_a;
      const bool at_ends = i == before.size() && j == after.size();
      if (at_ends || (i < before.size() && j < after.size() && before[i] == after[j])) return of_a;
    }
    return std::nullopt;
  };
  while (a < before.size() || b < after.size()) {
    if (a < before.size() && b < after.size() && before[a] == after[b]) {
      ++a;
      ++b;
      continue;
    }
    std::size_t skipped = 1;
    while (!resume(skipped)) ++skipped;
    const std::size_t of_a = *resume(skipped);
    blocks.push_back({a, of_a, b, skipped - of_a});
    a += of_a;
    b += skipped - of_a;
  }
  return blocks;
}

class Hunks {
 public:
  Hunks(const LineTexts& before, const LineTexts& after) : before_(before), after_(after) {}

  std::string text(const std::vector<Block>& blocks) const {
    std::string text;
    for (std::size_t first = 0; first < blocks.size();) {
      std::size_t last = first;
      while (last + 1 < blocks.size() && blocks[last + 1].before - end(blocks[last]) <= 2 * kContext) ++last;
      text += hunk({blocks.begin() + static_cast<std::ptrdiff_t>(first),
                    blocks.begin() + static_cast<std::ptrdiff_t>(last) + 1});
      first = last + 1;
    }
    return text;
  }

 private:
  static std::size_t end(const Block& block) { return block.before + block.before_count; }

  std::string hunk(const std::vector<Block>& blocks) const {
    const std::size_t lead = std::min(kContext, blocks.front().before);
    const std::size_t begin = blocks.front().before - lead;
    const std::size_t stop = std::min(end(blocks.back()) + kContext, before_.size());
    const std::size_t after_begin = blocks.front().after - lead;
    const std::size_t after_stop =
        blocks.back().after + blocks.back().after_count + stop - end(blocks.back());
    std::string text = "@@ -" + range(begin, stop) + " +" + range(after_begin, after_stop) + " @@\n";
    std::size_t at = begin;
    for (const Block& block : blocks) {
      for (; at < block.before; ++at) text += line(' ', before_[at]);
      for (; at < end(block); ++at) text += line('-', before_[at]);
      for (std::size_t i = 0; i < block.after_count; ++i) text += line('+', after_[block.after + i]);
    }
    for (; at < stop; ++at) text += line(' ', before_[at]);
    return text;
  }

  static std::string range(std::size_t begin, std::size_t stop) {
    return std::to_string(begin + (stop > begin ? 1 : 0)) + "," + std::to_string(stop - begin);
  }

  static std::string line(char mark, std::string_view text) {
    const bool is_open = !text.ends_with('\n');
    return mark + std::string(text) + (is_open ? "\n\\ No newline at end of file\n" : "");
  }

  const LineTexts& before_;
  const LineTexts& after_;
};

}  // namespace

std::string unified_diff(std::string_view before, std::string_view after, const std::string& name) {
  const LineTexts lines_before = split_lines(before);
  const LineTexts lines_after = split_lines(after);
  const std::string hunks = Hunks(lines_before, lines_after).text(find_blocks(lines_before, lines_after));
  return hunks.empty() ? hunks : "--- " + name + "\n+++ " + name + "\n" + hunks;
}

}  // namespace koboshi
