#include <gtest/gtest.h>

#include "tests/studio/document/sample_document.h"

namespace koboshi::studio {
namespace {

using enum StepPlace::Kind;
using Rows = std::vector<std::size_t>;

TEST(CopyEdits, CopyAMotionOfTheStepsAndTheirPoses) {
  const auto document = document_of();
  EXPECT_EQ(document->copy_rows(Rows{2, 3}),
            "version: 2\nrobot: koboshi\nname: copied\nposes:\n"
            "  # feet together\n"
            "  stand: {others: zero, hip_pitch: -15.90, knee: 43.72, ankle_pitch: -27.82}\n"
            "  wave: {from: stand, right_elbow: -45}   # derived\n"
            "steps:\n  - loop:\n      times: 3\n      steps:\n        # out\n"
            "        - {pose: wave, speed_deg_per_s: 90, interpolation: minimum_jerk}\n"
            "        - {pose: stand, time_s: 0.3, pause_s: 0.1}\n");
  EXPECT_NE(document_of(document->copy_rows(Rows{2}))->compiled(), nullptr);
}

TEST(CopyEdits, PasteReusesPosesThatAreTheSame) {
  const auto document = document_of();
  EXPECT_EQ(document->paste({kAfter, 1}, document->copy_rows(Rows{4})), 2U);
  expect_edit(*document, with("  - loop:", "  - {pose: stand, time_s: 0.3, pause_s: 0.1}\n  - loop:"));
}

TEST(CopyEdits, PasteRenamesPosesWhoseNamesAreTaken) {
  const std::string other =
      "version: 2\nrobot: koboshi\nname: other\nposes:\n"
      "  stand: {head_pan: 4}\n  wave: {from: stand, right_elbow: -45}\n  new: {knee: 1}\n"
      "interpolation: cubic\nsteps:\n  - {pose: wave, time_s: 1}\n  - {pose: new, time_s: 1}\n";
  const auto document = document_of();
  const std::string copied = document_of(other)->copy_rows(Rows{0, 1});
  EXPECT_EQ(document->paste({kEndOf, 0}, copied), 10U);
  const std::string poses =
      "z_mm: 140}}\n  stand_2: {head_pan: 4}\n  wave_2: {from: stand_2, right_elbow: -45}\n  new: {knee: "
      "1}\n";
  expect_edit(*document, with("z_mm: 140}}\n", poses) +
                             "  - {pose: wave_2, time_s: 1, interpolation: cubic}\n"
                             "  - {pose: new, time_s: 1, interpolation: cubic}\n");
  // The second time, all poses are there.
  const std::string once = document->text();
  document->paste({kEndOf, 0}, copied);
  EXPECT_EQ(document->text(), once +
                                  "  - {pose: wave_2, time_s: 1, interpolation: cubic}\n"
                                  "  - {pose: new, time_s: 1, interpolation: cubic}\n");
}

TEST(CopyEdits, PasteRefusesOtherTextsAndOtherRobots) {
  const auto document = document_of();
  const std::string copied = document->copy_rows(Rows{0});
  const auto message = [&](const std::string& text) -> std::string {
    try {
      document->paste({kEndOf, 0}, text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(with("robot: koboshi", "robot: other", copied)),
            "copied steps:2: found the robot 'other', expected steps of a motion for koboshi");
  EXPECT_EQ(message("name: hello\n"), "copied steps: found another text, expected steps of a motion");
  EXPECT_NE(message("just words"), "");
  EXPECT_NE(message(""), "");
  EXPECT_EQ(document->text(), kSample);
  const auto version_1 = document_of("version: 1\nrobot: koboshi\nname: a\nsteps:\n  - {wait_s: 1}\n");
  EXPECT_THROW(static_cast<void>(version_1->paste({kEndOf, 0}, copied)), InputError);
}

TEST(MirrorEdits, MirrorRowsWithNewPosesWhereNeeded) {
  const auto document = document_of();
  document->mirror_rows(Rows{0, 2});
  expect_edit(*document, with("{pose: wave, ", "{pose: wave_mirrored, ",
                              with("z_mm: 140}}\n", "z_mm: 140}}\n  wave_mirrored: {mirror: wave}\n")));
  EXPECT_NEAR(document->rows().rows[3].angles_rad[joint_of("left_elbow")], -45 * kDegree, 1e-6);
  // Back, by the pose that is there.
  document->mirror_rows(Rows{3});
  EXPECT_EQ(document->text(), with("z_mm: 140}}\n", "z_mm: 140}}\n  wave_mirrored: {mirror: wave}\n"));
}

TEST(MirrorEdits, MirrorAMotionOfVersion1) {
  const std::string text =
      "version: 1\nrobot: koboshi\nname: a\nposes:\n  # up\n  left_up: {left_shoulder_pitch: -90, head_pan: "
      "5}   # a\n"
      "steps:\n  - {pose: left_up, time_s: 1}\n  - {expect: {roll_deg: 5, within_deg: 20}}\n";
  const auto document = document_of(text);
  document->mirror_rows(Rows{0, 1});
  expect_edit(
      *document,
      with("{pose: left_up, ", "{pose: right_up, ",
           with("roll_deg: 5", "roll_deg: -5",
                with("# a\n", "# a\n  right_up: {right_shoulder_pitch: -90, head_pan: -5}   # a\n", text))),
      text);
}

TEST(MirrorEdits, MirrorTheWholeMotionTwice) {
  const auto document = document_of();
  document->mirror_motion();
  EXPECT_NE(document->text().find("left_elbow: -45}   # derived"), std::string::npos);
  EXPECT_NE(document->text().find("-roll_mdeg > 4000"), std::string::npos);
  document->undo();
  EXPECT_EQ(document->text(), kSample);
}

}  // namespace
}  // namespace koboshi::studio
