#include "simulation/joint_level/joint_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "firmware/fixed/host/convert.h"
#include "simulation/assembly/board_without_controller.h"
#include "simulation/assembly/plant.h"
#include "simulation/assembly/world.h"
#include "simulation/scenario/reader.h"

namespace koboshi::simulation {
namespace {

// From power-on to enabled drives: the time-outs of DriveGroup, and a reserve. A robot that takes longer has
// a fault.
constexpr std::uint64_t kBootLimit_us =
    2 * drive::DriveGroup::kBootTimeout_us + drive::DriveGroup::kEnableTimeout_us;

const char* text_of(drive::DriveFault fault) {
  switch (fault) {
    case drive::DriveFault::kNone:
      return "has no fault";
    case drive::DriveFault::kSilent:
      return "did not boot up";
    case drive::DriveFault::kNoAnswer:
      return "did not answer an SDO request";
    case drive::DriveFault::kRefused:
      return "refused an SDO request";
    case drive::DriveFault::kWrongIdentity:
      return "is not the one that the robot's file names";
    case drive::DriveFault::kLost:
      return "was lost";
    case drive::DriveFault::kRestarted:
      return "has restarted";
    case drive::DriveFault::kFault:
      return "reports a fault";
    case drive::DriveFault::kNotEnabled:
      return "is not in operation enabled";
    case drive::DriveFault::kNotFollowing:
      return "does not follow its targets";
  }
  return "has an unknown fault";
}

void check_size(std::size_t found, std::size_t expected) {
  if (found != expected)
    throw std::invalid_argument(
        fmt::format("found {} numbers, expected {}, one for each joint", found, expected));
}

std::vector<ObservationField> fields_of(const sim_board::RobotDescription& robot) {
  std::vector<ObservationField> fields;
  std::size_t first = 0;
  const auto add = [&](const char* name, std::size_t size, const char* meaning) {
    fields.push_back({name, first, size, meaning});
    first += size;
  };
  const std::size_t joints = robot.joints.size();
  add("joint_position_rad", joints, "positions from the encoders, as of the last answer of each drive");
  add("joint_torque_share", joints, "torques as estimated by the drives, as shares of their rated torques");
  add("gyro_rad_per_s", 3, "mean of the gyro's samples in the last step, in the frame of the inertial unit");
  add("accelerometer_m_per_s2", 3, "mean of the accelerometer's samples in the last step, likewise");
  add("foot_left", 6,
      "latest sample of the left foot's sensor: N and N m in its frame; of a switch, 0 or 1 in the third");
  add("foot_right", 6, "the same of the right foot");
  add("supply_V", 1, "lowest of the drives' last readings of their supply");
  add("enabled", 1, "1 while all drives follow their targets");
  return fields;
}

}  // namespace

std::shared_ptr<const JointScenario> prepare_joint_level(const Scenario& scenario) {
  check_without_controller(scenario);
  auto prepared = std::make_shared<JointScenario>();
  prepared->scenario = scenario;
  prepared->robot = read_robot(scenario);
  prepared->robot_in_world = robot_in_world(scenario);
  prepared->model = load_named_model(prepared->robot);
  return prepared;
}

JointRobot::Power::Power(const JointScenario& prepared, const Scenario& scenario)
    : master(prepared.model.model, storage), robot(prepared.robot_in_world) {
  Scenario in_world = scenario;
  world = draw_world(scenario, robot);
  if (world) {
    apply(*world, robot);
    apply(*world, in_world);
  }
  board = make_board(in_world, robot, board_options(in_world, robot), *this);
  player = std::make_unique<ScenarioPlayer>(scenario, *board);
  board->gather();
  master.gather(board->electronics().last_input());
}

JointRobot::JointRobot(std::shared_ptr<const JointScenario> prepared, std::uint64_t seed)
    : prepared_(std::move(prepared)), scenario_(prepared_->scenario), fields_(fields_of(prepared_->robot)) {
  scenario_.seed = seed;
  power_on();
}

void JointRobot::reset(std::uint64_t seed, std::uint64_t until_us) {
  power_.reset();
  scenario_.seed = seed;
  run_ = std::make_shared<Run>(*run_);
  power_on();
  while (now_us() < until_us) step(hal::kControlPeriod_us / hal::kServicePeriod_us);
}

void JointRobot::power_on() {
  power_ = std::make_unique<Power>(*prepared_, scenario_);
  while (!enabled() && !power_->master.fault() && now_us() < kBootLimit_us) advance();
  while (now_us() % sim_board::SimBoard::kTick_us != 0) advance();
  if (!enabled())
    throw std::runtime_error(power_->master.fault() ? fault() : "the drives did not enable in time");
  power_->master.forget_samples();
}

void JointRobot::advance() {
  power_->player->act();
  power_->board->complete();
  power_->board->gather();
  power_->master.gather(power_->board->electronics().last_input());
}

void JointRobot::step(std::size_t milliseconds) {
  power_->master.forget_samples();
  for (std::size_t i = 0; i < milliseconds; ++i) advance();
}

void JointRobot::set_targets(std::span<const double> targets_rad) {
  const auto& joints = robot().joints;
  check_size(targets_rad.size(), joints.size());
  std::array<fixed::Angle, robot::kMaxJoints> targets;
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    if (!std::isfinite(targets_rad[joint]))
      throw std::invalid_argument(
          fmt::format("found {} for {}, expected an angle in rad", targets_rad[joint], joints[joint].name));
    // Within the joint's limits first: beyond half a turn an angle would wrap around.
    targets[joint] = fixed::from_double<fixed::Angle>(
        std::clamp(targets_rad[joint], joints[joint].lower_rad, joints[joint].upper_rad));
  }
  power_->master.set_targets(std::span(targets).first(joints.size()));
}

void JointRobot::limit_torques(std::span<const double> shares) {
  const auto& joints = robot().joints;
  check_size(shares.size(), joints.size());
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    if (!(shares[joint] >= 0.0 && shares[joint] <= 1.0))
      throw std::invalid_argument(
          fmt::format("found {} for {}, expected a share of the rated torque from 0 to 1", shares[joint],
                      joints[joint].name));
  }
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    power_->master.set_torque_limit(
        joint, static_cast<std::uint16_t>(std::lround(drive::Setting::kOwn_permille * shares[joint])));
  }
}

std::size_t JointRobot::observation_size() const { return fields_.back().first + fields_.back().size; }

void JointRobot::observe(std::span<double> to) const {
  if (to.size() != observation_size()) throw std::invalid_argument("a row of observations has another size");
  const JointMaster& master = power_->master;
  const sim_board::RobotDescription& robot = prepared_->robot;
  auto place = to.begin();
  for (std::size_t joint = 0; joint < robot.joints.size(); ++joint)
    *place++ = fixed::to_double(master.angle(joint));
  for (std::size_t joint = 0; joint < robot.joints.size(); ++joint)
    *place++ = 1e-3 * master.torque_permille(joint);
  std::array<double, 6> sums{};
  const auto samples = imu_samples();
  for (const auto& sample : samples) {
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += sample[i];
  }
  for (const double sum : sums) *place++ = samples.empty() ? 0.0 : sum / static_cast<double>(samples.size());
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    const auto& ankle = side == hal::Side::kLeft ? robot.left_ankle : robot.right_ankle;
    const hal::AnkleSample& sample = master.ankle(side);
    const bool counts = ankle && ankle->kind == hal::AnkleKind::kContactSwitch;
    const double force = counts ? 1.0 : ankle ? ankle->force.resolution : 0.0;
    // The fourth cell's force is in the place of a torque.
    const double torque = !ankle                                          ? 0.0
                          : ankle->kind == hal::AnkleKind::kPressureCells ? ankle->force.resolution
                                                                          : ankle->torque.resolution;
    for (const std::int16_t raw : sample.force_raw) *place++ = force * raw;
    for (const std::int16_t raw : sample.torque_raw) *place++ = torque * raw;
  }
  *place++ = 1e-3 * master.supply_mV();
  *place++ = enabled() ? 1.0 : 0.0;
}

std::vector<std::array<double, 6>> JointRobot::imu_samples() const {
  std::vector<std::array<double, 6>> rows;
  if (!prepared_->robot.imu) return rows;
  const sim_board::ImuDescription& imu = *prepared_->robot.imu;
  for (const hal::ImuSample& sample : power_->master.imu_samples()) {
    auto& row = rows.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      row[axis] = imu.gyro.resolution * sample.gyro_raw[axis];
      row[3 + axis] = imu.accelerometer.resolution * sample.accelerometer_raw[axis];
    }
  }
  return rows;
}

std::string JointRobot::fault() const {
  const drive::JointFault& fault = power_->master.fault();
  if (!fault) return {};
  std::string text = fmt::format("the drive of {} {}", robot().joints[fault.joint].name, text_of(fault.kind));
  if (fault.error_code != 0) text += fmt::format(" (error code {:04X})", fault.error_code);
  return text;
}

double JointRobot::tilt_rad() const {
  return std::acos(std::clamp(board().world().body(0).X_WL.linear()(2, 2), -1.0, 1.0));
}

GroundTruth JointRobot::truth() const {
  TruthObserver observer(robot(), board().ground());
  return observer.observe(board().world(), Telemetry());
}

JointRobot::Saved JointRobot::save() {
  return {run_, sim_board::StateArchive::save(*power_->board, *power_->player)};
}

void JointRobot::restore(const Saved& saved) {
  if (saved.run->robot != run_->robot)
    throw std::logic_error("found a snapshot of another robot, expected one that this robot has made");
  if (saved.run != run_)
    throw std::logic_error(
        "found a snapshot from before the last reset of this robot, expected one from after it");
  sim_board::StateArchive::restore(saved.state, *power_->board, *power_->player);
}

}  // namespace koboshi::simulation
