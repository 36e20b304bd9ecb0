#include "simulation/observe/walk_observer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim_board/board/sim_board.h"
#include "simulation/observe/posture.h"

namespace koboshi::simulation {
namespace {

constexpr double kTick_s = 1e-6 * static_cast<double>(sim_board::SimBoard::kTick_us);
// Delay from a tick to the time at which its targets take effect; they are reached one tick later
// (docs/design/timing.md). A tick computes targets for the end of its cycle, so at the k-th tick of a motion
// the drives follow the motion at k ticks minus this delay.
constexpr double kInEffect_s = 0.00265;
// Telemetry on the bus at a tick was computed one tick before.
constexpr double kTelemetryAge_s = kTick_s;

// Transforms a measured ZMP from its sole frame to that of another foot, in the plane of the latter.
Eigen::Vector2d in_sole_of(hal::Side side, const GroundTruth& truth, const Telemetry& said) {
  const Eigen::Isometry3d& X_WMeasured = truth.X_WSole[static_cast<std::size_t>(said.zmp.frame)];
  const Eigen::Isometry3d& X_WWanted = truth.X_WSole[static_cast<std::size_t>(side)];
  const Eigen::Vector3d p_W = X_WMeasured * Eigen::Vector3d(said.zmp.x_m, said.zmp.y_m, 0.0);
  return (X_WWanted.inverse() * p_W).head<2>();
}

}  // namespace

WalkObserver::WalkObserver(const sim_board::RobotDescription& robot, const Scenario& scenario, Plan plan,
                           std::optional<std::uint8_t> motion)
    : plan_(std::move(plan)), motion_(motion), sensor_check_(robot, scenario) {}

void WalkObserver::observe_sensors(const sim_board::SimBoard& board) {
  if (walking_) {
    sensor_check_.observe(board);
    energy_J_ += board.electronics().drawn_J() - drawn_J_;
  }
  drawn_J_ = board.electronics().drawn_J();
}

void WalkObserver::observe_tick(const GroundTruth& truth, const Telemetry& said) {
  const bool plays = said.state == behaviour::State::kWalking ||
                     (said.state == behaviour::State::kMotion && motion_ && said.motion == *motion_);
  const bool over = begun_ && !walking_;
  planned_.reset();
  walking_ = plays && !over && truth.tilt_rad < kFallen_rad;
  if (!walking_) return;
  if (!begun_) {
    begin(truth);
  } else {
    ++ticks_;
  }
  planned_ = plan_of(said);
  follow(truth);
  follow_steps(truth);
  judge_zmp(truth, said);
}

std::optional<WalkObserver::PlannedZmp> WalkObserver::plan_of(const Telemetry& said) const {
  if (said.state == behaviour::State::kMotion) {
    const GaitInstant instant = plan_(kTick_s * ticks_ - kInEffect_s);
    return PlannedZmp{instant.support, instant.zmp_S_m};
  }
  const Telemetry::Zmp& planned = said.planned_zmp;
  if (!planned.valid) return std::nullopt;
  return PlannedZmp{planned.frame, {planned.x_m, planned.y_m}};
}

void WalkObserver::begin(const GroundTruth& truth) {
  begun_ = true;
  start_W_m_ = truth.p_WB_W.head<2>();
  start_yaw_rad_ = truth.rpy_rad.z();
  yaw_rad_ = start_yaw_rad_;
}

void WalkObserver::follow(const GroundTruth& truth) {
  now_W_m_ = truth.p_WB_W.head<2>();
  yaw_rad_ += std::remainder(truth.rpy_rad.z() - yaw_rad_, 2.0 * std::numbers::pi);
  roll_rad_.add(truth.rpy_rad.x() * truth.rpy_rad.x());
}

// Detects steps: a step lasts from a foot's lift-off to its touchdown.
void WalkObserver::follow_steps(const GroundTruth& truth) {
  for (std::size_t side = 0; side < lift_m_.size(); ++side) {
    if (truth.foot_load_N[side] < sim_board::kLoaded_N) {
      lift_m_[side] = std::max(lift_m_[side], truth.foot_height_m[side]);
    } else if (lift_m_[side] > 0.0) {
      lifts_m_.push_back(lift_m_[side]);
      lift_m_[side] = 0.0;
    }
  }
}

void WalkObserver::judge_zmp(const GroundTruth& truth, const Telemetry& said) {
  if (truth.zmp_margin_m) margins_m_.push_back(*truth.zmp_margin_m);
  // The error at other lags needs the plan at other times, which is known of a gait's motion only.
  if (!said.zmp.valid || said.state != behaviour::State::kMotion) return;
  zmp_error_.add([&](double lag_s) {
    const GaitInstant planned = plan_(kTick_s * ticks_ - kInEffect_s - kTelemetryAge_s - lag_s);
    return (in_sole_of(planned.support, truth, said) - planned.zmp_S_m).squaredNorm();
  });
}

std::optional<Eigen::Vector3d> WalkObserver::planned_zmp_W(const GroundTruth& truth) const {
  if (!planned_) return std::nullopt;
  const Eigen::Isometry3d& X_WSole = truth.X_WSole[static_cast<std::size_t>(planned_->support)];
  return X_WSole * Eigen::Vector3d(planned_->zmp_S_m.x(), planned_->zmp_S_m.y(), 0.0);
}

Eigen::Vector3d WalkObserver::displacement() const {
  const Eigen::Vector2d moved_m = Eigen::Rotation2Dd(-start_yaw_rad_) * (now_W_m_ - start_W_m_);
  return {moved_m.x(), moved_m.y(), yaw_rad_ - start_yaw_rad_};
}

std::optional<WalkSummary> WalkObserver::summary() const {
  if (!begun_) return std::nullopt;
  const Eigen::Vector3d moved = displacement();
  WalkSummary summary;
  summary.distance_m = moved.x();
  summary.speed_m_per_s = ticks_ > 0 ? moved.x() / (kTick_s * ticks_) : 0.0;
  summary.lateral_drift_m = moved.y();
  summary.heading_drift_rad = moved.z();
  summary.energy_J = energy_J_;
  const ZmpAlignment::Best aligned = zmp_error_.best();
  summary.zmp_rms_error_m = aligned.rms_error_m;
  summary.zmp_lag_s = aligned.lag_s;
  summary.zmp_margin_p05_m = percentile(margins_m_, 0.05);
  summary.zmp_sensor_vs_truth_rms_m = sensor_check_.rms_m();
  summary.roll_rms_rad = roll_rad_.value();
  summary.foot_lift_m = percentile(lifts_m_, 0.5);
  return summary;
}

void WalkObserver::archive(sim_board::StateArchive& archive) {
  archive(begun_, walking_, ticks_, planned_, start_W_m_, start_yaw_rad_, now_W_m_, yaw_rad_, drawn_J_,
          energy_J_, zmp_error_, roll_rad_, margins_m_, lift_m_, lifts_m_, sensor_check_);
}

}  // namespace koboshi::simulation
