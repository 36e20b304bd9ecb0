#include "simulation/gait/gait_plan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim_board/world/gravity.h"

namespace koboshi::simulation {
namespace {

using Eigen::Vector2d;
using hal::Side;

// Sole of the default robot, relative to the ankle.
constexpr double kSoleBack_m = -0.038;
constexpr double kSoleFront_m = 0.062;
constexpr double kSoleHalfWidth_m = 0.028;

Gait koboshi_gait() { return read_gait(KOBOSHI_SOURCE_DIR "/robots/koboshi/gait.yaml"); }

class GaitPlanTest : public testing::Test {
 protected:
  // End of two cycles after the start from standing.
  double end_s() const { return plan_.start_s() + 2.0 * plan_.cycle_s(); }

  Gait gait_ = koboshi_gait();
  GaitPlan plan_{gait_};
};

TEST_F(GaitPlanTest, StartsAtRestInTheMiddleAboveTheZmp) {
  const GaitInstant begin = plan_.at(0.0);
  EXPECT_NEAR(begin.com_W_m.x(), gait_.zmp_forward_m, 1e-12);
  EXPECT_NEAR(begin.com_W_m.y(), 0.0, 1e-12);
  EXPECT_NEAR((begin.com_W_m - begin.zmp_W_m).norm(), 0.0, 1e-12);
  EXPECT_NEAR((plan_.at(1e-4).com_W_m - begin.com_W_m).norm() / 1e-4, 0.0, 1e-3);
  EXPECT_NEAR(begin.load_share[0], 0.5, 1e-12);
}

TEST_F(GaitPlanTest, FollowsThePendulumEquationThroughout) {
  const double h = 1e-4;
  const double rate = sim_board::kGravity_m_per_s2 / gait_.com_height_m;
  for (double t = h; t < end_s(); t += 0.0037) {
    const GaitInstant now = plan_.at(t);
    const Vector2d acceleration =
        (plan_.at(t + h).com_W_m - 2.0 * now.com_W_m + plan_.at(t - h).com_W_m) / (h * h);
    // The ZMP of the point mass must match the plan within the error of the finite difference over [t - h, t
    // + h].
    EXPECT_NEAR((now.com_W_m - acceleration / rate - now.zmp_W_m).norm(), 0.0, 1e-3) << t;
  }
}

TEST_F(GaitPlanTest, RepeatsItsCycleOneStrideFurther) {
  const double t = plan_.start_s() + 0.3 * plan_.cycle_s();
  const GaitInstant first = plan_.at(t);
  const GaitInstant later = plan_.at(t + 7.0 * plan_.cycle_s());
  EXPECT_NEAR(later.com_W_m.x() - first.com_W_m.x(), 7.0 * plan_.stride_m(), 1e-9);
  EXPECT_NEAR(later.com_W_m.y(), first.com_W_m.y(), 1e-9);
  EXPECT_EQ(later.support, first.support);
  EXPECT_NEAR((later.zmp_S_m - first.zmp_S_m).norm(), 0.0, 1e-9);
}

TEST_F(GaitPlanTest, HasTwoMirroredSteps) {
  const double t = plan_.start_s() + 0.2 * plan_.cycle_s();
  const GaitInstant one = plan_.at(t);
  const GaitInstant other = plan_.at(t + 0.5 * plan_.cycle_s());
  EXPECT_NE(one.support, other.support);
  EXPECT_NEAR(other.com_W_m.x() - one.com_W_m.x(), gait_.step_length_m, 1e-9);
  EXPECT_NEAR(other.com_W_m.y(), -one.com_W_m.y(), 1e-9);
}

TEST_F(GaitPlanTest, StopsAtRestInTheMiddle) {
  const GaitInstant leave = plan_.at_stop(0.0);
  const GaitInstant cycle = plan_.at(plan_.start_s());
  EXPECT_NEAR((leave.com_W_m - cycle.com_W_m).norm(), 0.0, 1e-9);
  const double end_s = plan_.stop_s();
  const GaitInstant end = plan_.at_stop(end_s);
  EXPECT_NEAR((end.com_W_m - end.zmp_W_m).norm(), 0.0, 1e-9);
  EXPECT_NEAR((end.com_W_m - plan_.at_stop(end_s - 1e-4).com_W_m).norm() / 1e-4, 0.0, 1e-3);
  EXPECT_NEAR(end.X_WSole[0].translation().x(), end.X_WSole[1].translation().x(), 1e-12);
}

TEST_F(GaitPlanTest, KeepsTheZmpInsideTheSupport) {
  const auto check = [&](const GaitInstant& now, double t) {
    if (now.load_share[0] < 1.0 && now.load_share[1] < 1.0)
      return;  // double support: the ZMP is between the
               // feet
    EXPECT_GT(now.zmp_S_m.x(), kSoleBack_m) << t;
    EXPECT_LT(now.zmp_S_m.x(), kSoleFront_m) << t;
    EXPECT_LT(std::abs(now.zmp_S_m.y()), kSoleHalfWidth_m) << t;
  };
  for (double t = 0.0; t < end_s(); t += 0.01) check(plan_.at(t), t);
  for (double t = 0.0; t < plan_.stop_s(); t += 0.01) check(plan_.at_stop(t), t);
}

TEST_F(GaitPlanTest, LiftsOnlyTheFootWithoutLoad) {
  double highest_m = 0.0;
  for (double t = 0.0; t < end_s(); t += 0.001) {
    const GaitInstant now = plan_.at(t);
    for (std::size_t side = 0; side < 2; ++side) {
      const double height_m = now.X_WSole[side].translation().z();
      highest_m = std::max(highest_m, height_m);
      EXPECT_GE(height_m, 0.0);
      if (height_m > 1e-9) {
        EXPECT_LT(now.load_share[side], 1e-9) << t;
      }
    }
  }
  EXPECT_NEAR(highest_m, gait_.step_height_m, 1e-6);
}

}  // namespace
}  // namespace koboshi::simulation
