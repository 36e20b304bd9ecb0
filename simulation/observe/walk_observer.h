#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "simulation/gait/gait_plan.h"
#include "simulation/observe/ground_truth.h"
#include "simulation/observe/statistics.h"
#include "simulation/observe/telemetry.h"
#include "simulation/observe/zmp_alignment.h"
#include "simulation/observe/zmp_sensor_check.h"
#include "simulation/record/summary.h"

namespace koboshi::simulation {

// Evaluates a walk for summary.json (docs/reference/summary.md). The walk begins with the first tick whose
// telemetry reports walking, by the gait's motion or by command. It ends when the telemetry no longer does,
// when the robot falls, or with the run.
class WalkObserver {
 public:
  // Reference of the walk as a function of the time since its motion began (GaitPlan::at).
  using Plan = std::function<GaitInstant(double time_s)>;

  // `motion` is the controller's index of the gait's motion; without it, only walks by command are evaluated.
  // The robot must outlive the observer.
  WalkObserver(const sim_board::RobotDescription& robot, const Scenario& scenario, Plan plan = {},
               std::optional<std::uint8_t> motion = {});

  // Observes the ankle sensors; call it after each millisecond of the board.
  void observe_sensors(const sim_board::SimBoard& board);
  // Observes a tick; call it after each tick.
  void observe_tick(const GroundTruth& truth, const Telemetry& said);

  // Planned ZMP of the last tick, by the gait's motion or by the controller, placed at the true pose of the
  // foot in whose frame it is planned. Empty unless the robot walks.
  std::optional<Eigen::Vector3d> planned_zmp_W(const GroundTruth& truth) const;
  // Displacement since the start of the walk: forward and left of the initial heading [m], and turn [rad].
  // Zero before the walk.
  Eigen::Vector3d displacement() const;
  // Empty before the walk begins.
  std::optional<WalkSummary> summary() const;

  void archive(sim_board::StateArchive& archive);

 private:
  struct PlannedZmp {
    hal::Side support = hal::Side::kLeft;
    Eigen::Vector2d zmp_S_m = Eigen::Vector2d::Zero();  // in the sole frame of the support foot
  };

  std::optional<PlannedZmp> plan_of(const Telemetry& said) const;
  void begin(const GroundTruth& truth);
  void follow(const GroundTruth& truth);
  void follow_steps(const GroundTruth& truth);
  void judge_zmp(const GroundTruth& truth, const Telemetry& said);

  Plan plan_;
  std::optional<std::uint8_t> motion_;
  bool begun_ = false;
  bool walking_ = false;
  int ticks_ = 0;  // since the first tick
  std::optional<PlannedZmp> planned_;
  Eigen::Vector2d start_W_m_ = Eigen::Vector2d::Zero();
  double start_yaw_rad_ = 0.0;
  Eigen::Vector2d now_W_m_ = Eigen::Vector2d::Zero();
  double yaw_rad_ = 0.0;  // unwrapped
  double drawn_J_ = 0.0;  // SimBoard::drawn_J at the start
  double energy_J_ = 0.0;
  ZmpAlignment zmp_error_;
  RootMeanSquare roll_rad_;
  std::vector<double> margins_m_;
  std::array<double, 2> lift_m_{};  // of the present step, by Side
  std::vector<double> lifts_m_;     // of the completed steps
  ZmpSensorCheck sensor_check_;
};

}  // namespace koboshi::simulation
