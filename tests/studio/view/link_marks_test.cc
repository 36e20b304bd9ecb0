#include "studio/view/link_layers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "sim_board/description/load.h"
#include "tools/motion_view/placement.h"
#include "view/capture/scene.h"

namespace koboshi::studio {
namespace {

struct Standing {
  sim_board::RobotDescription robot = sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  view::Scene scene = view::make_scene(robot, sim_board::GroundDescription());

  std::vector<view::Pose> links(const std::string& bent = {}, double angle_rad = 0.0) const {
    std::vector<double> angles_rad(robot.joints.size(), 0.0);
    if (!bent.empty()) angles_rad[static_cast<std::size_t>(*robot.find_joint(bent))] = angle_rad;
    tools::Placement placement(robot);
    placement.place(angles_rad);
    return placement.links();
  }
};

// The axis must stay where it is relative to both links when its joint turns.
TEST(JointAxes, StayWhenTheirJointTurns) {
  const Standing standing;
  const std::vector<JointAxis> axes = joint_axes(standing.robot);
  ASSERT_EQ(axes.size(), standing.robot.joints.size());
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const sim_board::JointDescription& joint = standing.robot.joints[i];
    const auto axis_in_parent = [&](const std::vector<view::Pose>& links, const Eigen::Vector3d& p_L_m) {
      const view::Pose& child = links[static_cast<std::size_t>(joint.child)];
      const view::Pose& parent = links[static_cast<std::size_t>(joint.parent)];
      const Eigen::Vector3f p_W_m = child.p_WL_m + child.q_WL * p_L_m.cast<float>();
      return Eigen::Vector3f(parent.q_WL.conjugate() * (p_W_m - parent.p_WL_m));
    };
    const auto straight = standing.links();
    const auto bent = standing.links(joint.name, 0.5 * joint.upper_rad);
    for (const Eigen::Vector3d& p_L_m :
         {axes[i].p_L_m, Eigen::Vector3d(axes[i].p_L_m + 0.1 * axes[i].axis_L)})
      EXPECT_LT((axis_in_parent(straight, p_L_m) - axis_in_parent(bent, p_L_m)).norm(), 1e-5F) << joint.name;
    const Eigen::Vector3d beside_m = axes[i].p_L_m + 0.1 * axes[i].axis_L.unitOrthogonal();
    EXPECT_GT((axis_in_parent(straight, beside_m) - axis_in_parent(bent, beside_m)).norm(), 1e-3F)
        << joint.name;
  }
}

TEST(JointAxes, GiveTheAngleOfTheirJoint) {
  const Standing standing;
  const std::vector<JointAxis> axes = joint_axes(standing.robot);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    EXPECT_EQ(axes[i].name, standing.robot.joints[i].name);
    for (const double share : {0.4, 0.9}) {
      const double angle_rad = axes[i].lower_rad + share * (axes[i].upper_rad - axes[i].lower_rad);
      const auto links = standing.links(axes[i].name, angle_rad);
      EXPECT_NEAR(joint_angle_rad(axes[i], links), angle_rad, 1e-6) << axes[i].name;
      const std::size_t other = i == 0 ? 1 : 0;
      EXPECT_NEAR(joint_angle_rad(axes[other], links), 0.0, 1e-6);
    }
  }
}

TEST(LinkLayers, NameWhatIsShownUnderThePixel) {
  const Standing standing;
  const auto links = standing.links();
  LinkLayers layers;
  layers.set_robot(&standing.robot);
  view::Camera camera;
  camera.target_W_m = links[0].p_WL_m.cast<double>();
  const auto at = [&](const Eigen::Vector3d& p_W_m) {
    return layers.at(links, camera, 800, 600, view::project(camera, 800, 600, p_W_m));
  };
  const Eigen::Vector3d last_m = links.back().p_WL_m.cast<double>();
  EXPECT_TRUE(at(last_m).empty()) << "nothing is shown";
  layers.frames = true;
  ASSERT_FALSE(at(last_m).empty());
  EXPECT_EQ(at(last_m).front().kind, MarkName::Kind::kFrame);
  EXPECT_EQ(at(last_m).front().index, links.size() - 1);
  layers.frames = false;
  layers.axes = true;
  const auto knee = static_cast<std::size_t>(*standing.robot.find_joint("left_knee"));
  const JointAxis& axis = layers.axis(knee);
  const auto& shin = links[static_cast<std::size_t>(axis.link)];
  const Eigen::Vector3d tip_m = shin.p_WL_m.cast<double>() +
                                shin.q_WL.cast<double>() * Eigen::Vector3d(axis.p_L_m + 0.04 * axis.axis_L);
  const auto found = at(tip_m);
  EXPECT_TRUE(std::ranges::any_of(
      found, [&](const MarkName& mark) { return mark.kind == MarkName::Kind::kAxis && mark.index == knee; }));
  EXPECT_TRUE(std::ranges::is_sorted(found, {}, &MarkName::distance_px));
  EXPECT_TRUE(at(tip_m + Eigen::Vector3d(0.0, 1.0, 1.0)).empty());
}

TEST(LinkMarks, AreAtTheirLinks) {
  const Standing standing;
  const auto links = standing.links();
  view::Marks frames;
  add_link_frames(frames, links);
  EXPECT_TRUE(frames.flat.empty());
  for (const view::Pose& link : links)
    EXPECT_TRUE(std::ranges::any_of(frames.solid, [&](const view::MarkVertex& vertex) {
      return (vertex.p_W_m - link.p_WL_m).norm() < 0.002F;
    }));
  view::Marks arrows;
  add_joint_axes(arrows, links, joint_axes(standing.robot));
  EXPECT_GT(arrows.solid.size(), 3 * standing.robot.joints.size());
}

TEST(Exploded, MovesEachLinkAwayFromItsCarrier) {
  const Standing standing;
  const auto links = standing.links();
  const auto apart = exploded(standing.scene, links, 0.5);
  ASSERT_EQ(apart.size(), links.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    EXPECT_EQ(apart[i].q_WL.coeffs(), links[i].q_WL.coeffs());
    const int parent = standing.scene.links[i].parent;
    if (parent < 0) continue;
    const auto carrier = static_cast<std::size_t>(parent);
    const Eigen::Vector3f way_m = links[i].p_WL_m - links[carrier].p_WL_m;
    EXPECT_LT((apart[i].p_WL_m - apart[carrier].p_WL_m - 1.5F * way_m).norm(), 1e-5F);
  }
  const auto height = [](const view::Pose& link) { return link.p_WL_m.z(); };
  EXPECT_NEAR(std::ranges::min(apart, {}, height).p_WL_m.z(), std::ranges::min(links, {}, height).p_WL_m.z(),
              1e-5F);
  const auto same = exploded(standing.scene, links, 0.0);
  for (std::size_t i = 0; i < links.size(); ++i) EXPECT_EQ(same[i].p_WL_m, links[i].p_WL_m);
}

TEST(OverlapFinder, NamesTheLinksThatPenetrateEachOther) {
  const Standing standing;
  const OverlapFinder finder(standing.robot);
  EXPECT_TRUE(finder.links_in_overlap(standing.links()).empty());
  // Hips rolled inwards press the legs into each other.
  const auto pressed = standing.links("left_hip_roll", -0.5);
  const std::vector<int> found = finder.links_in_overlap(pressed);
  ASSERT_GE(found.size(), 2U);
  view::Marks marks;
  add_outlines(marks, standing.scene, pressed, found);
  EXPECT_FALSE(marks.solid.empty());
  view::Marks none;
  add_outlines(none, standing.scene, pressed, {});
  EXPECT_TRUE(none.solid.empty());
}

}  // namespace
}  // namespace koboshi::studio
