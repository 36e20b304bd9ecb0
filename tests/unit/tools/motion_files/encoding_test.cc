#include "tools/motion_files/format/encoding.h"

#include <gtest/gtest.h>

#include <string>

namespace koboshi::tools {
namespace {

TEST(DecodeText, KnowsJapaneseAndKorean) {
  const DecodedText japanese = decode_text("# \x82\xA8\x82\xB6\x82\xAC\r\n");
  EXPECT_EQ(japanese.encoding, "CP932");
  EXPECT_EQ(japanese.text, "# \xE3\x81\x8A\xE3\x81\x98\xE3\x81\x8E\n");
  const DecodedText korean = decode_text("name=\xB5\xBF\xC0\xDB\r\n");
  EXPECT_EQ(korean.encoding, "EUC-KR");
  EXPECT_EQ(korean.text, "name=\xEB\x8F\x99\xEC\x9E\x91\n");
}

TEST(DecodeText, ReadsByteOrderMarks) {
  EXPECT_EQ(decode_text("\xEF\xBB\xBFtime_s,a").text, "time_s,a");
  const std::string wide("\xFF\xFEt\0,\0a\0\r\0\n\0", 12);
  EXPECT_EQ(decode_text(wide).encoding, "UTF-16");
  EXPECT_EQ(decode_text(wide).text, "t,a\n");
}

TEST(DecodeText, KeepsBytesOfNoEncoding) {
  EXPECT_EQ(decode_text("a\xFF\xFF\xFFz").text, "a\xFF\xFF\xFFz");
  EXPECT_EQ(decode_text("a\xFF\xFF\xFFz").encoding, "");
  EXPECT_EQ(decode_text("").text, "");
}

TEST(DecodeText, ConvertsTextsLongerThanItsBuffer) {
  std::string bytes;
  std::string expected;
  for (int i = 0; i < 5000; ++i) {
    bytes += "x\x82\xA8";
    expected += "x\xE3\x81\x8A";
  }
  EXPECT_EQ(decode_text(bytes).text, expected);
}

}  // namespace
}  // namespace koboshi::tools
