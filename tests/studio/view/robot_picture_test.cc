#include "studio/view/robot_picture.h"

#include <gtest/gtest.h>

#include <utility>

#include "studio/view/pose_handles.h"
#include "view/render/camera.h"

namespace koboshi::studio {
namespace {

constexpr int kPictureWidth_px = 400;
constexpr int kPictureHeight_px = 300;
constexpr double kAspect = 4.0 / 3.0;

// Two boxes of 0.1 m beside each other.
view::Scene two_boxes() {
  view::Scene scene;
  scene.links.resize(2);
  for (view::Link& link : scene.links) {
    view::Shape box;
    box.geometry = view::Box{{0.1, 0.1, 0.1}};
    link.visuals = {box};
  }
  scene.links[1].parent = 0;
  return scene;
}

std::vector<view::Pose> poses(float ahead_m) {
  std::vector<view::Pose> links(2);
  links[0].p_WL_m = {ahead_m, 0.0F, 0.3F};
  links[1].p_WL_m = {ahead_m, 0.3F, 0.3F};
  return links;
}

std::vector<Eigen::Vector3f> places(const std::vector<view::Pose>& links) {
  std::vector<Eigen::Vector3f> result;
  for (const view::Pose& link : links) result.push_back(link.p_WL_m);
  return result;
}

class RobotPictureTest : public testing::Test {
 protected:
  RobotPictureTest() {
    picture_.set_scene(two_boxes(), nullptr);
    picture_.show_robot(poses(0.0F), {}, kAspect);
  }
  // The middle of a link of the robot that can be posed.
  PicturePlace place_of(std::size_t link) const {
    const auto pixel = view::project(picture_.camera(), kPictureWidth_px, kPictureHeight_px,
                                     picture_.posed()[link].p_WL_m.cast<double>());
    return {kPictureWidth_px, kPictureHeight_px, pixel};
  }

  RobotPicture picture_;
};

TEST_F(RobotPictureTest, LooksAtTheRobotThatComesFirst) {
  for (std::size_t link = 0; link < 2; ++link) {
    const auto hit = picture_.link_at(place_of(link));
    ASSERT_TRUE(hit) << link;
    EXPECT_EQ(hit->link, static_cast<int>(link));
  }
  EXPECT_FALSE(picture_.link_at({kPictureWidth_px, kPictureHeight_px, {1.0, 1.0}}));
}

TEST_F(RobotPictureTest, FollowsTheRobotOnlyIfItIsTold) {
  const double before_m = picture_.camera().target_W_m.x();
  picture_.show_robot(poses(0.5F), {}, kAspect);
  EXPECT_NEAR(picture_.camera().target_W_m.x() - before_m, 0.5, 1e-6);
  picture_.set_follow(false);
  picture_.show_robot(poses(0.9F), {}, kAspect);
  EXPECT_NEAR(picture_.camera().target_W_m.x() - before_m, 0.5, 1e-6);
}

TEST_F(RobotPictureTest, PosesTheSecondRobotIfThereIsOne) {
  EXPECT_EQ(places(picture_.posed()), places(poses(0.0F)));
  picture_.show_ghost(poses(0.2F));
  EXPECT_TRUE(picture_.has_ghost());
  EXPECT_EQ(places(picture_.posed()), places(poses(0.2F)));
  picture_.show_ghost({});
  EXPECT_EQ(places(picture_.posed()), places(poses(0.0F)));
}

TEST_F(RobotPictureTest, KeepsTheGivenPosesWhereLinksAreShownApart) {
  picture_.set_exploded(true);
  EXPECT_EQ(places(picture_.links()), places(poses(0.0F)));
  EXPECT_NE(places(picture_.drawn().links), places(poses(0.0F)));
  picture_.set_exploded(false);
  EXPECT_EQ(places(picture_.drawn().links), places(poses(0.0F)));
}

TEST_F(RobotPictureTest, ShapesOfOtherLinksAreAnotherScene) {
  const std::uint64_t version = picture_.scene_version();
  view::Scene scene = two_boxes();
  scene.links.emplace_back();
  sim_board::RobotDescription robot;
  robot.links.resize(2);
  robot.joints.resize(1);
  robot.joints[0].parent = 0;
  robot.joints[0].child = 1;
  picture_.set_shapes(two_boxes(), robot);
  EXPECT_TRUE(picture_.can_be_drawn());
  picture_.set_shapes(std::move(scene), robot);
  EXPECT_FALSE(picture_.can_be_drawn());  // until it is posed
  EXPECT_EQ(picture_.scene_version(), version + 2);
}

TEST_F(RobotPictureTest, HandlesAreAtTheLinkThatTheMouseGrabs) {
  PoseHandles handles;
  EXPECT_FALSE(handles.grabbed_at(picture_, place_of(1), true).link);
  EXPECT_TRUE(handles.set_links({{.link = 1, .rotates = true}}));
  EXPECT_FALSE(handles.set_links({{.link = 1, .rotates = true}}));
  EXPECT_FALSE(handles.gizmo(picture_));
  const PoseHandles::Grabbed grabbed = handles.grabbed_at(picture_, place_of(1), true);
  ASSERT_TRUE(grabbed.link);
  EXPECT_EQ(grabbed.link->link, 1);
  EXPECT_TRUE(handles.hover(grabbed));
  EXPECT_FALSE(handles.hover(grabbed));
  ASSERT_TRUE(handles.gizmo(picture_));
  EXPECT_TRUE(handles.gizmo(picture_)->p_W_m.isApprox(poses(0.0F)[1].p_WL_m.cast<double>(), 1e-6));
  handles.hide();
  EXPECT_FALSE(handles.gizmo(picture_));
}

}  // namespace
}  // namespace koboshi::studio
