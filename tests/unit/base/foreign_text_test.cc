#include "base/text/foreign_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <vector>

namespace koboshi {
namespace {

using testing::ElementsAre;

constexpr const char* kMark = "\xEF\xBB\xBF";

std::vector<std::string> lines_of(const std::string& text, bool* last_has_end = nullptr) {
  std::istringstream stream(text);
  LineReader reader(stream);
  std::vector<std::string> lines;
  for (std::string line; reader.next(line);) {
    lines.push_back(line);
    if (last_has_end != nullptr) *last_has_end = reader.has_end();
  }
  return lines;
}

TEST(ForeignText, HasLineFeedsAndNoByteOrderMark) {
  EXPECT_EQ(with_line_feeds(std::string(kMark) + "a\r\nb\rc\n\r\rd"), "a\nb\nc\n\n\nd");
  EXPECT_EQ(with_line_feeds(std::string("a") + kMark), std::string("a") + kMark);
  EXPECT_EQ(with_line_feeds(""), "");
}

TEST(ForeignText, ComparesExtensionsInLowerCase) {
  EXPECT_EQ(extension_of("runs/WALK.ASC"), ".asc");
  EXPECT_EQ(extension_of("a.b/walk.Csv"), ".csv");
  EXPECT_EQ(extension_of("walk"), "");
  EXPECT_EQ(extension_of(".hidden"), "");
}

TEST(LineReader, EndsLinesWithAnyEnd) {
  bool last_has_end = false;
  EXPECT_THAT(lines_of("a\nb\r\nc\rd\n\n\r\re\r\n", &last_has_end),
              ElementsAre("a", "b", "c", "d", "", "", "", "e"));
  EXPECT_TRUE(last_has_end);
  EXPECT_THAT(lines_of("a\rb", &last_has_end), ElementsAre("a", "b"));
  EXPECT_FALSE(last_has_end);
  EXPECT_THAT(lines_of(std::string(kMark) + "a\n" + kMark + "b\n"),
              ElementsAre("a", std::string(kMark) + "b"));
  EXPECT_TRUE(lines_of("").empty());
}

TEST(LineReader, ReadsALongLineInParts) {
  const std::vector<std::string> lines = lines_of(std::string(LineReader::kMaxBytes + 5, 'x') + "\ny\n");
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].size(), LineReader::kMaxBytes);
  EXPECT_EQ(lines[1], "xxxxx");
  EXPECT_EQ(lines[2], "y");
}

}  // namespace
}  // namespace koboshi
