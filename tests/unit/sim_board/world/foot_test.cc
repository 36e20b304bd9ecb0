#include "sim_board/world/foot.h"
#include "mechanics/axes.h"

#include <gtest/gtest.h>

#include "sim_board/engine/make_world.h"
#include "sim_board/world/ground_truth.h"
#include "tests/support/sample_robots.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kWeight_N = 1.2 * 9.80665;
const Vector3d kSize_m(0.1, 0.06, 0.02);

// A box that stands, its sole frame `p_LSole_L` off its middle. On boxes, if there are any, and the plane is
// out of reach.
class StandingBox {
 public:
  explicit StandingBox(const Vector3d& p_LSole_L = {0.0, 0.0, -0.01},
                       const Vector3d& ground_normal_W = Vector3d::UnitZ(), std::vector<GroundBox> boxes = {})
      : robot_(sample_box(1.2, kSize_m)) {
    foot_.link = 0;
    foot_.X_LSole = Eigen::Translation3d(p_LSole_L);
    for (const double x : {-0.05, 0.05})
      for (const double y : {-0.03, 0.03}) foot_.corners_L.push_back({x, y, -0.01});
    WorldOptions options;
    options.ground.normal_W = ground_normal_W;
    if (!boxes.empty()) options.ground.offset_m = -1.0;
    options.ground.boxes = std::move(boxes);
    ground_ = options.ground;
    const Eigen::Matrix3d R_WL = mechanics::rotation_to_normal(ground_normal_W);
    options.X_WB = Eigen::Isometry3d(R_WL) * Eigen::Translation3d(0.0, 0.0, 0.01);
    world_ = make_world(robot_, options);
  }

  // A force down on the box at this place, until it has come to rest.
  void load(const Vector3d& p_L, double force_N) {
    for (int i = 0; i < 500; ++i) {
      world_->push(0, p_L, {0.0, 0.0, -force_N});
      world_->step();
    }
  }
  FootPressure pressure() const { return foot_pressure(robot_, foot_, *world_); }
  std::vector<Vector3d> support_points() const {
    std::vector<Vector3d> points_W;
    add_support_points(foot_, *world_, robot_, ground_, points_W);
    return points_W;
  }
  World& world() { return *world_; }
  const RobotDescription& robot() const { return robot_; }

 private:
  RobotDescription robot_;
  Foot foot_;
  GroundDescription ground_;
  std::unique_ptr<World> world_;
};

TEST(FootPressure, IsAtTheCentreOfABoxInTheFrameOfTheSole) {
  StandingBox box({-0.02, 0.01, -0.01});
  box.load(Vector3d::Zero(), 0.0);
  EXPECT_NEAR(box.pressure().load_N, kWeight_N, 1e-6);
  EXPECT_LT((box.pressure().zmp_S_m - Vector2d(0.02, -0.01)).norm(), 1e-6);
  EXPECT_LT(box.pressure().p_WZmp_W.head<2>().norm(), 1e-6);
}

TEST(FootPressure, MovesForwardAndLeftWithTheLoad) {
  StandingBox box;
  box.load({0.04, 0.02, 0.01}, kWeight_N);  // as much as the box weighs: half way there
  EXPECT_NEAR(box.pressure().load_N, 2 * kWeight_N, 1e-5);
  EXPECT_NEAR(box.pressure().zmp_S_m.x(), 0.02, 1e-4);
  EXPECT_NEAR(box.pressure().zmp_S_m.y(), 0.01, 1e-4);
}

TEST(FootPressure, MovesDownhillInThePlaneOfATiltedSole) {
  const double tilt_rad = 0.2;
  StandingBox box({0.0, 0.0, -0.01}, {std::sin(tilt_rad), 0.0, std::cos(tilt_rad)});  // falls towards +x
  box.load(Vector3d::Zero(), 0.0);
  EXPECT_NEAR(box.pressure().load_N, kWeight_N * std::cos(tilt_rad), 1e-3);
  EXPECT_NEAR(box.pressure().zmp_S_m.x(), 0.01 * std::tan(tilt_rad), 1e-4);
  EXPECT_NEAR(box.pressure().zmp_S_m.y(), 0.0, 1e-6);
}

TEST(FootPressure, IsInvalidInTheAir) {
  StandingBox box;
  EXPECT_EQ(box.pressure().load_N, 0.0);
  EXPECT_EQ(box.pressure().zmp_S_m, Vector2d(0.0, 0.0));
  EXPECT_EQ(box.support_points().size(), 0u);
}

TEST(SupportPoints, AreFourOfAStandingBoxAndTwoOfATippingOne) {
  StandingBox box;
  box.load({0.04, 0.02, 0.01}, kWeight_N);
  EXPECT_EQ(box.support_points().size(), 4u);
  for (int i = 0; i < 50; ++i) {
    box.world().push(0, {0.07, 0.0, 0.01}, {0.0, 0.0, -4.0 * kWeight_N});
    box.world().step();
  }
  EXPECT_EQ(box.support_points().size(), 2u);
}

// A step's edge lies across the sole, 20 mm before its front: what hangs over it does not carry.
TEST(SupportPoints, EndAtTheEdgeOfAStep) {
  GroundBox step;
  step.size_m = {1.0, 1.0, 0.1};
  step.X_WG = Eigen::Translation3d(0.03 - 0.5, 0.0, -0.05);
  StandingBox box({0.0, 0.0, -0.01}, Vector3d::UnitZ(), {step});
  box.load(Vector3d::Zero(), 0.0);
  double front_m = -1.0;
  double back_m = 1.0;
  for (const Vector3d& p_W : box.support_points()) {
    front_m = std::max(front_m, p_W.x());
    back_m = std::min(back_m, p_W.x());
  }
  EXPECT_NEAR(front_m, 0.03, 1e-4);
  EXPECT_NEAR(back_m, -0.05, 1e-4);
}

TEST(PoseBeforeStep, IsThePoseAtTheBeginningOfTheStep) {
  const RobotDescription robot = sample_humanoid();
  WorldOptions options;
  options.ground.present = false;
  const auto world = make_world(robot, options);
  world->push(0, {0.0, 0.05, 0.1}, {30.0, -20.0, 10.0});
  for (int i = 0; i < 20; ++i) world->step();  // it tumbles
  std::vector<Isometry3d> before;
  for (std::size_t link = 0; link < robot.links.size(); ++link)
    before.push_back(world->body(static_cast<int>(link)).X_WL);
  world->step();
  for (std::size_t link = 0; link < robot.links.size(); ++link) {
    const int number = static_cast<int>(link);
    ASSERT_GT((world->body(number).X_WL.matrix() - before[link].matrix()).norm(), 1e-5);
    EXPECT_LT((pose_before_step(robot, *world, number).matrix() - before[link].matrix()).norm(), 1e-7);
  }
}

}  // namespace
}  // namespace koboshi::sim_board
