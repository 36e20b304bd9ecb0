// Where the values of a document stand, and what is no YAML.

#include "base/yaml/yaml_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "base/text/error.h"

namespace koboshi {
namespace {

std::string place(const YamlNode& node) {
  return std::to_string(node.line) + ":" + std::to_string(node.column) + " " +
         std::to_string(node.value_line) + ":" + std::to_string(node.value_column);
}

YamlNode value(const std::string& text) { return parse_yaml(text, "FILE").items.front(); }

std::string error_of(const std::string& text) {
  try {
    static_cast<void>(parse_yaml(text, "FILE"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(YamlTree, GivesTheFirstByteOfKeyAndValue) {
  EXPECT_EQ(place(value("# c\nkey: 1\n")), "2:1 2:6");
  EXPECT_EQ(place(value("key: 'q'\n")), "1:1 1:6");
  EXPECT_EQ(place(value("key: \"q\"\n")), "1:1 1:6");
  EXPECT_EQ(place(value("key:\n  a: 1\n")), "1:1 2:3");
  EXPECT_EQ(place(value("key: {a: 1}\n")), "1:1 1:6");
  EXPECT_EQ(place(value("key:\n  - a\n").items.front()), "2:5 2:5");
  EXPECT_EQ(place(value("key:\n  - a: 1\n    b: 2\n").items.front().items.back()), "3:5 3:8");
}

TEST(YamlTree, PlacesAPairOfAFlowListAtItsKey) {
  const YamlNode pair = value("key: [a: 1]\n").items.front();
  EXPECT_EQ(pair.kind, YamlNode::Kind::kMap);
  EXPECT_EQ(place(pair), "1:7 1:7");
}

TEST(YamlTree, TellsTextFromNumbersAndNull) {
  EXPECT_TRUE(value("key: '7'\n").quoted);
  EXPECT_FALSE(value("key: 7\n").quoted);
  EXPECT_EQ(value("key: |\n  a\n  b\n").scalar, "a\nb\n");
  for (const char* text : {"key:\n", "key: ~\n", "key: null\n"})
    EXPECT_EQ(value(text).kind, YamlNode::Kind::kNull) << text;
  EXPECT_EQ(value("key: 'null'\n").kind, YamlNode::Kind::kScalar);
}

// The parser of the library stops at a NUL as at the end of the text.
TEST(YamlTree, RefusesControlCharacters) {
  using namespace std::string_literals;
  EXPECT_THAT(
      error_of("a: 1\nb: 2\0\nc: 3\n"s),
      testing::MatchesRegex("FILE:2: found the character .*, expected text without control characters"));
  EXPECT_THAT(error_of("a: 1\x1B[31m\n"), testing::StartsWith("FILE:1: found the character"));
  EXPECT_EQ(error_of("a: 1\t# tab\r\n"), "nothing");
}

TEST(YamlTree, SaysWhatIsMalformedAndWhere) {
  EXPECT_EQ(
      error_of("a: 1\nb: [1, 2\n"),
      "FILE:3: found malformed YAML: flow sequence without a closing bracket, expected well-formed YAML");
  EXPECT_EQ(error_of("a: @x\n"),
            "FILE:1: found malformed YAML: plain scalar cannot start with '@', expected well-formed YAML");
}

TEST(YamlTree, ReadsCharactersBeyondTheBasicPlane) {
  EXPECT_EQ(value("key: \"\\U0001F600\"\n").scalar, "\xF0\x9F\x98\x80");
}

}  // namespace
}  // namespace koboshi
