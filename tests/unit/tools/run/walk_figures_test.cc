#include "tools/run/walk_figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include "firmware/behaviour/behaviour.h"
#include "tests/support/temporary_folder.h"
#include "tools/run/run_figures.h"

namespace koboshi::tools {
namespace {

constexpr double kStep_s = 0.1;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// A row each tenth of a second: in this state, with a planned ZMP or without.
Columns trace_of(const std::vector<std::pair<behaviour::State, bool>>& rows) {
  Columns trace = make_columns({"time_s", "state", "planned_zmp_x_m"});
  for (const auto& [state, planned] : rows) {
    const double time_s = kStep_s * static_cast<double>(trace[0].second.size());
    add_row(trace, {time_s, static_cast<double>(state), planned ? 0.1 : kNaN});
  }
  return trace;
}

TEST(WalkFigures, ShowTheLongestWalkAtACommandedVelocity) {
  std::vector<std::pair<behaviour::State, bool>> rows(10, {behaviour::State::kStanding, false});
  rows.insert(rows.end(), 5, {behaviour::State::kWalking, false});
  rows.insert(rows.end(), 10, {behaviour::State::kFallen, false});
  rows.insert(rows.end(), 8, {behaviour::State::kWalking, false});
  rows.insert(rows.end(), 3, {behaviour::State::kStanding, false});
  const auto span = walk_to_show(trace_of(rows), 1.0);
  ASSERT_TRUE(span);
  EXPECT_NEAR(span->low, 2.5, 1e-9);
  EXPECT_NEAR(span->high, 3.2, 1e-9);
}

TEST(WalkFigures, ShowThreeCyclesOfALongWalk) {
  const std::vector<std::pair<behaviour::State, bool>> rows(101, {behaviour::State::kMotion, true});
  const auto span = walk_to_show(trace_of(rows), 0.5);
  ASSERT_TRUE(span);
  EXPECT_NEAR(span->low, 5.0, 1e-9);
  EXPECT_NEAR(span->high, 6.5, 1e-9);
}

TEST(WalkFigures, AreNotDrawnWithoutAWalk) {
  const std::vector<std::pair<behaviour::State, bool>> rows(10, {behaviour::State::kMotion, false});
  EXPECT_FALSE(walk_to_show(trace_of(rows), 0.5));
}

TEST(WalkFigures, HaveTheCycleOfTheParameters) {
  simulation::Scenario scenario;
  scenario.robot_parameters.settings = {{{"step_time_ms", "parameters.yaml", 3}, 220.0}};
  EXPECT_NEAR(commanded_cycle_s(scenario), 0.44, 1e-9);
  scenario.parameters = {{{"step_time_ms", "s.yaml", 3}, 260.0}};
  EXPECT_NEAR(commanded_cycle_s(scenario), 0.52, 1e-9);
}

// The feet bear 10 N, then next to nothing, then 10 N again.
TEST(WalkFigures, OmitTheZmpOfAnUnloadedFoot) {
  Columns trace{{"time_s", {0.0, 1.0, 2.0}}};
  const auto add = [&](const std::string& name, double value) {
    trace.push_back({name, std::vector<double>(3, value)});
  };
  for (const auto& [name, x_m] : {std::pair("zmp", 0.01), {"true_zmp", 0.03}, {"planned_zmp", kNaN}}) {
    add(std::string(name) + "_x_m", x_m);
    add(std::string(name) + "_y_m", x_m + 0.01);
  }
  for (const std::string side : {"left", "right"}) {
    for (const std::string told : {"", "true_"}) trace.push_back({told + side + "_load_N", {5.0, 0.4, 5.0}});
    for (const char* of_sole : {"x_m", "y_m", "yaw_rad"}) add("true_" + side + "_sole_" + of_sole, 0.0);
  }
  sim_board::RobotDescription robot;
  robot.links.resize(1);
  robot.links[0].mass_kg = 1.2;
  const PlaneFigure figure = zmp_figure(trace, robot, {0.0, 2.0});
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

// A frame with the state walking, sent by another node: the robot lies, and has no ZMP.
TEST(WalkFigures, OmitTheZmpOfAWalkWithoutOneAndDrawTheOthers) {
  const test::TemporaryFolder folder;
  const auto trace_of_walk = [](std::size_t rows_of_walk) {
    std::set<std::string> names = walk_columns();
    names.insert("time_s");
    Columns trace;
    for (const std::string& name : names) {
      trace.push_back({name, std::vector<double>(8, name.find("zmp") != std::string::npos ? kNaN : 0.0)});
      for (std::size_t row = 0; row < 8; ++row) {
        if (name == "time_s") trace.back().second[row] = kStep_s * static_cast<double>(row);
        if (name == "state" && row >= 2 && row < 2 + rows_of_walk)
          trace.back().second[row] = static_cast<double>(behaviour::State::kWalking);
      }
    }
    return trace;
  };
  sim_board::RobotDescription robot;
  robot.links.resize(1);
  robot.links[0].mass_kg = 1.2;
  EXPECT_EQ(draw_walk_figures(trace_of_walk(1), robot, 0.5, folder.path),
            "no figures zmp, joints and attitude: the walk at 0.20 s has a single sample");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
  EXPECT_EQ(draw_walk_figures(trace_of_walk(3), robot, 0.5, folder.path),
            "no figure zmp: no ZMP was planned or measured from 0.20 s to 0.40 s");
  EXPECT_TRUE(std::filesystem::exists(folder.path / "joints.svg"));
  EXPECT_TRUE(std::filesystem::exists(folder.path / "attitude.png"));
  EXPECT_FALSE(std::filesystem::exists(folder.path / "zmp.gnuplot"));
}

TEST(ShownTrace, KeepsTheColumnsOfTheFigures) {
  using enum simulation::TraceKind;
  ShownTrace trace({{"state", "", kInteger}, {"imu_roll", "rad"}, {"left_knee_torque", "permille"}}, {});
  trace.add(10'000, std::vector<simulation::TraceValue>{3, 0.25, 7.0});
  trace.add(20'000, std::vector<simulation::TraceValue>{4, kNaN, 7.0});
  ASSERT_EQ(trace.columns().size(), 3u);  // no figure shows the torque
  EXPECT_THAT(values_of(trace.columns(), "time_s"), testing::ElementsAre(0.01, 0.02));
  EXPECT_THAT(values_of(trace.columns(), "state"), testing::ElementsAre(3.0, 4.0));
  EXPECT_EQ(values_of(trace.columns(), "imu_roll_rad")[0], 0.25);
  EXPECT_TRUE(std::isnan(values_of(trace.columns(), "imu_roll_rad")[1]));
}

TEST(ShownTrace, KeepsEverySecondRowOfALongRun) {
  ShownTrace trace({{"state", "", simulation::TraceKind::kInteger}}, {});
  for (std::uint64_t row = 0; row < ShownTrace::kMaxRows + 4; ++row)
    trace.add(10'000 * row, std::vector<simulation::TraceValue>{static_cast<int>(row % 8)});
  const std::vector<double>& time_s = values_of(trace.columns(), "time_s");
  ASSERT_EQ(time_s.size(), ShownTrace::kMaxRows / 2 + 2);
  EXPECT_DOUBLE_EQ(time_s[1], 0.02);
  EXPECT_DOUBLE_EQ(time_s.back(), 0.01 * (ShownTrace::kMaxRows + 2));
  EXPECT_EQ(values_of(trace.columns(), "state").back(), 2.0);
}

}  // namespace
}  // namespace koboshi::tools
