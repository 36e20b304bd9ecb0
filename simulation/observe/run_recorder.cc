#include "simulation/observe/run_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "base/text/user_units.h"
#include "sim_board/world/options.h"
#include "simulation/assembly/parameters.h"
#include "simulation/model/abilities.h"
#include "simulation/observe/posture.h"

namespace koboshi::simulation {
namespace {

// Settling time after the stand's release, before the stance is evaluated.
constexpr std::uint64_t kSettle_us = 500'000;

const Eigen::Vector3d kNowhere = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

// Returns the elements in column-major order.
template <typename Matrix>
std::span<const double> numbers_of(const Matrix& matrix) {
  static_assert(!Matrix::IsRowMajor || Matrix::IsVectorAtCompileTime);
  return {matrix.data(), static_cast<std::size_t>(matrix.size())};
}

}  // namespace

RunRecorder::RunRecorder(Simulation& simulation, Recorder* recorder, sim_board::BusObserver* listener,
                         Rows rows)
    : simulation_(simulation),
      recorder_(recorder),
      listener_(listener),
      telemetry_(simulation.model().model),
      truth_(simulation.robot(), simulation.board().ground()),
      events_(simulation.scenario(), simulation.model(),
              controller_values(simulation.scenario()).velocity_limits),
      self_contacts_(simulation.robot()) {
  if (simulation.world() != nullptr) events_.add_world(*simulation.world(), simulation.robot());
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
  make_rows(rows == Rows::kAlways);
  simulation_.board().electronics().bus().set_observer(this);
  simulation_.attach(*this);
}

// Excludes the row of the trace, which does not outlast a tick.
void RunRecorder::archive(sim_board::StateArchive& archive) {
  if (recorder_ != nullptr)
    throw sim_board::NotSaveable(
        "a simulation that is recorded into files has no snapshots: what is written stays");
  archive(telemetry_, truth_, events_, self_contacts_, walk_, truth_now_, hash_, fell_, base_height_error_m_,
          foot_slip_m_);
}

std::vector<TraceColumn> RunRecorder::columns(const sim_board::RobotDescription& robot) {
  std::vector<TraceColumn> columns;
  for (const TraceFields& fields : trace_fields(robot))
    columns.insert(columns.end(), fields.columns.begin(), fields.columns.end());
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

void RunRecorder::make_rows(bool make) {
  row_.clear();
  trace_.clear();
  if (recorder_ == nullptr && !make) return;
  trace_ = trace_fields(simulation_.robot());
  std::size_t columns = 0;
  for (const TraceFields& fields : trace_) columns += fields.columns.size();
  row_.reserve(columns);
}

void RunRecorder::record() {
  if (walk_) walk_->observe_sensors(simulation_.board());
  if (simulation_.board().now_us() % sim_board::SimBoard::kTick_us == 0) record_tick();
}

void RunRecorder::record_tick() {
  truth_now_ = &truth_.observe(simulation_.board().world(), telemetry_.now());
  hash_state();
  judge();
  events_.observe_tick(simulation_.board().now_us(), telemetry_.now(), *truth_now_, simulation_.pushes());
  watch_self_contacts();
  if (walk_) walk_->observe_tick(*truth_now_, telemetry_.now());
  if (!trace_.empty()) make_row();
}

void RunRecorder::hash_state() {
  const sim_board::World& world = simulation_.board().world();
  hash_.add(simulation_.board().now_us());
  hash_.add(static_cast<std::uint8_t>(simulation_.board().electronics().drive_enable_line()));
  for (std::size_t link = 0; link < simulation_.robot().links.size(); ++link) {
    const sim_board::BodyState body = world.body(static_cast<int>(link));
    hash_.add(numbers_of(body.X_WL.matrix()));
    hash_.add(numbers_of(body.v_WCom_W));
    hash_.add(numbers_of(body.w_WL_W));
  }
}

void RunRecorder::judge() {
  fell_ = fell_ || truth_now_->tilt_rad > kFallen_rad;
  const auto state = telemetry_.now().state;
  const bool on_its_feet = behaviour::kBalancing.contains(state);
  const std::uint64_t release_us = simulation_.scenario().initial.release_us.value_or(0);
  if (!on_its_feet || simulation_.board().now_us() < release_us + kSettle_us) return;
  const double error_m = std::abs(truth_now_->height_m - truth_now_->pose_height_m);
  base_height_error_m_ = std::max(base_height_error_m_, error_m);
  for (const double slip_m : truth_now_->foot_slip_m) foot_slip_m_ = std::max(foot_slip_m_, slip_m);
}

void RunRecorder::watch_self_contacts() {
  const Telemetry& told = telemetry_.now();
  const bool is_upright_by_command =
      told.state == behaviour::State::kSoftStart || behaviour::kOnItsFeet.contains(told.state);
  if (!is_upright_by_command || truth_now_->tilt_rad > kUpAgain_rad) return;
  const auto contact = self_contacts_.observe(simulation_.board().world(), told);
  if (!contact) return;
  const sim_board::RobotDescription& robot = simulation_.robot();
  const std::string& link = robot.links[static_cast<std::size_t>(contact->link)].name;
  const std::string& other = robot.links[static_cast<std::size_t>(contact->other_link)].name;
  const std::string& joint = robot.joints[static_cast<std::size_t>(contact->joint)].name;
  const double error_deg = kDegreesPerRad * contact->following_error_rad;
  events_.add(simulation_.board().now_us(), "self_contact",
              fmt::format("{} and {} touch each other; {} is {:.1f} degrees from its target.", link, other,
                          joint, std::abs(error_deg)),
              {{"links", {link, other}},
               {"joint", joint},
               {"following_error_deg", std::round(10.0 * error_deg) / 10.0}});
  events_.remark(link + " and " + other + " touch each other");
}

// Firmware and gait report points in the frame of a sole: the row has them where that sole stands.
void RunRecorder::make_row() {
  const Telemetry& told = telemetry_.now();
  const Eigen::Isometry3d& X_WSole = truth_now_->X_WSole[static_cast<std::size_t>(told.zmp.frame)];
  TraceSample sample{told, *truth_now_, simulation_.board(), kNowhere, kNowhere, kNowhere};
  if (told.zmp.valid) sample.zmp_W = X_WSole * Eigen::Vector3d(told.zmp.x_m, told.zmp.y_m, 0.0);
  // A robot that never has a valid ZMP knows its centre of mass all the same.
  if (told.zmp.valid || !simulation_.model().model.measures_loads())
    sample.com_W = X_WSole * Eigen::Vector3d(told.com_S_m.data());
  if (walk_) sample.planned_zmp_W = walk_->planned_zmp_W(*truth_now_).value_or(kNowhere);
  row_.clear();
  for (const TraceFields& fields : trace_) fields.append(sample, row_);
  if (recorder_ != nullptr) recorder_->row(simulation_.board().now_us(), row_);
}

RunSummary RunRecorder::summary() const {
  const sim_board::SimBoard& board = simulation_.board();
  RunSummary summary;
  summary.fell = fell_;
  summary.verdict = events_.verdict(board.electronics().watchdog_bitten());
  summary.falls = events_.falls();
  summary.stands = events_.stands();
  summary.events = events_.events(board.electronics().watchdog_bitten());
  summary.duration_s = 1e-6 * static_cast<double>(board.now_us());
  summary.can_bus_load = sim_board::bus_load({}, board.electronics().bus().usage());
  summary.state_hash = hash_.hex();
  // A controller that is not error active counts as a fault of its own: it may be unable to report it.
  const bool mute = board.electronics().controller_can_status().state != hal::CanErrorState::kErrorActive;
  summary.faults =
      telemetry_.now().emergencies + (mute ? 1 : 0) + (board.electronics().watchdog_bitten() ? 1 : 0);
  summary.solver_warnings = board.world().solver_warnings();
  summary.stepper = sim_board::name_of(simulation_.scenario().physics.stepper);
  summary.base_height_error_max_m = base_height_error_m_;
  summary.foot_slip_max_m = foot_slip_m_;
  for (const LostAbility& lost : find_lost_abilities(simulation_.model().model))
    summary.lost_abilities.push_back(lost.name);
  for (const std::string& motion : simulation_.scenario().missing_motions)
    summary.lost_abilities.push_back(motion);
  if (const std::string& missing = simulation_.scenario().missing_parameter_file; !missing.empty())
    summary.lost_abilities.push_back(missing);
  if (walk_) summary.walk = walk_->summary();
  return summary;
}

}  // namespace koboshi::simulation
