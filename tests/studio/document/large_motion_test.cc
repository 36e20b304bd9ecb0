#include <gtest/gtest.h>

#include <numeric>

#include "tests/studio/document/sample_document.h"

namespace koboshi::studio {
namespace {

constexpr std::size_t kPoses = 500;
constexpr std::size_t kSteps = 1000;

std::string large_text() {
  std::string text = "version: 2\nrobot: koboshi\nname: large\nposes:\n";
  for (std::size_t i = 0; i < kPoses; ++i) {
    text += "  p" + std::to_string(i) + ": {left_shoulder_pitch: " + std::to_string(i % 90) +
            ", head_tilt: 0." + std::to_string(100 + i) + "}\n";
  }
  text += "steps:\n";
  for (std::size_t i = 0; i < kSteps; ++i)
    text += "  - {pose: p" + std::to_string(i % kPoses) + ", time_s: 1.5}   # " + std::to_string(i) + "\n";
  return text;
}

// Edits of many rows parse the file a few times, not once for each row: those would take minutes.
TEST(LargeMotion, TakesEditsOfManyRows) {
  const std::string text = large_text();
  const auto document = document_of(text);
  ASSERT_NE(document->compiled(), nullptr) << print(document->diagnostics());
  std::vector<std::size_t> all(kSteps);
  std::iota(all.begin(), all.end(), 0U);
  std::vector<std::size_t> every_other;
  for (std::size_t i = 0; i < kSteps; i += 2) every_other.push_back(i);

  document->scale_time(all, 2);
  EXPECT_NEAR(document->rows().sections[0].duration_s, 3000, 1e-6);
  document->mirror_rows(std::vector<std::size_t>(all.begin(), all.begin() + 6));
  const auto& rows = document->rows().rows;
  EXPECT_NEAR(rows[5].angles_rad[joint_of("right_shoulder_pitch")], 5 * kDegree, 1e-6);
  EXPECT_EQ(rows[5].pose, "p5_mirrored");
  document->reverse_rows(all);
  EXPECT_EQ(document->rows().rows.back().pose, "p0_mirrored");
  document->erase_rows(every_other);
  EXPECT_EQ(document->rows().rows.size(), kSteps / 2);
  const std::string copied = document->copy_rows(std::vector<std::size_t>(all.begin(), all.begin() + 300));
  EXPECT_EQ(document->paste({StepPlace::Kind::kEndOf, 0}, copied), kSteps / 2);
  EXPECT_EQ(document->rows().rows.size(), kSteps / 2 + 300);
  ASSERT_NE(document->compiled(), nullptr) << print(document->diagnostics());
  while (document->undo()) {
  }
  EXPECT_EQ(document->text(), text);
}

}  // namespace
}  // namespace koboshi::studio
