#include "simulation/gait/gait.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text/error.h"
#include "base/text/text.h"
#include "simulation/gait/gait_keys.h"
#include "tests/unit/base/scratch_file.h"

namespace koboshi::simulation {
namespace {

using testing::HasSubstr;

Gait read(const std::string& text, std::span<const Override> overrides = {}) {
  return read_gait(ScratchFile("gait.yaml", text).path(), overrides);
}

constexpr const char* kGood =
    "version: 1\nrobot: koboshi\nperiod_s: 0.6\nstep_length_m: 0.04\nstep_width_m: 0.064\n"
    "step_height_m: 0.015\ncom_height_m: 0.175\ndouble_support: 0.2\n";

std::string refusal(const std::string& text, std::span<const Override> overrides = {}) {
  try {
    read(text, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Gait, ReadsTheFileAndFillsInDefaults) {
  const Gait gait = read(std::string(kGood) + "feedback: {hip_roll_s: 0.03}\n");
  EXPECT_DOUBLE_EQ(gait.period_s, 0.6);
  EXPECT_EQ(gait.points, 8);
  EXPECT_DOUBLE_EQ(gait.feedback.hip_roll_s, 0.03);
  EXPECT_DOUBLE_EQ(gait.feedback.knee_s, 0.0);
}

TEST(Gait, AppliesOverrides) {
  const Override points[] = {{"points", "16"}, {"feedback.knee_s", "0.01"}};
  const Gait gait = read(kGood, points);
  EXPECT_EQ(gait.points, 16);
  EXPECT_DOUBLE_EQ(gait.feedback.knee_s, 0.01);
}

TEST(Gait, NamesTheLineOfAnError) {
  EXPECT_THAT(refusal(std::string(kGood) + "hop: 3\n"), HasSubstr(":9:"));
  EXPECT_THAT(refusal("version: 2\n"), HasSubstr(":1:"));
  EXPECT_THAT(refusal("version: 1\nrobot: koboshi\nperiod_s: 0\n"), HasSubstr(":3:"));
  EXPECT_THAT(refusal(std::string(kGood) + "points: 1\n"), HasSubstr("points"));
}

TEST(Gait, RejectsOldKeysWithTheirNewName) {
  EXPECT_THAT(refusal(std::string(kGood) + "swing_ease: 0.5\n"),
              HasSubstr(":9: found key swing_ease, which has another name now, expected swing_profile"));
  EXPECT_THAT(refusal(std::string(kGood) + "zmp_ahead_m: 0.005\n"),
              HasSubstr(":9: found key zmp_ahead_m, which has another name now, expected zmp_forward_m"));
}

// The page repeats the table of the reader.
TEST(Gait, HasTheUnitsRangesAndMeaningsOfItsPage) {
  const std::string page = read_text_file(KOBOSHI_SOURCE_DIR "/docs/reference/gait-format.md", "the page");
  for (const GaitKey& key : gait_keys()) {
    const std::string unit(key.unit == "deg" ? "degrees" : key.unit);
    const std::string row =
        fmt::format("| `{}` | {}{:g} to {:g}{} | {} |\n", key.key, unit.empty() ? unit : unit + ", ", key.min,
                    key.max, key.fallback ? fmt::format(", default {:g}", *key.fallback) : "", key.meaning);
    EXPECT_THAT(page, HasSubstr(row));
  }
}

TEST(Gait, RejectsMissingKeysWithoutDefault) {
  EXPECT_THAT(refusal("version: 1\nrobot: koboshi\n"), HasSubstr("period_s"));
}

}  // namespace
}  // namespace koboshi::simulation
