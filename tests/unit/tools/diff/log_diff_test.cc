#include "tools/diff/log_diff.h"

#include "base/text/error.h"
#include "tests/unit/tools/diff/run_files.h"

namespace koboshi::tools {
namespace {

// Lines of a log, one a millisecond; the frame number `odd` carries other data.
std::string log_of(int frames, int odd = -1) {
  std::string text;
  for (int i = 0; i < frames; ++i) {
    text += "(0000000000.00" + std::to_string(1000 + i) + ") vcan0 201#" + (i == odd ? "FF" : "00") + "\n";
  }
  return text;
}

class LogDiff : public RunFiles {
 protected:
  std::optional<LogDifference> compare(const std::string& text_a, const std::string& text_b) {
    write(a() / "can.log", text_a);
    write(b() / "can.log", text_b);
    return compare_logs(a() / "can.log", b() / "can.log");
  }
};

TEST_F(LogDiff, FindsEqualLogsEqual) { EXPECT_FALSE(compare(log_of(30), log_of(30))); }

TEST_F(LogDiff, ShowsTheFramesAroundTheFirstDifference) {
  const auto difference = compare(log_of(30), log_of(30, 10));
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->line, 11u);
  EXPECT_EQ(difference->time_us(), 1010u);
  ASSERT_EQ(difference->before.size(), kFramesBefore);
  EXPECT_EQ(difference->before.back().time_us, 1009u);
  ASSERT_EQ(difference->a.size(), kFramesAfter);
  ASSERT_EQ(difference->b.size(), kFramesAfter);
  EXPECT_EQ(std::get<hal::CanFrame>(difference->a[0].frame).data[0], 0x00);
  EXPECT_EQ(std::get<hal::CanFrame>(difference->b[0].frame).data[0], 0xFF);
  EXPECT_EQ(difference->a[1], difference->b[1]);
}

TEST_F(LogDiff, CountsAShiftInTimeAsADifference) {
  const auto difference = compare("(0.000005) vcan0 080#\n", "(0.000006) vcan0 080#\n");
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->time_us(), 5u);
}

TEST_F(LogDiff, ReportsThatALogEnds) {
  const auto difference = compare(log_of(3), log_of(5));
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->line, 4u);
  EXPECT_TRUE(difference->a.empty());
  EXPECT_EQ(difference->b.size(), 2u);
  EXPECT_EQ(difference->time_us(), 1003u);
}

TEST_F(LogDiff, RejectsAFileThatIsNoLog) {
  EXPECT_THROW(static_cast<void>(compare(log_of(1), "nonsense\n")), InputError);
}

}  // namespace
}  // namespace koboshi::tools
