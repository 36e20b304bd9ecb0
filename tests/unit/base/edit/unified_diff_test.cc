#include "base/edit/unified_diff.h"

#include <gtest/gtest.h>

#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace koboshi {
namespace {

TEST(UnifiedDiff, ShowsChangedLinesWithTheirContext) {
  EXPECT_EQ(unified_diff("a\nb\nc\nd\ne\nf\n", "a\nb\nc\nd\nE\nf\n", "x"),
            "--- x\n+++ x\n@@ -2,5 +2,5 @@\n b\n c\n d\n-e\n+E\n f\n");
  EXPECT_EQ(unified_diff("a\n", "a\nb", "x"),
            "--- x\n+++ x\n@@ -1,1 +1,2 @@\n a\n+b\n\\ No newline at end of file\n");
  EXPECT_EQ(unified_diff("", "a\n", "x"), "--- x\n+++ x\n@@ -0,0 +1,1 @@\n+a\n");
  EXPECT_EQ(unified_diff("same\n", "same\n", "x"), "");
}

// Applies a diff as patch(1) does, by the lines and counts of its hunks.
std::string patched(const std::string& before, const std::string& diff) {
  std::istringstream original(before);
  std::istringstream changes(diff);
  std::string result;
  std::string line;
  std::size_t read = 0;
  const auto copy_line = [&](bool keeps) {
    std::string text;
    EXPECT_TRUE(std::getline(original, text));
    ++read;
    if (keeps) result += text + "\n";
    return text;
  };
  std::getline(changes, line);
  std::getline(changes, line);
  while (std::getline(changes, line)) {
    if (line.starts_with("@@ -")) {
      const std::size_t start = std::stoul(line.substr(4));
      const bool is_empty = line.find(",0 +") != std::string::npos;
      while (read + (is_empty ? 0 : 1) < start) copy_line(true);
    } else if (line[0] == '+') {
      result += line.substr(1) + "\n";
    } else {
      EXPECT_EQ(copy_line(line[0] == ' '), line.substr(1));
    }
  }
  while (std::getline(original, line)) result += line + "\n";
  return result;
}

TEST(UnifiedDiff, AppliesToTheFirstText) {
  std::mt19937 random(3);
  for (int round = 0; round < 300; ++round) {
    std::vector<std::string> lines(random() % 60);
    for (std::string& line : lines) line = std::to_string(random() % 8);
    std::vector<std::string> changed = lines;
    for (auto edits = random() % 6; edits > 0 && !changed.empty(); --edits) {
      const auto at = changed.begin() + static_cast<std::ptrdiff_t>(random() % changed.size());
      if (random() % 2 == 0) {
        changed.erase(at);
      } else {
        changed.insert(at, std::to_string(random() % 8));
      }
    }
    const auto joined = [](const std::vector<std::string>& all) {
      std::string text;
      for (const std::string& line : all) text += line + "\n";
      return text;
    };
    const std::string before = joined(lines);
    const std::string after = joined(changed);
    ASSERT_EQ(patched(before, unified_diff(before, after, "x")), after) << round;
  }
}

}  // namespace
}  // namespace koboshi
