#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "sim_board/record/summary.h"
#include "simulation/gait/gait_plan.h"
#include "simulation/observe/ground_truth.h"
#include "simulation/observe/statistics.h"
#include "simulation/observe/telemetry.h"
#include "simulation/observe/zmp_alignment.h"
#include "simulation/observe/zmp_sensor_check.h"

namespace koboshi::simulation {

// Judges a walk: what summary.json says of it (docs/reference/summary.md). The walk begins with the first
// tick whose telemetry tells that the robot walks, on the gait's motion or by command, and ends when it no
// longer does, when the robot has fallen, or with the run.
class WalkObserver {
 public:
  // What the walk intends, by the time since its motion began (GaitPlan::at).
  using Plan = std::function<GaitInstant(double time_s)>;

  // `motion` is the number by which the controller knows the gait of the plan; without one, the robot walks
  // by command only. The robot must outlive the observer.
  WalkObserver(const sim::RobotDescription& robot, const sim::Scenario& scenario, Plan plan = {},
               std::optional<std::uint8_t> motion = {});

  // After each millisecond of the board.
  void observe_sensors(const sim::SimBoard& board);
  // After each tick, with what was observed then.
  void observe_tick(const GroundTruth& truth, const Telemetry& said);

  // The ZMP that the walk intended for the last tick, where the foot stands in whose frame it is planned;
  // nothing unless the robot walks.
  std::optional<Eigen::Vector3d> planned_zmp_W(const GroundTruth& truth) const;
  // How far the walk has come: ahead and to the left of the heading at its start [m], and turned [rad]; zero
  // before.
  Eigen::Vector3d made_good() const;
  // Nothing before the walk has begun.
  std::optional<sim::WalkSummary> summary() const;

  void archive(sim::StateArchive& archive) {
    archive(begun_, walking_, ticks_, planned_, start_W_m_, start_yaw_rad_, now_W_m_, yaw_rad_, drawn_J_,
            energy_J_, zmp_error_, roll_rad_, margins_m_, lift_m_, lifts_m_, sensor_check_);
  }

 private:
  void begin(const GroundTruth& truth);
  void follow(const GroundTruth& truth);
  void follow_steps(const GroundTruth& truth);
  void judge_zmp(const GroundTruth& truth, const Telemetry& said);

  Plan plan_;
  std::optional<std::uint8_t> motion_;
  bool begun_ = false;
  bool walking_ = false;
  int ticks_ = 0;  // since the first
  std::optional<GaitInstant> planned_;
  Eigen::Vector2d start_W_m_ = Eigen::Vector2d::Zero();
  double start_yaw_rad_ = 0.0;
  Eigen::Vector2d now_W_m_ = Eigen::Vector2d::Zero();
  double yaw_rad_ = 0.0;  // continuous
  double drawn_J_ = 0.0;  // as SimBoard::drawn_J
  double energy_J_ = 0.0;
  ZmpAlignment zmp_error_;
  RootMeanSquare roll_rad_;
  std::vector<double> margins_m_;
  std::array<double, 2> lift_m_{};  // of the step under way, by Side
  std::vector<double> lifts_m_;     // of the steps that ended
  ZmpSensorCheck sensor_check_;
};

}  // namespace koboshi::simulation
