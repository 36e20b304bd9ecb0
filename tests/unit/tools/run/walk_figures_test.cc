#include "tools/run/walk_figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "firmware/behaviour/behaviour.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::tools {
namespace {

constexpr double kStep_s = 0.1;

class WalkFigures : public testing::Test {
 protected:
  // A row each tenth of a second: in this state, with a planned ZMP or without.
  void write(const std::vector<std::pair<behaviour::State, bool>>& rows) {
    std::ofstream out(trace_);
    out << "time_s,state,planned_zmp_x_m\n";
    for (std::size_t i = 0; i < rows.size(); ++i) {
      out << kStep_s * static_cast<double>(i) << ',' << static_cast<int>(rows[i].first) << ','
          << (rows[i].second ? "0.1" : "") << '\n';
    }
  }

  const koboshi::test::TemporaryFolder folder_;
  const std::filesystem::path trace_ = folder_.path / "trace.csv";
};

TEST_F(WalkFigures, ShowTheLongestWalkAtACommandedVelocity) {
  std::vector<std::pair<behaviour::State, bool>> rows(10, {behaviour::State::kStanding, false});
  rows.insert(rows.end(), 5, {behaviour::State::kWalking, false});
  rows.insert(rows.end(), 10, {behaviour::State::kFallen, false});
  rows.insert(rows.end(), 8, {behaviour::State::kWalking, false});
  rows.insert(rows.end(), 3, {behaviour::State::kStanding, false});
  write(rows);
  const auto span = walk_to_show(trace_, 1.0);
  ASSERT_TRUE(span);
  EXPECT_NEAR(span->low, 2.5, 1e-9);
  EXPECT_NEAR(span->high, 3.2, 1e-9);
}

TEST_F(WalkFigures, ShowThreeCyclesOfALongWalk) {
  write(std::vector<std::pair<behaviour::State, bool>>(101, {behaviour::State::kMotion, true}));
  const auto span = walk_to_show(trace_, 0.5);
  ASSERT_TRUE(span);
  EXPECT_NEAR(span->low, 5.0, 1e-9);
  EXPECT_NEAR(span->high, 6.5, 1e-9);
}

TEST_F(WalkFigures, AreNotDrawnWithoutAWalk) {
  write(std::vector<std::pair<behaviour::State, bool>>(10, {behaviour::State::kMotion, false}));
  EXPECT_FALSE(walk_to_show(trace_, 0.5));
}

TEST_F(WalkFigures, HaveTheCycleOfTheParameters) {
  sim::Scenario scenario;
  scenario.robot_parameters.settings = {{{"step_time_ms", "parameters.yaml", 3}, 220.0}};
  EXPECT_NEAR(commanded_cycle_s(scenario), 0.44, 1e-9);
  scenario.parameters = {{{"step_time_ms", "s.yaml", 3}, 260.0}};
  EXPECT_NEAR(commanded_cycle_s(scenario), 0.52, 1e-9);
}

// The feet bear 10 N, then next to nothing, then 10 N again.
TEST_F(WalkFigures, LeaveOutAZmpThatBearsNextToNothing) {
  std::ofstream out(trace_);
  out << "time_s";
  for (const char* name :
       {"zmp_x_m", "zmp_y_m", "true_zmp_x_m", "true_zmp_y_m", "planned_zmp_x_m", "planned_zmp_y_m"})
    out << ',' << name;
  for (const std::string side : {"left", "right"}) {
    out << ',' << side << "_load_N,true_" << side << "_load_N";
    for (const char* of_sole : {"x_m", "y_m", "yaw_rad"}) out << ",true_" << side << "_sole_" << of_sole;
  }
  out << '\n';
  for (int i = 0; i < 3; ++i) {
    const double load_N = i == 1 ? 0.4 : 5.0;
    out << i << ",0.01,0.02,0.03,0.04,," << ',' << load_N << ',' << load_N << ",0,0,0," << load_N << ','
        << load_N << ",0,0,0\n";
  }
  out.close();
  sim::RobotDescription robot;
  robot.links.resize(1);
  robot.links[0].mass_kg = 1.2;
  const PlaneFigure figure = zmp_figure(trace_, robot, {0.0, 2.0});
  EXPECT_EQ(figure.title, "ZMP over the footprints, 0.0 s to 2.0 s");
  ASSERT_EQ(figure.curves.size(), 2u);  // nothing was planned
  for (const PlaneCurve& curve : figure.curves) {
    ASSERT_EQ(curve.points.size(), 3u);
    EXPECT_FALSE(std::isnan(curve.points[0].x));
    EXPECT_TRUE(std::isnan(curve.points[1].x));
    EXPECT_FALSE(std::isnan(curve.points[2].x));
  }
  EXPECT_NEAR(figure.curves[0].points[0].y, 40.0, 1e-9);
}

}  // namespace
}  // namespace koboshi::tools
