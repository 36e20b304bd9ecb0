#include "tools/policy/recorded_inputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text/error.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::tools {
namespace {

using ::testing::HasSubstr;

class RecordedInputs : public ::testing::Test {
 protected:
  std::vector<std::vector<double>> read(const std::string& text, const std::vector<std::string>& names) {
    test::write_file(folder_.path / "inputs.csv", text);
    return read_recorded_columns(folder_.path / "inputs.csv", names);
  }
  std::string refusal(const std::string& text) {
    try {
      read(text, {"b", "a"});
      return "none";
    } catch (const InputError& error) {
      return error.what();
    }
  }

  test::TemporaryFolder folder_;
};

TEST_F(RecordedInputs, AreTheNamedColumnsInTheirOrder) {
  const std::vector<std::vector<double>> expected{{2.5, 1.0}, {-4.0, 3.0}};
  EXPECT_EQ(read("a,x,b\n1,walking,2.5\n3,,-4\n", {"b", "a"}), expected);
  EXPECT_EQ(read("a,x,b\r\n1,walking,2.5\r\n\r\n3,,-4", {"b", "a"}), expected);
}

TEST_F(RecordedInputs, NameLineAndColumnOfAnError) {
  EXPECT_THAT(refusal("a,x\n1,2\n"), HasSubstr("inputs.csv:1: found no column b"));
  EXPECT_THAT(refusal("a,b\n1,2\n1,two\n"),
              HasSubstr("inputs.csv:3: found column b = two, expected a number"));
  EXPECT_THAT(refusal("a,b\n1\n"), HasSubstr("inputs.csv:2: found column b = nothing"));
  EXPECT_THAT(refusal("a,b\n1,nan\n"), HasSubstr("column b = nan"));
  EXPECT_THAT(refusal("a,b\n"), HasSubstr("no rows"));
  EXPECT_THAT(refusal(""), HasSubstr("no column b"));
}

}  // namespace
}  // namespace koboshi::tools
