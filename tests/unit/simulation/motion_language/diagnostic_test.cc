#include "simulation/motion_language/parse/diagnostic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace koboshi::simulation {
namespace {

using testing::HasSubstr;

Diagnostic misspelt(int line, int column) {
  return {.code = "M010",
          .place = {.line = line, .column = column, .length = 8},
          .found = "the joint 'left_kne'",
          .expected = "a joint of koboshi",
          .hint = did_you_mean("left_kne", {"left_knee", "head_pan"})};
}

TEST(Diagnostic, PrintsPlaceCodeSourceLineCaretAndTheNearestName) {
  Diagnostics diagnostics("bow.yaml", "poses:\n  bow: {left_kne: 1}\n");
  diagnostics.add(misspelt(2, 9));
  EXPECT_EQ(print(diagnostics.all()),
            "bow.yaml:2:9: error[M010]: found the joint 'left_kne', expected a joint of koboshi\n"
            " 2 |   bow: {left_kne: 1}\n"
            "   |         ^~~~~~~~\n"
            "   = did you mean `left_knee`?\n");
}

TEST(Diagnostic, LeavesOutWhatItDoesNotKnow) {
  Diagnostics diagnostics("bow.yaml", "");
  Diagnostic diagnostic = misspelt(0, 0);
  diagnostic.hint.clear();
  diagnostics.add(diagnostic);
  EXPECT_EQ(print(diagnostics.all()),
            "bow.yaml: error[M010]: found the joint 'left_kne', expected a joint of koboshi\n");
  diagnostic.place.option = "--set";
  EXPECT_THAT(print(diagnostic), testing::StartsWith("--set: error[M010]"));
}

TEST(Diagnostic, QuotesPartOfALongLineWithTheCaretInPlace) {
  Diagnostics diagnostics("long.yaml", std::string(400, 'x') + "\tleft_kne" + std::string(400, 'y'));
  diagnostics.add(misspelt(1, 402));
  const std::string text = print(diagnostics.all());
  const std::size_t quoted = text.find(" | ") + 3;
  const std::size_t caret = text.find('^') - (text.find(" | ", quoted) + 3);
  EXPECT_EQ(text.substr(quoted + caret, 8), "left_kne");
  EXPECT_LT(text.size(), 500u);
}

TEST(Diagnostic, ThrowsTheFirstErrorWithAllMessages) {
  Diagnostics diagnostics("bow.yaml", "a\nb\nc\n");
  Diagnostic warning = misspelt(1, 1);
  warning.severity = Severity::kWarning;
  diagnostics.add(warning);
  EXPECT_NO_THROW(diagnostics.throw_errors());
  diagnostics.add(misspelt(2, 1));
  diagnostics.add(misspelt(2, 1));  // a consequence of the error before
  diagnostics.add(misspelt(3, 1));
  try {
    diagnostics.throw_errors();
    FAIL();
  } catch (const MotionError& error) {
    EXPECT_STREQ(error.what(), "bow.yaml:2: found the joint 'left_kne', expected a joint of koboshi");
    EXPECT_EQ(error.diagnostics().size(), 3u);
  }
}

TEST(Diagnostic, GivesUpAfterTwentyErrors) {
  Diagnostics diagnostics("bow.yaml", "");
  for (int line = 1; line < 20; ++line) diagnostics.add(misspelt(line, 1));
  EXPECT_THROW(diagnostics.add(misspelt(20, 1)), MotionError);
}

TEST(Diagnostic, IsAvailableAsJson) {
  Diagnostics diagnostics("bow.yaml", "a \"b\n");
  diagnostics.add(misspelt(1, 3));
  const std::string text = json_text(diagnostics.all());
  EXPECT_THAT(text, HasSubstr("\"code\": \"M010\""));
  EXPECT_THAT(text, HasSubstr("\"severity\": \"error\""));
  EXPECT_THAT(text, HasSubstr("\"column\": 3"));
  EXPECT_THAT(text, HasSubstr("did you mean `left_knee`?"));
  EXPECT_EQ(json_text({}), "[]\n");
}

}  // namespace
}  // namespace koboshi::simulation
