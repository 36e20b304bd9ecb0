#include "simulation/observe/run_recorder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/app/controller_objects.h"
#include "sim_board/world/options.h"
#include "simulation/scenario/parameters.h"

namespace koboshi::simulation {
namespace {

// Settling time after the stand's release, before the stance is evaluated.
constexpr std::uint64_t kSettle_us = 500'000;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
const Eigen::Vector3d kNowhere = Eigen::Vector3d::Constant(kNotANumber);

}  // namespace

RunRecorder::RunRecorder(Simulation& simulation, sim::Recorder* recorder, sim::BusObserver* listener)
    : simulation_(simulation),
      recorder_(recorder),
      listener_(listener),
      telemetry_(simulation.model().model),
      truth_(simulation.robot(), simulation.board().ground()),
      events_(simulation.scenario(), simulation.model(),
              controller_values(simulation.scenario()).velocity_limits) {
  if (const GaitPlan* plan = simulation.gait_plan()) {
    // The gait's motion follows those that the scenario names.
    const auto motion = static_cast<std::uint8_t>(simulation.scenario().motions.size());
    walk_.emplace(
        simulation.robot(), simulation.scenario(), [plan](double time_s) { return plan->at(time_s); },
        motion);
  } else {
    walk_.emplace(simulation.robot(), simulation.scenario());
  }
  truth_now_ = &truth_.observe(simulation.board().world(), telemetry_.now());
  row_.reserve(columns(simulation.robot()).size());
  simulation_.board().bus().set_observer(this);
  simulation_.attach(*this);
}

// Excludes the row of the trace, which does not outlast a tick.
void RunRecorder::archive(sim::StateArchive& archive) {
  if (recorder_ != nullptr)
    throw sim::NotSaveable(
        "a simulation that is recorded into files has no snapshots: what is written stays");
  archive(telemetry_, truth_, events_, walk_, truth_now_, hash_, fell_, base_height_error_m_, foot_slip_m_);
}

std::vector<sim::TraceColumn> RunRecorder::columns(const sim::RobotDescription& robot) {
  using enum sim::TraceKind;
  std::vector<sim::TraceColumn> columns{{"state", "", kInteger},
                                        {"reason", "", kInteger},
                                        {"state_name", "", kInteger, app::kStateNames},
                                        {"reason_name", "", kInteger, app::kReasonNames},
                                        {"drive_fault", "", kInteger},
                                        {"emergencies", "", kInteger},
                                        {"drive_enable", "", kInteger},
                                        {"imu_roll", "rad"},
                                        {"imu_pitch", "rad"},
                                        {"gyro_x", "rad_per_s"},
                                        {"gyro_y", "rad_per_s"},
                                        {"gyro_z", "rad_per_s"},
                                        {"left_load", "N"},
                                        {"right_load", "N"},
                                        {"true_base_x", "m"},
                                        {"true_base_y", "m"},
                                        {"true_base_z", "m"},
                                        {"pose_base_z", "m"},
                                        {"true_roll", "rad"},
                                        {"true_pitch", "rad"},
                                        {"true_yaw", "rad"},
                                        {"true_rate_x", "rad_per_s"},
                                        {"true_rate_y", "rad_per_s"},
                                        {"true_rate_z", "rad_per_s"},
                                        {"true_com_x", "m"},
                                        {"true_com_y", "m"},
                                        {"true_com_z", "m"},
                                        {"true_left_load", "N"},
                                        {"true_right_load", "N"},
                                        {"true_left_slip", "m"},
                                        {"true_right_slip", "m"},
                                        {"true_left_sole_x", "m"},
                                        {"true_left_sole_y", "m"},
                                        {"true_left_sole_yaw", "rad"},
                                        {"true_right_sole_x", "m"},
                                        {"true_right_sole_y", "m"},
                                        {"true_right_sole_yaw", "rad"},
                                        {"left_zmp_x", "m"},
                                        {"left_zmp_y", "m"},
                                        {"true_left_zmp_x", "m"},
                                        {"true_left_zmp_y", "m"},
                                        {"right_zmp_x", "m"},
                                        {"right_zmp_y", "m"},
                                        {"true_right_zmp_x", "m"},
                                        {"true_right_zmp_y", "m"},
                                        {"zmp_x", "m"},
                                        {"zmp_y", "m"},
                                        {"true_zmp_x", "m"},
                                        {"true_zmp_y", "m"},
                                        {"true_zmp_margin", "m"},
                                        {"planned_zmp_x", "m"},
                                        {"planned_zmp_y", "m"},
                                        {"com_x", "m"},
                                        {"com_y", "m"},
                                        {"com_z", "m"}};
  for (const sim::JointDescription& joint : robot.joints) {
    columns.push_back({joint.name + "_target", "rad"});
    columns.push_back({joint.name + "_encoder", "rad"});
    columns.push_back({joint.name + "_true", "rad"});
    columns.push_back({joint.name + "_torque", "permille"});
  }
  return columns;
}

void RunRecorder::on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) {
  telemetry_.on_bus_frame(frame, start_us, end_us);
  events_.on_bus_frame(frame, end_us, telemetry_.now());
  if (recorder_ != nullptr) recorder_->on_bus_frame(frame, start_us, end_us);
  hash_.add(end_us);
  hash_.add(frame.identifier);
  hash_.add(std::as_bytes(std::span(frame.data).first(frame.remote ? 0u : frame.size)));
  if (listener_ != nullptr) listener_->on_bus_frame(frame, start_us, end_us);
}

void RunRecorder::record() {
  if (walk_) walk_->observe_sensors(simulation_.board());
  if (simulation_.board().now_us() % sim::SimBoard::kTick_us == 0) record_tick();
}

void RunRecorder::record_tick() {
  truth_now_ = &truth_.observe(simulation_.board().world(), telemetry_.now());
  hash_state();
  judge();
  events_.observe_tick(simulation_.board().now_us(), telemetry_.now(), *truth_now_, simulation_.pushes());
  if (walk_) walk_->observe_tick(*truth_now_, telemetry_.now());
  if (recorder_ != nullptr) write_row();
}

void RunRecorder::hash_state() {
  const sim::World& world = simulation_.board().world();
  hash_.add(simulation_.board().now_us());
  hash_.add(static_cast<std::uint8_t>(simulation_.board().drive_enable_line()));
  for (std::size_t link = 0; link < simulation_.robot().links.size(); ++link) {
    const sim::BodyState body = world.body(static_cast<int>(link));
    for (const double value : body.X_WL.matrix().reshaped()) hash_.add(value);
    for (const double value : body.v_WCom_W) hash_.add(value);
    for (const double value : body.w_WL_W) hash_.add(value);
  }
}

void RunRecorder::judge() {
  fell_ = fell_ || truth_now_->tilt_rad > kFallen_rad;
  const auto state = telemetry_.now().state;
  const bool on_its_feet = behaviour::kBalancing.contains(state);
  const std::uint64_t release_us = simulation_.scenario().initial.release_us.value_or(0);
  if (!on_its_feet || simulation_.board().now_us() < release_us + kSettle_us) return;
  const double error_m = std::abs(truth_now_->p_WB_W.z() - truth_now_->pose_height_m);
  base_height_error_m_ = std::max(base_height_error_m_, error_m);
  for (const double slip_m : truth_now_->foot_slip_m) foot_slip_m_ = std::max(foot_slip_m_, slip_m);
}

void RunRecorder::write_row() {
  const Telemetry& said = telemetry_.now();
  const GroundTruth& truth = *truth_now_;
  row_.clear();
  const auto state = static_cast<std::uint8_t>(said.state);
  const auto reason = static_cast<std::uint8_t>(said.reason);
  row_.insert(row_.end(), {state, reason, state, reason, static_cast<std::uint8_t>(said.drive_fault),
                           said.emergencies, simulation_.board().drive_enable_line() ? 1 : 0});
  row_.insert(row_.end(), {said.roll_rad, said.pitch_rad});
  row_.insert(row_.end(), said.rate_rad_per_s.begin(), said.rate_rad_per_s.end());
  row_.insert(row_.end(), said.foot_load_N.begin(), said.foot_load_N.end());
  row_.insert(row_.end(), truth.p_WB_W.begin(), truth.p_WB_W.end());
  row_.push_back(truth.pose_height_m);
  row_.insert(row_.end(), truth.rpy_rad.begin(), truth.rpy_rad.end());
  row_.insert(row_.end(), truth.w_WB_W.begin(), truth.w_WB_W.end());
  row_.insert(row_.end(), truth.p_WCom_W.begin(), truth.p_WCom_W.end());
  row_.insert(row_.end(), truth.foot_load_N.begin(), truth.foot_load_N.end());
  row_.insert(row_.end(), truth.foot_slip_m.begin(), truth.foot_slip_m.end());
  add_feet_to_row();
  add_zmp_to_row();
  for (std::size_t joint = 0; joint < simulation_.robot().joints.size(); ++joint) {
    const Telemetry::Joint& drive = said.joints[joint];
    const double true_rad = simulation_.board().world().joint(static_cast<int>(joint)).position_rad;
    row_.insert(row_.end(), {drive.target_rad, drive.position_rad, true_rad, drive.torque_permille});
  }
  recorder_->row(simulation_.board().now_us(), row_);
}

void RunRecorder::add_feet_to_row() {
  for (const Eigen::Isometry3d& X_WSole : truth_now_->X_WSole) {
    row_.insert(row_.end(), {X_WSole.translation().x(), X_WSole.translation().y(),
                             std::atan2(X_WSole.linear()(1, 0), X_WSole.linear()(0, 0))});
  }
  for (std::size_t side = 0; side < truth_now_->foot_zmp_S_m.size(); ++side) {
    const Telemetry::FootZmp& said = telemetry_.now().foot_zmp[side];
    const Eigen::Vector2d true_S_m = truth_now_->foot_zmp_S_m[side].value_or(kNowhere.head<2>());
    row_.insert(row_.end(), {said.valid ? said.x_m : kNotANumber, said.valid ? said.y_m : kNotANumber,
                             true_S_m.x(), true_S_m.y()});
  }
}

// Writes the ZMPs in world coordinates, using the true pose of the sole in whose frame firmware and plan give
// them. They can then be overlaid on the footprints.
void RunRecorder::add_zmp_to_row() {
  const Telemetry& said = telemetry_.now();
  const Eigen::Isometry3d& X_WSole = truth_now_->X_WSole[static_cast<std::size_t>(said.zmp.frame)];
  const Eigen::Vector3d measured_W =
      said.zmp.valid ? Eigen::Vector3d(X_WSole * Eigen::Vector3d(said.zmp.x_m, said.zmp.y_m, 0.0)) : kNowhere;
  const Eigen::Vector3d true_W = truth_now_->p_WZmp_W.value_or(kNowhere);
  const Eigen::Vector3d planned_W = walk_ ? walk_->planned_zmp_W(*truth_now_).value_or(kNowhere) : kNowhere;
  const Eigen::Vector3d com_W =
      said.zmp.valid ? Eigen::Vector3d(X_WSole * Eigen::Vector3d(said.com_S_m.data())) : kNowhere;
  row_.insert(row_.end(), {measured_W.x(), measured_W.y(), true_W.x(), true_W.y(),
                           truth_now_->zmp_margin_m.value_or(kNotANumber), planned_W.x(), planned_W.y()});
  row_.insert(row_.end(), com_W.begin(), com_W.end());
}

sim::RunSummary RunRecorder::summary() const {
  const sim::SimBoard& board = simulation_.board();
  sim::RunSummary summary;
  summary.fell = fell_;
  summary.verdict = events_.verdict(board.watchdog_bitten());
  summary.falls = events_.falls();
  summary.stands = events_.stands();
  summary.events = events_.events(board.watchdog_bitten());
  summary.duration_s = 1e-6 * static_cast<double>(board.now_us());
  summary.can_bus_load = sim::bus_load({}, board.bus().usage());
  summary.state_hash = hash_.hex();
  // A controller that is not error active counts as a fault of its own: it may be unable to report it.
  const bool mute = board.controller_can_status().state != hal::CanErrorState::kErrorActive;
  summary.faults = telemetry_.now().emergencies + (mute ? 1 : 0) + (board.watchdog_bitten() ? 1 : 0);
  summary.solver_warnings = board.world().solver_warnings();
  summary.stepper = sim::name_of(simulation_.scenario().physics.stepper);
  summary.base_height_error_max_m = base_height_error_m_;
  summary.foot_slip_max_m = foot_slip_m_;
  if (walk_) summary.walk = walk_->summary();
  return summary;
}

}  // namespace koboshi::simulation
