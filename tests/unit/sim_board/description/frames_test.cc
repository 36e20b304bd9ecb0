// Frames of a robot's file: their meaning, the older keys for them, and what is refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "sim_board/description/load.h"
#include "sim_board/description/model_frames.h"
#include "tests/unit/sim_board/description/small_robot.h"

namespace koboshi::sim_board {
namespace {

using testing::HasSubstr;

RobotDescription loaded(const std::string& text) { return load_robot("robot.sdf", text); }

// kSmallRobot in this version of SDF, with `to` in the place of `from`.
std::string in_version(const std::string& version, const std::string& from, const std::string& to) {
  return replaced(with(from, to), "version=\"1.9\"", "version=\"" + version + "\"");
}

std::string with_frames(const std::string& frames) { return with("</model>", frames + "</model>"); }

TEST(FramePose, ComposesAndInverts) {
  const FramePose X_AB = FramePose::from_numbers({1, 2, 3, 0.1, -0.7, 2.5});
  const FramePose X_BC = FramePose::from_numbers({-0.3, 0.2, 0.9, 3.1, 0.4, -1.2});
  const Eigen::Isometry3d X_AC = X_AB.isometry() * X_BC.isometry();
  EXPECT_TRUE((X_AB * X_BC).isometry().isApprox(X_AC, 1e-14));
  EXPECT_TRUE((X_AB.inverse() * X_AB).isometry().isApprox(Eigen::Isometry3d::Identity(), 1e-14));
  EXPECT_TRUE(X_AB.rotation.matrix().isApprox(X_AB.isometry().linear(), 1e-14));
}

TEST(FramePose, RotatesAboutFixedAxesRollFirst) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  const Eigen::Matrix3d R = (AngleAxisd(0.3, Vector3d::UnitZ()) * AngleAxisd(0.2, Vector3d::UnitY()) *
                             AngleAxisd(0.1, Vector3d::UnitX()))
                                .toRotationMatrix();
  const FrameRotation rotation = FrameRotation::from_angles(0.1, 0.2, 0.3);
  EXPECT_TRUE(rotation.matrix().isApprox(R, 1e-14));
  EXPECT_TRUE(rotation.rotate({1, 2, 3}).isApprox(R * Vector3d(1, 2, 3), 1e-14));
  const Eigen::Matrix3d inertia = Vector3d(1, 2, 2.5).asDiagonal();
  EXPECT_TRUE(rotated_inertia(rotation, inertia).isApprox(R * inertia * R.transpose(), 1e-14));
}

TEST(Frames, MayBeNested) {
  const std::string text = replaced(
      with_frames("<frame name='a' attached_to='base'><pose>0 0 0.1 0 0 1.5707963267948966</pose></frame>"
                  "<frame name='b'><pose relative_to='a'>0.2 0 0 0 0 0</pose></frame>"),
      "relative_to=\"base\">0 0 0.1 0 0 1.5707963267948966", "relative_to=\"b\">0.3 0 0 0 0 0");
  const Eigen::Isometry3d X_ML = loaded(text).links.at(1).X_ML;
  EXPECT_TRUE(X_ML.translation().isApprox(Eigen::Vector3d(1, 2.5, 3.1)));
  EXPECT_TRUE((X_ML.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
}

TEST(Frames, StandForTheLinkToWhichTheyAreAttached) {
  const std::string frames =
      "<frame name='on_hand' attached_to='tip'/><frame name='tip' attached_to='hand'>"
      "<pose>0 0 0.1 0 0 0</pose></frame><frame name='on_base' attached_to='base'/>";
  std::string text = replaced(with_frames(frames), "<child>hand", "<child>on_hand");
  text = replaced(text, "<parent>base", "<parent>on_base");
  const JointDescription wrist = loaded(text).joints.at(0);
  EXPECT_EQ(wrist.parent, 0);
  EXPECT_EQ(wrist.child, 1);
  EXPECT_TRUE(wrist.p_MJ.isApprox(Eigen::Vector3d(1, 2, 3.2)));  // the joint is where its child frame is
}

TEST(Frames, WithoutAttachmentBelongToTheCanonicalLink) {
  const std::string text = replaced(with_frames("<frame name='origin'/>"), "<parent>base", "<parent>origin");
  // The first link of the file, the hand, would be its own parent.
  EXPECT_THAT(complaint(text), HasSubstr("found link hand in a ring of joints"));
  EXPECT_EQ(
      loaded(replaced(text, "name=\"arm\"", "name=\"arm\" canonical_link=\"base\"")).joints.at(0).parent, 0);
}

TEST(Frames, OfTheModelItselfHaveNoEffectOnItsParts) {
  const std::string text = replaced(with_frames("<pose>1 2 3 0.1 0.2 0.3</pose>"), "name=\"arm\"",
                                    "name=\"arm\" placement_frame=\"hand\"");
  EXPECT_EQ(loaded(text).links.at(1).X_ML.matrix(), loaded(kSmallRobot).links.at(1).X_ML.matrix());
}

TEST(Frames, HaveOtherKeysInOlderVersions) {
  const Eigen::Matrix4d X_ML = loaded(kSmallRobot).links.at(1).X_ML.matrix();
  for (const std::string version : {"1.5", "1.6"}) {
    EXPECT_EQ(loaded(in_version(version, "relative_to=\"base\"", "frame=\"base\"")).links.at(1).X_ML.matrix(),
              X_ML);
    const auto axis = [&](const std::string& value) {
      const std::string key = "<use_parent_model_frame>" + value + "</use_parent_model_frame></axis>";
      return loaded(in_version(version, "</axis>", key)).joints.at(0).axis_M;
    };
    for (const std::string value : {"1", "true", "True", "TRUE"})
      EXPECT_TRUE(axis(value).isApprox(Eigen::Vector3d::UnitX())) << value;
    for (const std::string value : {"0", "false", "False", "FALSE"})
      EXPECT_TRUE(axis(value).isApprox(Eigen::Vector3d::UnitY())) << value;
  }
}

TEST(Frames, OfOlderVersionsAreRefusedInLaterOnes) {
  for (const std::string version : {"1.7", "1.8", "1.9"}) {
    EXPECT_EQ(complaint(in_version(version, "relative_to=\"base\"", "frame=\"base\"")),
              "FILE:13: found frame of <pose> in SDF " + version + ", expected relative_to of <pose>");
    EXPECT_EQ(
        complaint(
            in_version(version, "</axis>", "<use_parent_model_frame>0</use_parent_model_frame></axis>")),
        "FILE:44: found <use_parent_model_frame> in SDF " + version + ", expected expressed_in of <xyz>");
  }
  EXPECT_EQ(complaint(in_version("1.6", "relative_to=\"base\"", "relative_to=\"base\" frame=\"base\"")),
            "FILE:13: found frame of <pose> beside relative_to of <pose>, expected one of the two");
}

TEST(Frames, MustBeThere) {
  EXPECT_EQ(complaint(in_version("1.6", "relative_to=\"base\"", "frame=\"moon\"")),
            "FILE:13: found frame = moon, expected the name of a link or joint");
  const std::string text = with_frames("<frame name='tip'/>");
  EXPECT_EQ(complaint(replaced(text, "relative_to=\"base\"", "relative_to=\"moon\"")),
            "FILE:13: found relative_to = moon, expected the name of a link, joint or frame");
  EXPECT_EQ(complaint(replaced(text, "<child>hand", "<child>wrist")),
            "FILE:40: found <child> = wrist, expected the name of a link or frame");
  EXPECT_EQ(complaint(with_frames("<frame name='tip' attached_to='moon'/>")),
            "FILE:49: found attached_to = moon, expected the name of a link, joint or frame");
  EXPECT_EQ(complaint(with("name=\"arm\"", "name=\"arm\" canonical_link=\"wrist\"")),
            "FILE:2: found canonical_link = wrist, expected the name of a link");
  EXPECT_EQ(complaint(with("name=\"arm\"", "name=\"arm\" placement_frame=\"moon\"")),
            "FILE:2: found placement_frame = moon, expected the name of a link or joint");
}

TEST(Frames, ShareTheNamesOfLinksAndJoints) {
  for (const std::string name : {"hand", "wrist"})
    EXPECT_EQ(complaint(with_frames("<frame name='" + name + "'/>")),
              "FILE:49: found a second " + name + ", expected each name once");
  for (const std::string name : {"world", "__model__", "____"})
    EXPECT_EQ(complaint(with_frames("<frame name='" + name + "'/>")),
              "FILE:49: found name = " + name +
                  ", expected a name other than world and __...__, which SDF reserves");
}

TEST(Frames, MayNotFormARing) {
  EXPECT_EQ(complaint(with("relative_to=\"base\"", "relative_to=\"hand\"")),
            "FILE:13: found a ring of poses: hand, hand, expected poses that lead to the model's frame");
  EXPECT_EQ(
      complaint(with("relative_to=\"base\"", "relative_to=\"wrist\"")),
      "FILE:13: found a ring of poses: hand, wrist, hand, expected poses that lead to the model's frame");
  EXPECT_EQ(complaint(with_frames("<frame name='a' attached_to='b'/><frame name='b' attached_to='a'>"
                                  "<pose relative_to='hand'/></frame>")),
            "FILE:49: found <pose> = , expected 6 times a number from -1000 to 1000");
  EXPECT_EQ(complaint(with_frames("<frame name='a' attached_to='b'/><frame name='b' attached_to='a'>"
                                  "<pose relative_to='hand'>0 0 0 0 0 0</pose></frame>")),
            "FILE:49: found a ring of attached frames: a, b, a, expected frames that lead to a link");
  EXPECT_EQ(
      complaint(replaced(with_frames("<frame name='a' attached_to='wrist'/>"), "<child>hand", "<child>a")),
      "FILE:38: found a ring of poses: wrist, a, wrist, expected poses that lead to the model's frame");
}

}  // namespace
}  // namespace koboshi::sim_board
