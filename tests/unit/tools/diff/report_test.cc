#include "tools/diff/report.h"

#include <gmock/gmock.h>

#include "base/text/error.h"
#include "tests/unit/tools/diff/run_files.h"

namespace koboshi::tools {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Report : public RunFiles {
 protected:
  Report() {
    for (const auto& folder : {a(), b()}) {
      write(folder / "trace.csv", "time_s,state\n0,1\n0.01,2\n");
      write(folder / "can.log", "(0.000500) vcan0 201#01\n(0.012000) vcan0 201#02\n");
    }
  }
};

TEST_F(Report, ReportsIdenticalRuns) {
  const RunComparison comparison = compare_runs(a(), b());
  EXPECT_TRUE(comparison.same);
  EXPECT_THAT(comparison.report, HasSubstr("the same"));
}

TEST_F(Report, ShowsBothValuesAndFrames) {
  write(b() / "trace.csv", "time_s,state\n0,1\n0.01,7\n");
  write(b() / "can.log", "(0.000500) vcan0 201#01\n(0.012000) vcan0 201#03\n");
  const RunComparison comparison = compare_runs(a(), b());
  EXPECT_FALSE(comparison.same);
  EXPECT_THAT(comparison.report, HasSubstr("the tick at 0.01 s"));
  EXPECT_THAT(comparison.report, HasSubstr("A 2"));
  EXPECT_THAT(comparison.report, HasSubstr("B 7"));
  EXPECT_THAT(comparison.report, HasSubstr("can.log: line 2\n    (0000000000.000500) vcan0 201#01\n"));
  EXPECT_THAT(comparison.report, HasSubstr("A (0000000000.012000) vcan0 201#02\n"));
  EXPECT_THAT(comparison.report, HasSubstr("B (0000000000.012000) vcan0 201#03\n"));
}

TEST_F(Report, ShowsTheBusEvenWhereOnlyTheTraceDiffers) {
  write(b() / "trace.csv", "time_s,state\n0,1\n0.01,7\n");
  const RunComparison comparison = compare_runs(a(), b());
  EXPECT_FALSE(comparison.same);
  EXPECT_THAT(comparison.report, HasSubstr("201#01"));
  EXPECT_THAT(comparison.report, Not(HasSubstr("201#02")));  // after that tick
}

TEST_F(Report, RejectsAFolderWithoutARun) {
  EXPECT_THROW(static_cast<void>(compare_runs(a(), b() / "none")), InputError);
}

}  // namespace
}  // namespace koboshi::tools
