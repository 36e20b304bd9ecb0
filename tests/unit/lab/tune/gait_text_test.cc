#include "lab/tune/gait_text.h"

#include <gtest/gtest.h>

#include "base/text/error.h"

namespace koboshi::lab {
namespace {

const std::string kText =
    "# period_s: 1 is slow\n"
    "points: 8\n"
    "period_s: 0.484  # of the cycle\n"
    "start_period_s: 3\n"
    "feedback: {ankle_pitch_s: 0.02, knee_s: -1e-3}\n"
    "hip:\n"
    "  width_m: 0.06\n";

TEST(GaitText, ReadsNumbersAtAnyPosition) {
  EXPECT_EQ(gait_number(kText, "points", "gait.yaml"), 8.0);
  EXPECT_EQ(gait_number(kText, "period_s", "gait.yaml"), 0.484);
  EXPECT_EQ(gait_number(kText, "feedback.ankle_pitch_s", "gait.yaml"), 0.02);
  EXPECT_EQ(gait_number(kText, "feedback.knee_s", "gait.yaml"), -1e-3);
  EXPECT_EQ(gait_number(kText, "hip.width_m", "gait.yaml"), 0.06);
}

TEST(GaitText, ReplacesNumbersOnly) {
  const std::string text = with_numbers(
      kText, {{"period_s", 0.5}, {"feedback.knee_s", 0.25}, {"hip.width_m", 0.0625}}, "gait.yaml");
  EXPECT_EQ(text,
            "# period_s: 1 is slow\n"
            "points: 8\n"
            "period_s: 0.5  # of the cycle\n"
            "start_period_s: 3\n"
            "feedback: {ankle_pitch_s: 0.02, knee_s: 0.25}\n"
            "hip:\n"
            "  width_m: 0.0625\n");
}

TEST(GaitText, RejectsMissingAndDuplicateKeys) {
  EXPECT_FALSE(has_number(kText, "step_length_m"));
  EXPECT_TRUE(has_number(kText, "points"));
  EXPECT_THROW(static_cast<void>(gait_number(kText, "step_length_m", "gait.yaml")), InputError);
  EXPECT_THROW(static_cast<void>(gait_number(kText, "feedback", "gait.yaml")), InputError);
  EXPECT_THROW(static_cast<void>(with_numbers(kText + "points: 4\n", {{"points", 16}}, "gait.yaml")),
               InputError);
}

}  // namespace
}  // namespace koboshi::lab
