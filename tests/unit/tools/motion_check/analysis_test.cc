#include "tools/motion_check/analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "base/text/user_units.h"
#include "tests/unit/tools/motion_check/koboshi_robot.h"
#include "tools/motion_check/report.h"
#include "tools/motion_check/servo_curve.h"

namespace koboshi::tools {
namespace {

using testing::HasSubstr;

constexpr Supply kSupply{.nominal_V = 7.6, .lowest_V = 6.0};
constexpr double kDegree_rad = 1.0 / kDegreesPerRad;

// Poses by joint names without their sides, in degrees, as in a motion file.
using PoseDeg = std::map<std::string, double>;

const PoseDeg kStand{
    {"hip_pitch", -15.9}, {"knee", 43.72}, {"ankle_pitch", -27.82}, {"shoulder_roll", 8.0}, {"elbow", -20.0}};

class AnalysisTest : public testing::Test {
 protected:
  std::vector<double> row(const PoseDeg& pose) const {
    std::vector<double> result(robot_.joints.size(), 0.0);
    for (const auto& [name, value_deg] : pose) {
      for (const sim_board::MirroredJoint& joint : robot_.find_joints(name))
        result[static_cast<std::size_t>(joint.joint)] = joint.sign * value_deg * kDegree_rad;
    }
    return result;
  }
  static PoseDeg with(PoseDeg pose, const PoseDeg& changes) {
    for (const auto& [name, value] : changes) pose[name] = value;
    return pose;
  }

  // Linear steps of `seconds` between the poses, each followed by a rest of half a second.
  Trajectory linear(const std::vector<PoseDeg>& poses, double seconds) const {
    Trajectory trajectory;
    std::vector<double> from = row(poses.front());
    trajectory.add(from, 0);
    std::uint16_t step = 0;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const std::vector<double> to = row(poses[i]);
      const int ticks = static_cast<int>(std::lround(seconds / kTick_s));
      for (int tick = 1; tick <= ticks; ++tick) {
        std::vector<double> now(from.size());
        for (std::size_t j = 0; j < now.size(); ++j)
          now[j] = std::lerp(from[j], to[j], static_cast<double>(tick) / ticks);
        trajectory.add(now, step);
      }
      ++step;
      for (int tick = 0; tick < 50; ++tick) trajectory.add(to, step);
      ++step;
      from = to;
    }
    return trajectory;
  }

  PathReport check(const Trajectory& trajectory) {
    return judge(trajectory, analysis_.analyse(trajectory), robot_, limits_);
  }
  static const Finding* find(const PathReport& report, const std::string& code) {
    for (const Finding& finding : report.findings)
      if (finding.code == code) return &finding;
    return nullptr;
  }

  const sim_board::RobotDescription& robot_ = koboshi_robot();
  MotionAnalysis analysis_{robot_, kSupply};
  // Limits of the fall detector as in robots/koboshi/parameters.yaml: 26, 26, 28 and 10 degrees.
  CheckLimits limits_{
      .fall = {.front = 4733, .back = 4733, .side = 5097, .lead_ms = 135, .min_lean = 1820, .cycles = 2},
      .largest_cyclic_step_rad = 30.0 * kDegree_rad,
      .standing_rad = {}};
};

TEST_F(AnalysisTest, ResponseIsAWeightedMean) {
  const auto& response = analysis_.response();
  EXPECT_NEAR(std::accumulate(response.begin(), response.end(), 0.0), 1.0, 1e-12);
  EXPECT_GT(analysis_.natural_frequency_rad_per_s(), 15.0);
  EXPECT_LT(analysis_.natural_frequency_rad_per_s(), 40.0);
}

TEST_F(AnalysisTest, StandingIsStable) {
  const PathReport report = check(linear({kStand, kStand}, 1.0));
  EXPECT_EQ(report.balance, Balance::kStable);
  EXPECT_TRUE(report.findings.empty()) << report.findings.front().found;
  EXPECT_GT(report.least_margin_m, 0.02);
  EXPECT_NEAR(report.duration_s, 1.5, 1e-9);
  ASSERT_EQ(report.steps.size(), 2U);
}

// The trunk leans as far as the joints yield to its weight, in inverse proportion to their gain.
TEST_F(AnalysisTest, JointsYieldByTheirGain) {
  const auto pitch_rad = [&](double gain) {
    Trajectory trajectory = linear({kStand, with(kStand, {{"ankle_pitch", -29.82}}), kStand}, 2.0);
    const std::vector<double> gains(robot_.joints.size(), gain);
    std::ranges::fill(trajectory.gains, trajectory.index_of(gains));
    return analysis_.analyse(trajectory)[220].pitch_rad;  // in the rest
  };
  const double own_rad = pitch_rad(1.0);
  const double yield_rad = (pitch_rad(0.5) - own_rad);  // of the own gain
  EXPECT_GT(yield_rad, 0.1 * kDegree_rad);
  EXPECT_NEAR(pitch_rad(0.25) - own_rad, 3.0 * yield_rad, 0.02 * yield_rad);
  EXPECT_NEAR(pitch_rad(2.0) - own_rad, -0.5 * yield_rad, 0.02 * yield_rad);
  EXPECT_EQ(pitch_rad(1.0), own_rad) << "what is known of one gain is not taken for another";
}

TEST_F(AnalysisTest, ReportsTheEdgeThatTheCentreOfMassLeaves) {
  const PathReport report = check(linear({kStand, with(kStand, {{"ankle_pitch", -50.0}}), kStand}, 2.0));
  EXPECT_EQ(report.balance, Balance::kUnstable);
  const Finding* const finding = find(report, "C006");
  ASSERT_NE(finding, nullptr);
  EXPECT_THAT(finding->found, HasSubstr("to the front"));
  EXPECT_THAT(finding->hint, HasSubstr("to the back"));
  const PathReport back = check(linear({kStand, with(kStand, {{"ankle_pitch", -5.0}}), kStand}, 2.0));
  ASSERT_NE(find(back, "C006"), nullptr);
  EXPECT_THAT(find(back, "C006")->found, HasSubstr("to the back"));
}

// The same poses, fast: the pose is within the soles, its accelerations are not.
TEST_F(AnalysisTest, AQuickLeanIsUnstableByItsAccelerations) {
  const std::vector<PoseDeg> poses{kStand, with(kStand, {{"ankle_pitch", -21.0}}), kStand};
  EXPECT_EQ(check(linear(poses, 2.0)).balance, Balance::kStable);
  const PathReport quick = check(linear(poses, 0.04));
  EXPECT_EQ(quick.balance, Balance::kUnstable);
  ASSERT_NE(find(quick, "C006"), nullptr);
  EXPECT_THAT(find(quick, "C006")->found, HasSubstr("ZMP"));
  EXPECT_THAT(find(quick, "C006")->hint, HasSubstr("minimum_jerk"));
}

TEST_F(AnalysisTest, ReportsSpeedsAndSteps) {
  const PathReport report = check(linear({kStand, with(kStand, {{"head_pan", 80.0}}), kStand}, 0.02));
  const Finding* const speed = find(report, "C001");
  ASSERT_NE(speed, nullptr);
  EXPECT_THAT(speed->found, HasSubstr("head_pan turning at 4000 deg/s"));
  ASSERT_NE(find(report, "C002"), nullptr);
  EXPECT_THAT(find(report, "C002")->found, HasSubstr("40.0 deg in one cycle"));
  EXPECT_EQ(find(check(linear({kStand, with(kStand, {{"head_pan", 80.0}}), kStand}, 1.0)), "C001"), nullptr);
}

// At 0.9 of the speed without load at the nominal supply a servo has no torque at 0.79 of that supply: a
// share of it would be any number.
TEST_F(AnalysisTest, NamesASpeedWithoutTorqueInsteadOfItsShare) {
  const double way_deg = 0.9 * 7.48 * kDegreesPerRad * 0.2;
  const PathReport report = check(linear({kStand, with(kStand, {{"head_pan", way_deg}}), kStand}, 0.2));
  EXPECT_EQ(find(report, "C001"), nullptr);
  const Finding* const torque = find(report, "C003");
  ASSERT_NE(torque, nullptr);
  EXPECT_EQ(torque->found, "head_pan turning as fast as its servo turns without load at the lowest supply");
  EXPECT_EQ(torque->expected, "a speed at which it has torque left");
}

TEST_F(AnalysisTest, ReportsSelfCollisionWithThePair) {
  const PathReport report =
      check(linear({kStand, with(kStand, {{"elbow", 0.0}, {"shoulder_roll", -15.0}})}, 1.0));
  const Finding* const finding = find(report, "C005");
  ASSERT_NE(finding, nullptr);
  EXPECT_THAT(finding->found, HasSubstr("forearm"));
}

TEST_F(AnalysisTest, TheFirmwaresFallDetectorSeesALeanUnlessItIsDeclared) {
  // The trunk bows by 40 degrees over hips that move back.
  const PoseDeg bow = with(kStand, {{"hip_pitch", -62.0}, {"ankle_pitch", -34.0}});
  Trajectory trajectory = linear({kStand, bow, kStand}, 1.5);
  ASSERT_NE(find(check(trajectory), "C009"), nullptr);
  const auto& states = analysis_.analyse(trajectory);
  for (std::size_t tick = 0; tick < trajectory.ticks(); ++tick)
    trajectory.lean_pitch_rad[tick] = states[tick].pitch_rad;
  limits_.max_declared_lean_rad = 60.0 * kDegree_rad;
  EXPECT_EQ(find(check(trajectory), "C009"), nullptr);
  EXPECT_NE(find(check(trajectory), "C010"), nullptr);
  limits_.max_declared_lean_rad = 5.0 * kDegree_rad;
  EXPECT_NE(find(check(trajectory), "C009"), nullptr) << "the firmware takes 5 degrees of it";
  EXPECT_NE(find(check(trajectory), "C011"), nullptr);
}

// A drop of 0.2 mm carries the capture point sqrt(2 * 0.17 m * 0.2 mm) = 8.2 mm further.
TEST_F(AnalysisTest, ARollIsStableIfItsEnergyLeavesAMargin) {
  const Trajectory trajectory = linear({kStand, kStand}, 0.1);
  const auto balance_after_roll = [&](double margin_m) {
    std::vector<TickState> states = analysis_.analyse(trajectory);
    for (std::size_t tick = 20; tick < states.size(); ++tick) {
      states[tick].tip_rad = 2.5 * kDegree_rad;
      states[tick].drop_m = 0.0002;
      states[tick].com_height_m = 0.17;
      states[tick].com.distance_m = margin_m;
    }
    return judge(trajectory, states, robot_, limits_);
  };
  const PathReport report = balance_after_roll(0.014);
  EXPECT_EQ(report.balance, Balance::kStable);
  EXPECT_NE(find(report, "C008"), nullptr);
  EXPECT_EQ(balance_after_roll(0.012).balance, Balance::kClose);
}

TEST_F(AnalysisTest, WarnsOfAnEndThatIsNotTheStandingPose) {
  limits_.standing_rad = row(kStand);
  const PathReport report = check(linear({kStand, with(kStand, {{"head_pan", 30.0}})}, 1.0));
  ASSERT_NE(find(report, "C013"), nullptr);
  EXPECT_THAT(find(report, "C013")->found, HasSubstr("head_pan 30 deg away"));
}

TEST_F(AnalysisTest, AMotionThatLiesIsNotJudged) {
  Trajectory trajectory = linear({kStand, with(kStand, {{"ankle_pitch", -5.0}})}, 1.0);
  trajectory.on_feet.assign(trajectory.ticks(), false);
  EXPECT_EQ(check(trajectory).balance, Balance::kNotJudged);
}

// The windows of targets on which the states of a trajectory depend, each once: the smoothing reads a
// response that is shifted back by its mean delay, and rates read one smoothed tick to either side.
std::set<std::vector<double>> distinct_windows(const Trajectory& trajectory,
                                               const std::vector<double>& response) {
  double mean_delay = 0.0;
  for (std::size_t i = 0; i < response.size(); ++i) mean_delay += static_cast<double>(i) * response[i];
  const auto shift = static_cast<std::ptrdiff_t>(std::lround(mean_delay));
  const auto before = static_cast<std::ptrdiff_t>(response.size()) - shift;
  const auto last = static_cast<std::ptrdiff_t>(trajectory.ticks()) - 1;
  std::set<std::vector<double>> result;
  for (std::ptrdiff_t tick = 0; tick <= last; ++tick) {
    std::vector<double> window{tick == 0 ? 1.0 : 0.0, tick == last ? 1.0 : 0.0};
    for (std::ptrdiff_t i = tick - before; i <= tick + shift + 1; ++i) {
      const auto row = trajectory.row(static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, last)));
      window.insert(window.end(), row.begin(), row.end());
    }
    result.insert(window);
  }
  return result;
}

// An edit costs the edited ticks, and gives what a fresh analysis gives.
TEST_F(AnalysisTest, AnEditedStepIsComputedAlone) {
  std::vector<PoseDeg> poses;
  for (int i = 0; i < 12; ++i)
    poses.push_back(with(kStand, {{"head_pan", 5.0 * (i % 3)}, {"elbow", -20.0 - i}}));
  const Trajectory original = linear(poses, 0.5);
  analysis_.analyse(original);
  const auto known = distinct_windows(original, analysis_.response());
  EXPECT_EQ(analysis_.computed(), known.size());
  poses[6]["ankle_pitch"] = -25.0;
  const Trajectory edited = linear(poses, 0.5);
  const std::vector<TickState> incremental = analysis_.analyse(edited);
  const auto needed = distinct_windows(edited, analysis_.response());
  const auto is_new = [&](const std::vector<double>& window) { return !known.contains(window); };
  EXPECT_EQ(analysis_.computed(), static_cast<std::size_t>(std::ranges::count_if(needed, is_new)));
  EXPECT_LT(analysis_.computed(), 300U);
  EXPECT_GT(analysis_.computed(), 100U);
  MotionAnalysis fresh(robot_, kSupply);
  const std::vector<TickState>& whole = fresh.analyse(edited);
  EXPECT_EQ(fresh.computed(), needed.size()) << "ticks within a rest are alike and are computed once";
  EXPECT_GT(fresh.computed(), edited.ticks() / 2);
  for (std::size_t tick = 0; tick < edited.ticks(); ++tick) {
    ASSERT_EQ(incremental[tick].zmp_m, whole[tick].zmp_m) << tick;
    ASSERT_EQ(incremental[tick].torque.share, whole[tick].torque.share) << tick;
    ASSERT_EQ(incremental[tick].overlap.depth_m, whole[tick].overlap.depth_m) << tick;
  }
  // A step that is left out moves the rest.
  poses.erase(poses.begin() + 3);
  const Trajectory shorter = linear(poses, 0.5);
  const std::vector<TickState> moved = analysis_.analyse(shorter);
  EXPECT_LT(analysis_.computed(), 400U);
  const std::vector<TickState>& whole_shorter = fresh.analyse(shorter);
  for (std::size_t tick = 0; tick < shorter.ticks(); ++tick)
    ASSERT_EQ(moved[tick].zmp_m, whole_shorter[tick].zmp_m) << tick;
}

TEST_F(AnalysisTest, GivesTheLoadOfEachServo) {
  PoseDeg crouch = with(kStand, {{"hip_pitch", -40.0}, {"knee", 80.0}, {"ankle_pitch", -40.0}});
  const Trajectory trajectory = linear({kStand, crouch, kStand}, 1.0);
  const std::vector<TickState>& states = analysis_.analyse(trajectory);
  for (std::size_t tick = 0; tick < trajectory.ticks(); ++tick) {
    ASSERT_NE(states[tick].loads, nullptr);
    ASSERT_EQ(states[tick].loads->size(), robot_.joints.size());
    double greatest = 0.0;
    for (const ServoLoad& load : *states[tick].loads)
      greatest = std::max(greatest, static_cast<double>(std::abs(load.torque_Nm) / load.available_Nm));
    EXPECT_NEAR(greatest, states[tick].torque.share, 1e-5) << tick;
  }
  // Both knees hold the crouching robot; a shoulder has its arm alone.
  const auto held_Nm = [&](const char* joint) {
    const auto index = static_cast<std::size_t>(*robot_.find_joint(joint));
    return std::abs((*states[trajectory.ticks() / 2].loads)[index].torque_Nm);
  };
  EXPECT_GT(held_Nm("left_knee"), 0.1F);
  EXPECT_NEAR(held_Nm("left_knee"), held_Nm("right_knee"), 0.02F);
  EXPECT_LT(held_Nm("left_shoulder_roll"), 0.5F * held_Nm("left_knee"));
  // A robot that does not stand has no loads.
  Trajectory lying = trajectory;
  lying.on_feet.assign(lying.ticks(), false);
  EXPECT_EQ(analysis_.analyse(lying).front().loads, nullptr);
}

TEST(ServoCurve, FallsWithTheSpeedAndGrowsInBraking) {
  const sim_board::ServoDescription servo;
  const double stall_Nm = servo.torque_constant_Nm_per_A * 6.0 / servo.resistance_ohm;
  EXPECT_NEAR(available_torque_Nm(servo, 0.0, 6.0), stall_Nm, 1e-12);
  EXPECT_NEAR(available_torque_Nm(servo, 6.0 / servo.torque_constant_Nm_per_A, 6.0), 0.0, 1e-12);
  EXPECT_GT(available_torque_Nm(servo, -1.0, 6.0), stall_Nm);
  EXPECT_NEAR(torque_share(servo, 0.5 * stall_Nm, 0.0, 6.0), 0.5, 1e-12);
  EXPECT_GT(torque_share(servo, 0.5 * stall_Nm, 2.0, 6.0), 0.5);
  EXPECT_LT(torque_share(servo, 0.5 * stall_Nm, -2.0, 6.0), 0.5);
}

}  // namespace
}  // namespace koboshi::tools
