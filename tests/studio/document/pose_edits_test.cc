#include <gtest/gtest.h>

#include "tests/studio/document/sample_document.h"

namespace koboshi::studio {
namespace {

JointAngle angle(const std::string& joint, double angle_deg) {
  return {joint_of(joint), angle_deg * kDegree};
}

void set_angle(MotionDocument& document, std::size_t row, const std::string& joint, double angle_deg,
               PoseScope scope = PoseScope::kAllSteps) {
  const JointAngle angles[]{angle(joint, angle_deg)};
  document.set_angles(row, angles, scope);
}

TEST(PoseEdits, ChangeAPoseForAllSteps) {
  const auto document = document_of();
  set_angle(*document, 3, "right_elbow", -50.004);
  expect_edit(*document, with("right_elbow: -45}", "right_elbow: -50}"));
  EXPECT_EQ(document->history().undo_label(), "Move right_elbow");
  EXPECT_NEAR(document->rows().rows[3].angles_rad[joint_of("right_elbow")], -50 * kDegree, 1e-6);
}

TEST(PoseEdits, AddAJointThatThePoseLacks) {
  const auto document = document_of();
  set_angle(*document, 3, "head_pan", 12.345);
  expect_edit(*document, with("right_elbow: -45}", "right_elbow: -45, head_pan: 12.35}"));
}

TEST(PoseEdits, ChangeThePoseOfTheStepItself) {
  const auto document = document_of();
  set_angle(*document, 10, "head_tilt", 15);
  expect_edit(*document, with("{head_tilt: 20}", "{head_tilt: 15}"));
}

TEST(PoseEdits, SplitANameWithoutItsSide) {
  const auto document = document_of();
  set_angle(*document, 0, "right_knee", 50);
  const std::string split =
      with("knee: 43.72, ankle_pitch: -27.82}", "left_knee: 43.72, ankle_pitch: -27.82, right_knee: 50}");
  expect_edit(*document, split);
  // Both sides alike need no split.
  const auto both = document_of();
  const JointAngle angles[]{angle("left_knee", 50), angle("right_knee", 50)};
  both->set_angles(0, angles, PoseScope::kAllSteps);
  expect_edit(*both, with("knee: 43.72", "knee: 50"));
  EXPECT_EQ(both->history().undo_label(), "Move joints");
}

TEST(PoseEdits, GiveTheStepACopyOfItsOwn) {
  const auto document = document_of();
  set_angle(*document, 4, "head_pan", 5, PoseScope::kThisStep);
  const std::string own =
      "  stand_2: {others: zero, hip_pitch: -15.90, knee: 43.72, ankle_pitch: -27.82, "
      "head_pan: 5}\n";
  expect_edit(*document, with("{pose: stand, time_s: 0.3,", "{pose: stand_2, time_s: 0.3,",
                              with("  wave: {from", own + "  wave: {from")));
  set_angle(*document, 4, "head_pan", 6, PoseScope::kThisStep);  // its own already
  EXPECT_NE(document->text().find("head_pan: 6}"), std::string::npos);
  EXPECT_EQ(document->text().find("stand_3"), std::string::npos);
}

TEST(PoseEdits, LeaveTheTextWhereTheAngleIsReachedAlready) {
  const auto document = document_of();
  set_angle(*document, 0, "left_knee", 43.721);
  set_angle(*document, 4, "left_knee", 43.72, PoseScope::kThisStep);
  EXPECT_EQ(document->text(), kSample);
  EXPECT_EQ(document->history().undo_count(), 0U);
}

TEST(PoseEdits, ReplaceTargetsThatDetermineTheJoint) {
  const std::string mirrored = with(
      "{pose: low, ", "{pose: low, mirror: true, ",
      with("com: {x_mm: 12, z_mm: 140}", "support: left, com: {x_mm: 12, z_mm: 140}, right_foot: {z_mm: 8}"));
  for (const std::string& text : {kSample, mirrored}) {
    const auto document = document_of(text);
    const auto before = document->rows().rows[6].angles_rad;
    set_angle(*document, 6, "left_knee", 60);
    EXPECT_EQ(document->text().find("com:"), std::string::npos);
    ASSERT_NE(document->compiled(), nullptr) << print(document->diagnostics());
    const auto& after = document->rows().rows[6].angles_rad;
    for (std::size_t joint = 0; joint < before.size(); ++joint)
      EXPECT_NEAR(after[joint], joint == joint_of("left_knee") ? 60 * kDegree : before[joint],
                  0.006 * kDegree);
    document->undo();
    EXPECT_EQ(document->text(), text);
  }
}

TEST(PoseEdits, MoveTheOtherJointOfAMirroredStep) {
  const auto document = document_of(with("{pose: wave, ", "{pose: wave, mirror: true, "));
  set_angle(*document, 3, "left_elbow", -60);
  EXPECT_EQ(document->text(), with("{pose: wave, ", "{pose: wave, mirror: true, ",
                                   with("right_elbow: -45}", "right_elbow: -60}")));
  EXPECT_NEAR(document->rows().rows[3].angles_rad[joint_of("left_elbow")], -60 * kDegree, 1e-6);
}

TEST(PoseEdits, MergeWhileAJointIsDragged) {
  const auto document = document_of();
  for (int i = 1; i <= 20; ++i) {
    const JointAngle angles[]{angle("left_elbow", -i)};
    document->set_angles(4, angles, PoseScope::kThisStep, "left_elbow of row 4");
  }
  EXPECT_EQ(document->history().undo_count(), 1U);
  document->end_drag();
  const JointAngle angles[]{angle("left_elbow", -30)};
  document->set_angles(4, angles, PoseScope::kThisStep, "left_elbow of row 4");
  EXPECT_EQ(document->history().undo_count(), 2U);
  document->undo();
  document->undo();
  EXPECT_EQ(document->text(), kSample);
}

TEST(PoseEdits, RefuseWhatDoesNotFitAndChangeNothing) {
  const auto document = document_of();
  EXPECT_THROW(set_angle(*document, 0, "left_knee", 400), InputError);
  EXPECT_THROW(set_angle(*document, 0, "no_joint", 1), InputError);
  EXPECT_THROW(set_angle(*document, 1, "left_knee", 1), InputError);  // a wait
  EXPECT_THROW(set_angle(*document, 99, "left_knee", 1), InputError);
  EXPECT_THROW(document->rename_pose("none", "a"), InputError);
  EXPECT_THROW(document->rename_pose("stand", "wave"), InputError);
  EXPECT_THROW(document->rename_pose("stand", ""), InputError);
  EXPECT_EQ(document->text(), kSample);
  EXPECT_FALSE(document->history().can_undo());
}

TEST(PoseEdits, RefuseJointsThatTheMotionMayNotMove) {
  const std::string text =
      "version: 2\nrobot: koboshi\nname: a\njoints: [head]\nposes:\n  a: {head_pan: 5}\n"
      "steps:\n  - {pose: a, time_s: 1}\n";
  const auto document = document_of(text);
  EXPECT_THROW(set_angle(*document, 0, "left_knee", 5), InputError);
  EXPECT_EQ(document->text(), text);
  // All joints of a robot that stands with its head turned.
  std::vector<JointAngle> angles;
  for (std::size_t joint = 0; joint < sample_robot()->standing_rad.size(); ++joint)
    angles.push_back({joint, sample_robot()->standing_rad[joint]});
  angles[joint_of("head_pan")].angle_rad = 10 * kDegree;
  document->set_angles(0, angles, PoseScope::kAllSteps);
  expect_edit(*document, with("{head_pan: 5}", "{head_pan: 10, head_tilt: 0}", text), text);
}

TEST(PoseEdits, RenameAPoseEverywhere) {
  const auto document = document_of();
  document->rename_pose("stand", "upright pose");
  const std::string name = "\"upright pose\"";
  std::string expected = with("  stand: {", "  " + name + ": {");
  expected = with("wave: {from: stand", "wave: {from: " + name, expected);
  expected = with("low: {from: stand", "low: {from: " + name, expected);
  expected = with("{pose: stand, time_s: 1.5}", "{pose: " + name + ", time_s: 1.5}", expected);
  expected = with("{pose: stand, time_s: 0.3,", "{pose: " + name + ", time_s: 0.3,", expected);
  expect_edit(*document, expected);
  EXPECT_NE(document->compiled(), nullptr);
}

TEST(PoseEdits, InsertACapturedPose) {
  const auto document = document_of();
  std::vector<double> angles(sample_robot()->model.joint_names.size(), 0.0);
  angles[joint_of("left_knee")] = angles[joint_of("right_knee")] = 30 * kDegree;
  angles[joint_of("left_elbow")] = -20 * kDegree;
  const std::size_t row = document->insert_pose({StepPlace::Kind::kAfter, 0}, angles, 0.8, "wave");
  EXPECT_EQ(row, 1U);
  expect_edit(*document, with("  - {wait_s: 0.5}", "  - {pose: wave_2, time_s: 0.8}\n  - {wait_s: 0.5}",
                              with("z_mm: 140}}\n",
                                   "z_mm: 140}}\n  wave_2: {others: zero, knee: 30, left_elbow: -20}\n")));
  const auto& reached = document->rows().rows[1].angles_rad;
  for (std::size_t joint = 0; joint < angles.size(); ++joint)
    EXPECT_NEAR(reached[joint], angles[joint], 1e-6);
}

// The mirror image of the left arm's angle is beyond the left arm's own limits.
TEST(PoseEdits, InsertsAPoseWithOneArmRaised) {
  const auto document = document_of();
  std::vector<double> angles(sample_robot()->model.joint_names.size(), 0.0);
  angles[joint_of("left_shoulder_roll")] = 120 * kDegree;
  angles[joint_of("right_shoulder_roll")] = -120 * kDegree;
  document->insert_pose({StepPlace::Kind::kAfter, 0}, angles, 0.8, "arms_up");
  EXPECT_NE(document->text().find("arms_up: {others: zero, shoulder_roll: 120}"), std::string::npos);
  angles[joint_of("right_shoulder_roll")] = -8 * kDegree;
  document->insert_pose({StepPlace::Kind::kAfter, 0}, angles, 0.8, "arm_up");
  EXPECT_NE(document->text().find("arm_up: {others: zero, left_shoulder_roll: 120, right_shoulder_roll: -8}"),
            std::string::npos);
}

}  // namespace
}  // namespace koboshi::studio
