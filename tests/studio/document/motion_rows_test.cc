#include "studio/document/motion_rows.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/studio/document/sample_document.h"

namespace koboshi::studio {
namespace {

using Kind = simulation::StepSource::Kind;

TEST(MotionRows, FlattensProgramAndRoutines) {
  const auto document = document_of();
  ASSERT_TRUE(document->diagnostics().empty()) << print(document->diagnostics());
  ASSERT_NE(document->compiled(), nullptr);
  const auto& [sections, rows] = document->rows();
  ASSERT_EQ(sections.size(), 2U);
  EXPECT_EQ(sections[0].name, "");
  EXPECT_EQ(sections[1].name, "nod");
  EXPECT_EQ(sections[1].first_row, 10U);
  EXPECT_EQ(sections[1].row_count, 2U);
  ASSERT_EQ(rows.size(), 12U);
  const std::vector<std::string> paths{"steps.0",
                                       "steps.1",
                                       "steps.2",
                                       "steps.2.loop.steps.0",
                                       "steps.2.loop.steps.1",
                                       "steps.3",
                                       "steps.3.then.0",
                                       "steps.3.else.0",
                                       "steps.4",
                                       "steps.5",
                                       "routines.nod.0",
                                       "routines.nod.1"};
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i].path.text(), paths[i]);
  EXPECT_EQ(rows[3].depth, 1);
  EXPECT_EQ(rows[3].parent, 2U);
  EXPECT_EQ(rows[4].list_index, 1U);
  EXPECT_TRUE(rows[7].in_else);
  EXPECT_EQ(rows[0].line, 16);
  EXPECT_EQ(rows[2].text, "loop 3 times");
  EXPECT_EQ(rows[2].times, 3);
  EXPECT_EQ(rows[5].text, "if roll_mdeg > 4000");
  EXPECT_EQ(rows[1].text, "wait_s: 0.5");
  EXPECT_EQ(rows[8].target, 9U);
  EXPECT_EQ(rows[7].target, 10U);
  EXPECT_EQ(rows[0].pose_uses, 4U);  // two steps, two derived poses
  EXPECT_EQ(rows[10].pose, "");
}

TEST(MotionRows, GivesTimesAndAnglesOfTheNominalPath) {
  const auto document = document_of();
  const auto& rows = document->rows().rows;
  const std::size_t elbow = joint_of("right_elbow");
  // 45 degrees by minimum jerk at a peak of 90 degrees/s.
  constexpr double kWave_s = 45.0 / 90.0 * 15.0 / 8.0;
  EXPECT_NEAR(rows[0].start_s, 0.0, 1e-9);
  EXPECT_NEAR(rows[1].start_s, 1.5, 1e-9);
  EXPECT_NEAR(rows[3].start_s, 2.0, 1e-9);
  EXPECT_NEAR(rows[3].duration_s, kWave_s, 1e-4);
  EXPECT_NEAR(rows[4].start_s, 2.0 + kWave_s, 1e-4);
  EXPECT_NEAR(rows[4].duration_s, 0.4, 1e-9);
  EXPECT_NEAR(rows[2].duration_s, 3 * (kWave_s + 0.4), 1e-3);
  EXPECT_NEAR(rows[6].start_s, rows[7].start_s, 1e-9);
  EXPECT_NEAR(rows[7].duration_s, 0.75, 1e-9);  // the routine's
  EXPECT_NEAR(document->rows().sections[0].duration_s, 2.0 + 3 * (kWave_s + 0.4) + 1.0, 1e-3);
  EXPECT_NEAR(rows[3].angles_rad[elbow], -45 * kDegree, 1e-6);
  EXPECT_NEAR(rows[4].angles_rad[elbow], 0.0, 1e-6);
  EXPECT_NEAR(rows[0].angles_rad[joint_of("left_knee")], 43.72 * kDegree, 1e-6);
  EXPECT_NEAR(rows[11].angles_rad[joint_of("left_knee")], sample_robot()->standing_rad[joint_of("left_knee")],
              1e-9);
  EXPECT_EQ(rows[10].moved, 1U << joint_of("head_tilt"));
  EXPECT_NEAR(rows[4].pause_s, 0.1, 1e-9);
  EXPECT_EQ(rows[3].interpolation, motion::Interpolation::kMinimumJerk);
  EXPECT_NEAR(rows[3].speed_deg_per_s.value_or(0), 90, 1e-4);
}

TEST(MotionRows, DescribesTheStepsOfATextWithErrors) {
  // A mistake in a loop: the compiler leaves out the whole loop.
  std::string text = with("pause_s: 0.1}", "puase_s: 0.1}", with("{wait_s: 0.5}", "{wiat_s: 0.5}"));
  const auto document = document_of(text);
  EXPECT_EQ(document->compiled(), nullptr);
  const auto& rows = document->rows().rows;
  ASSERT_EQ(rows.size(), 12U);
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i].has_error, i == 1 || i == 4) << i;
  EXPECT_EQ(rows[1].text, "wiat_s: 0.5");
  EXPECT_EQ(rows[2].kind, Kind::kLoop);
  EXPECT_EQ(rows[2].times, 3);
  EXPECT_EQ(rows[3].kind, Kind::kMove);
  EXPECT_EQ(rows[3].pose, "wave");
  EXPECT_EQ(rows[3].interpolation, motion::Interpolation::kMinimumJerk);
  EXPECT_NEAR(rows[3].angles_rad[joint_of("right_elbow")], -45 * kDegree, 1e-6);
  EXPECT_NEAR(rows[3].duration_s, 45.0 / 90.0 * 15.0 / 8.0, 1e-4);
  EXPECT_EQ(rows[4].time_s, 0.3);
  EXPECT_EQ(rows[8].target, 9U);
  document->set_time(std::vector<std::size_t>{4}, 0.5);
  EXPECT_EQ(document->text(), with("time_s: 0.3, p", "time_s: 0.5, p", text));
}

TEST(MotionRows, MarksTheRowsOfTheCompilersMessages) {
  const auto document = document_of(with("{jump: done}", "{jump: nowhere}"));
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(document->rows().rows[i].has_error, i == 8) << i;
}

TEST(MotionRows, AreFoundByPathAndLine) {
  const auto document = document_of();
  const MotionRows& rows = document->rows();
  EXPECT_EQ(rows.find("steps.2.loop.steps.1"), 4U);
  EXPECT_EQ(rows.find("steps.9"), std::nullopt);
  for (std::size_t i = 0; i < rows.rows.size(); ++i) EXPECT_EQ(rows.find_line(rows.rows[i].line), i);
  EXPECT_EQ(rows.find_line(rows.rows[2].line + 1), 2U);  // "times: 3"
  EXPECT_EQ(rows.find_line(rows.rows[11].line), 11U);
  EXPECT_EQ(rows.find_line(1), std::nullopt);
  EXPECT_EQ(rows.find_line(7), std::nullopt);  // a pose
  EXPECT_EQ(rows.find_line(rows.sections[0].line), std::nullopt);
}

TEST(MotionRows, OfAFileWithoutStepsHaveAMainProgram) {
  const auto document = document_of("version: 2\nrobot: koboshi\nname: a\n");
  ASSERT_EQ(document->rows().sections.size(), 1U);
  EXPECT_EQ(document->insert_step({StepPlace::Kind::kEndOf, 0}, "{wait_s: 1}"), 0U);
  EXPECT_EQ(document->text(), "version: 2\nrobot: koboshi\nname: a\nsteps:\n  - {wait_s: 1}\n");
}

TEST(MotionRows, OfShippedMotionsEndWithTheProgram) {
  for (const auto& entry :
       std::filesystem::directory_iterator(KOBOSHI_SOURCE_DIR "/robots/koboshi/motions")) {
    const MotionDocument document(sample_robot(), entry.path());
    ASSERT_NE(document.compiled(), nullptr) << entry.path();
    EXPECT_FALSE(document.rows().rows.empty());
    for (const MotionRow& row : document.rows().rows) {
      EXPECT_FALSE(row.has_error) << row.text;
      EXPECT_LE(row.start_s + row.duration_s, document.rows().sections[row.section].duration_s + 1e-9);
    }
  }
}

}  // namespace
}  // namespace koboshi::studio
