#include "tools/diff/trace_diff.h"

#include <gmock/gmock.h>

#include "base/text/error.h"
#include "tests/unit/tools/diff/run_files.h"

namespace koboshi::tools {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kTrace = "time_s,state,knee_rad\n0,1,0.5\n0.01,2,0.25\n";

class TraceDiff : public RunFiles {
 protected:
  std::optional<TraceDifference> compare(const std::string& text_a, const std::string& text_b) {
    write(a() / "trace.csv", text_a);
    write(b() / "trace.csv", text_b);
    return compare_traces(a() / "trace.csv", b() / "trace.csv");
  }
};

TEST_F(TraceDiff, FindsEqualTracesEqual) { EXPECT_FALSE(compare(kTrace, kTrace)); }

TEST_F(TraceDiff, NamesTickAndVariablesOfTheFirstDifference) {
  const auto difference =
      compare(kTrace, "time_s,state,knee_rad\n0,1,0.5\n0.01,3,0.250000000000001\n0.02,9,9\n");
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->line, 3);
  EXPECT_EQ(difference->time_s, "0.01");
  EXPECT_FALSE(difference->ended);
  EXPECT_THAT(difference->cells, ElementsAre(CellDifference{"state", "2", "3"},
                                             CellDifference{"knee_rad", "0.25", "0.250000000000001"}));
}

TEST_F(TraceDiff, ReportsWhichTraceEndsFirst) {
  const auto difference = compare(kTrace, kTrace + "0.02,2,0\n");
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->ended, 'A');
  EXPECT_EQ(difference->time_s, "0.02");
  EXPECT_EQ(compare(kTrace + "0.02,2,0\n", kTrace)->ended, 'B');
}

TEST_F(TraceDiff, ComparesHeaders) {
  const auto difference = compare(kTrace, "time_s,state,hip_rad,x\n0,1,0.5,0\n");
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->line, 1);
  EXPECT_THAT(difference->cells, ElementsAre(CellDifference{"column 3", "knee_rad", "hip_rad"},
                                             CellDifference{"column 4", "", "x"}));
}

TEST_F(TraceDiff, RejectsAFileThatIsNoTrace) {
  EXPECT_THROW(static_cast<void>(compare("", kTrace)), InputError);
  try {
    static_cast<void>(compare(kTrace, "time_s,state,knee_rad\n0,1\n"));
    FAIL() << "a short row was taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("trace.csv:2: found 2 cells"));
  }
  std::filesystem::remove(a() / "trace.csv");
  EXPECT_THROW(static_cast<void>(compare_traces(a() / "trace.csv", b() / "trace.csv")), InputError);
}

}  // namespace
}  // namespace koboshi::tools
