#include "base/text/text.h"

#include "base/text/shell_word.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/text/error.h"
#include "base/text/units.h"

namespace koboshi {
namespace {

const std::vector<std::string> kVerbs{"enable", "play", "walk", "stop", "get_up"};

TEST(NearestName, IsTheNameThatDiffersLeast) {
  EXPECT_EQ(nearest_name("wlak", kVerbs), "walk");  // two letters have changed places
  EXPECT_EQ(nearest_name("stp", kVerbs), "stop");
  EXPECT_EQ(nearest_name("enabled", kVerbs), "enable");
  EXPECT_EQ(nearest_name("get-up", kVerbs), "get_up");
}

TEST(NearestName, IsEmptyWithoutASimilarName) {
  EXPECT_FALSE(nearest_name("nonsense", kVerbs));
  EXPECT_FALSE(nearest_name("", kVerbs));
  EXPECT_FALSE(nearest_name("walk", {}));
  EXPECT_FALSE(nearest_name(std::string(100'000, 'w'), kVerbs));
}

TEST(ExpectedNames, EndWithTheMostSimilar) {
  EXPECT_EQ(expected_names("wlak", kVerbs), "enable, play, walk, stop or get_up; the nearest is walk");
  EXPECT_EQ(expected_names("nonsense", kVerbs), "enable, play, walk, stop or get_up");
  EXPECT_EQ(expected_names("waalk", std::array<std::string, 1>{"walk"}), "walk");
}

TEST(ExpectedNames, AreTheMostSimilarOnlyForALongList) {
  std::vector<std::string> names(kVerbs);
  for (int i = 0; i < 20; ++i) names.push_back("joint_" + std::to_string(i));
  EXPECT_EQ(expected_names("wlak", names), "walk, the nearest of 25 names");
}

TEST(OneLine, EndsBetweenCharactersAndIsUtf8) {
  EXPECT_EQ(one_line("tab\tand\nline"), "tab and line");
  EXPECT_EQ(one_line("k\xF6"
                     "boshi"),
            "k\\xF6"
            "boshi");
  for (const std::string character : {"a", "\u00E4", "\u6F22", "\U0001F916"}) {
    for (std::size_t offset = 0; offset < character.size(); ++offset) {
      std::string text(offset, 'x');
      for (int i = 0; i < 100; ++i) text += character;
      const std::string line = one_line(text);
      EXPECT_EQ(find_invalid_utf8(line), std::string_view::npos) << line;
      EXPECT_TRUE(line.ends_with(character + "...")) << line;
    }
  }
}

TEST(OneLine, ShowsWhatNobodySees) {
  EXPECT_EQ(one_line("a\u202Eb"), "a\\u202Eb");  // the rest would run from right to left
  for (const auto& [text, shown] :
       std::vector<std::pair<std::string, std::string>>{{"\u202A", "\\u202A"},
                                                        {"\u2066", "\\u2066"},
                                                        {"\u2069", "\\u2069"},
                                                        {"\u00A0", "\\u00A0"},
                                                        {"\u200B", "\\u200B"},
                                                        {"\u200F", "\\u200F"},
                                                        {"\uFEFF", "\\uFEFF"},
                                                        {"\u0085", "\\u0085"},
                                                        {"\u00AD", "\\u00AD"},
                                                        {"\u2028", "\\u2028"},
                                                        {"\u3000", "\\u3000"},
                                                        {"\U000E0041", "\\U000E0041"}}) {
    EXPECT_EQ(one_line("a" + text + "b"), "a" + shown + "b");
    EXPECT_STREQ(InputError("f" + text, 1, "a", "b").what(),
                 ("f" + shown + ":1: found a, expected b").c_str());
  }
  for (const std::string seen : {"\u00E9", "\u03B1", "\u05D0", "\u81E7", "\U0001F916", "\u00B0"})
    EXPECT_EQ(one_line(seen), seen);
  EXPECT_EQ(utf8_text("\x1B[2J\n"), "\\x1B[2J\n");
  EXPECT_EQ(utf8_line("\x1B[2J\n\na"), "\\x1B[2J\\x0A\\x0Aa");
}

TEST(InputErrorText, IsUtf8WhateverItQuotes) {
  const InputError error(
      "f\xFC"
      "r.yaml",
      3, "\xFF", "a name");
  EXPECT_STREQ(error.what(),
               "f\\xFC"
               "r.yaml:3: found \\xFF, expected a name");
  EXPECT_STREQ(InputError("a\nb", 1, "c\nd", "e\n").what(), "a\\x0Ab:1: found c\\x0Ad, expected e\\x0A");
  EXPECT_EQ(error.file(),
            "f\xFC"
            "r.yaml");
}

TEST(NameFault, FindsWhatNobodySees) {
  for (const std::string good : {"a", "left_knee", "two words", "\u81E7", "\U0001F916", "a\u00A0b"})
    EXPECT_EQ(name_fault(good), "") << good;
  EXPECT_EQ(name_fault(""), "an empty text");
  for (const std::string blank : {" ", "\u00A0", "\u3000", "\uFEFF", "\u200B"}) {
    EXPECT_EQ(name_fault("a" + blank), "white space at its end") << blank;
    EXPECT_EQ(name_fault(blank + "a"), "white space at its beginning") << blank;
    EXPECT_EQ(trimmed_name(blank + "a b" + blank + blank), "a b");
  }
  for (const std::string control : {"\x01", "\t", "\n", "\x7F", "\u0085", "\u2028"}) {
    EXPECT_EQ(name_fault("a" + control + "b"), "a control character");
    EXPECT_EQ(trimmed_name(control + "a"), "a");
  }
  EXPECT_EQ(name_fault("a\xFF"), "a byte that is not UTF-8");
  EXPECT_EQ(trimmed_name(" \n"), "");
}

TEST(UnitQuestion, NamesTheFirstUnitThatFits) {
  const auto up_to = [](double limit) { return [limit](double value) { return std::abs(value) <= limit; }; };
  EXPECT_EQ(unit_question(std::array{45.0}, "kg", up_to(2.0)), "did you mean 45 g?");
  EXPECT_EQ(unit_question(std::array{0.0, 0.0, -65.0}, "m", up_to(1.0)), "did you mean 0 0 -65 mm?");
  EXPECT_EQ(unit_question(std::array{140.0}, "rad", up_to(6.3)), "did you mean 140 deg?");
  EXPECT_EQ(unit_question(std::array{45000.0}, "kg", up_to(2.0)), "");
  EXPECT_EQ(unit_question(std::array{45.0}, "1", up_to(2.0)), "");
}

TEST(Texts, AreFormattedForReaders) {
  EXPECT_EQ(count_text(0, "fault"), "0 faults");
  EXPECT_EQ(count_text(1, "fault"), "1 fault");
  EXPECT_EQ(count_text(2, "fault"), "2 faults");
  EXPECT_EQ(degrees_text(2.61799400), "150");  // as a robot's file has it, 150.00000699 degrees
  EXPECT_EQ(degrees_text(-0.25 * std::numbers::pi), "-45");
}

TEST(ShellWord, IsReadAsOneWordByTheShell) {
  EXPECT_EQ(shell_word("robots/kit"), "robots/kit");
  EXPECT_EQ(shell_word("Meine Roboter/kit"), "'Meine Roboter/kit'");
  EXPECT_EQ(shell_word("the maker's"), "'the maker'\\''s'");
  EXPECT_EQ(shell_word("~kit"), "'~kit'");
  EXPECT_EQ(shell_word(""), "''");
}

}  // namespace
}  // namespace koboshi
