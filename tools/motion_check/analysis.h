#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <unordered_map>
#include <vector>

#include "sim_board/description/description.h"
#include "tools/motion_check/body.h"
#include "tools/motion_check/collision.h"
#include "tools/motion_check/mix_extremes.h"
#include "tools/motion_check/servo_curve.h"
#include "tools/motion_check/trajectory.h"

namespace koboshi::tools {

// A joint and how much of something it uses.
struct JointShare {
  std::uint8_t joint = 0;
  double share = 0.0;
};

// The mechanics of one tick. Points are projected to the ground, in GroundAxes of the tick.
struct TickState {
  Eigen::Vector3d up_B = Eigen::Vector3d::UnitZ();
  Eigen::Vector2d zmp_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d com_m = Eigen::Vector2d::Zero();
  Margin zmp{};                        // of the ZMP in the support polygon
  Margin com{};                        // of the CoM's projection
  double pitch_rad = 0.0;              // of the trunk, forward positive; as the robot comes to rest
  double roll_rad = 0.0;               // to the right
  double tip_rad = 0.0;                // by which it rolls onto another edge (Rest)
  double drop_m = 0.0;                 // of the centre of mass in that roll
  double com_height_m = 0.0;           // above the ground
  bool rests = true;                   // false: it tips over
  std::array<double, 2> load_share{};  // by hal::Side
  std::uint32_t corners = 0;           // of the soles, on the ground
  JointShare torque{};                 // the greatest share of a servo's torque at the lowest supply
  // The load of each servo, by joint; null if the robot does not stand. Equal ticks share it.
  std::shared_ptr<const std::vector<ServoLoad>> loads{};
  Overlap overlap{};  // the deepest self-collision, of the targets

  // The smaller margin: it decides.
  const Margin& margin() const { return com.distance_m < zmp.distance_m ? com : zmp; }
};

// Supply of the servos in V.
struct Supply {
  double nominal_V = 0.0;  // at which the servos' stiffness is computed
  double lowest_V = 0.0;   // at which their torque must suffice
};

// Analyses trajectories of one robot tick by tick. Every tick depends on the targets of a short window alone;
// states are kept by window, so that an edited step costs as much as its own ticks, wherever it moves the
// others, and ticks alike on several paths or in the rounds of a loop are computed once.
class MotionAnalysis {
 public:
  // The robot must outlive the analysis.
  MotionAnalysis(const sim_board::RobotDescription& robot, const Supply& supply);

  // Returns the state at each tick; valid until the next call. Returns early, with unusable states, once
  // `cancel` is set.
  const std::vector<TickState>& analyse(const Trajectory& trajectory, const std::stop_token& cancel = {});
  // The poses of the last trajectory with the corrections of their mixes at the bounds.
  const std::vector<MixExtreme>& mix_extremes() const { return mix_extremes_; }
  // Forgets the states that no trajectory has used since the last call of this function.
  void forget_unused();
  // Number of ticks that the last call computed.
  std::size_t computed() const { return computed_; }

  const Body& body() const { return body_; }
  const Supply& supply() const { return supply_; }
  // The smoothing of targets: the impulse response of a critically damped oscillator, by tick. Its natural
  // frequency is that of the robot's mass on the stiffness of its ankles; a joint does not follow the corners
  // of its target faster. The response is shifted back by its mean delay, so that states belong to the ticks
  // that cause them.
  const std::vector<double>& response() const { return response_; }
  double natural_frequency_rad_per_s() const { return natural_rad_per_s_; }

 private:
  // A state by its window, with the last time at which it was used.
  struct Known {
    TickState state;
    std::uint64_t used = 0;
  };

  std::vector<std::uint64_t> windows(const Trajectory& trajectory) const;
  void smooth(const Trajectory& trajectory, std::size_t tick);
  TickState compute(const Trajectory& trajectory, std::size_t tick);
  void add_torques(const Stance& stance, TickState& state) const;

  const sim_board::RobotDescription& robot_;
  Supply supply_;
  Body body_;
  CollisionPairs pairs_;
  double natural_rad_per_s_ = 0.0;
  std::vector<double> response_;
  std::size_t shift_ = 0;             // of the response
  std::vector<double> stiffness_Nm_;  // by joint, per rad
  MixExtremes extremes_;

  std::unordered_map<std::uint64_t, Known> known_;  // by the hash of the window
  std::uint64_t time_ = 0;                          // number of calls of forget_unused
  std::vector<TickState> states_;                   // of the last trajectory
  std::vector<MixExtreme> mix_extremes_;
  std::size_t computed_ = 0;

  // Scratch.
  std::vector<double> smoothed_;   // rows of the present trajectory
  std::vector<bool> is_smoothed_;  // by tick
  std::vector<double> angles_, speeds_, accelerations_;
  Stance stance_;
  std::vector<Eigen::Isometry3d> X_BLs_;
};

}  // namespace koboshi::tools
