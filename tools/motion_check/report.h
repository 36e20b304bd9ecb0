#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/behaviour/fall_detector.h"
#include "sim_board/description/description.h"
#include "simulation/motion_language/parse/diagnostic.h"
#include "tools/motion_check/analysis.h"
#include "tools/motion_check/trajectory.h"

namespace koboshi::tools {

// A finding of the check; docs/reference/motion-check.md lists the codes.
struct Finding {
  std::string code{};  // "C006"
  simulation::Severity severity = simulation::Severity::kError;
  std::uint16_t step = 0;  // of the image
  double time_s = 0.0;     // since the start of the motion
  // "found FOUND at TIME, expected EXPECTED", then the hint: a whole sentence, empty if there is none.
  std::string found{};
  std::string expected{};
  std::string hint{};
  std::string path{};                  // Trajectory::path
  std::vector<std::uint16_t> links{};  // that overlap, of C005
};

enum class Balance : std::uint8_t { kNotJudged, kStable, kClose, kUnstable };
inline constexpr std::array<std::string_view, 4> kBalanceNames{"not judged", "stable", "close", "unstable"};

// A step on a path, with the extremes of its ticks.
struct StepReport {
  std::uint16_t step = 0;
  double start_s = 0.0;  // of its first tick
  double duration_s = 0.0;
  double least_margin_m = std::numeric_limits<double>::infinity();  // infinite: not judged
  double least_margin_s = 0.0;
  JointShare speed{};   // of the joint's greatest speed
  JointShare torque{};  // of the torque at the lowest supply
};

// The result of the check of one path.
struct PathReport {
  std::vector<Finding> findings{};
  std::vector<StepReport> steps{};  // in the order of their first ticks
  Balance balance = Balance::kNotJudged;
  double least_margin_m = std::numeric_limits<double>::infinity();
  double least_margin_s = 0.0;
  double duration_s = 0.0;
};

// The limits that a motion is checked against.
struct CheckLimits {
  behaviour::FallLimits fall{};
  double max_declared_lean_rad = 0.0;    // object 2140:7; the firmware clamps declared leans to it
  double largest_cyclic_step_rad = 0.0;  // object 2001h of the drives
  // A margin is called close from `beyond_m` outside the support polygon to `close_m` inside.
  double close_m = kClose_m;
  double beyond_m = kBeyond_m;
  std::vector<double> standing_rad{};  // the pose from which other motions begin, by joint; empty: unknown

  // docs/experiment/motion-check.md says how these were found.
  static constexpr double kClose_m = 0.005;
  static constexpr double kBeyond_m = 0.002;
};

// A finding about a tick of a path.
[[nodiscard]] Finding finding_at(const Trajectory& trajectory, std::size_t tick, std::string code,
                                 simulation::Severity severity, std::string found, std::string expected,
                                 std::string hint = {});

// Collision boxes that overlap by less only touch.
inline constexpr double kTouching_m = 0.0005;

// Judges a path. `states` and `extremes` are those of the trajectory (MotionAnalysis).
[[nodiscard]] PathReport judge(const Trajectory& trajectory, const std::vector<TickState>& states,
                               const sim_board::RobotDescription& robot, const CheckLimits& limits,
                               const std::vector<MixExtreme>& extremes = {});

}  // namespace koboshi::tools
