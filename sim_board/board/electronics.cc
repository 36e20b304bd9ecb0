#include "sim_board/board/electronics.h"

#include <algorithm>
#include <cmath>

#include "firmware/canopen/frame.h"
#include "sim_board/drive/pc_sdo.h"

namespace koboshi::sim_board {
namespace {

constexpr std::size_t kOperatorFifo = 64;

// The operator's PC hears the answers to its requests, and the commands of other operators.
AcceptanceFilter operators_frames() {
  AcceptanceFilter filter{kCommandIdentifier, kVelocityIdentifier};
  filter.accept_range(canopen::kSdoResponseBase + 1, canopen::kSdoResponseBase + 127);
  for (const PcSdoRange& range : kPcSdoRanges)
    filter.accept_range(pc_sdo_response(range.first_node),
                        pc_sdo_response(range.first_node + kPcSdoNodes - 1));
  return filter;
}

}  // namespace

void Electronics::Receiver::on_frame(const hal::CanFrame& frame, std::uint64_t) {
  if (input_.frames.push(frame)) return;
  std::uint16_t& overruns = input_.can_status.receive_overruns;
  if (overruns < 0xFFFF) ++overruns;
}

Electronics::Electronics(const RobotDescription& robot, const BoardOptions& options, World& world,
                         ControllerHost& host, TimeShares& shares)
    : robot_(robot),
      options_(options),
      world_(world),
      host_(host),
      shares_(shares),
      tick_clock_(kTick_us, kService_us, options.tick_jitter_us, options.seed),
      controller_(bus_.attach(receiver_, AcceptanceFilter::all(), kTransmitFifo)),
      operator_(bus_.attach(operator_node_, operators_frames(), kOperatorFifo)),
      bus_faults_(options.seed) {
  const SensorErrors errors{.seed = options.seed, .scale = options.noise_scale};
  const ServoOptions servo_options{
      .step_s = world_.step_s(), .seed = options.seed, .noise_scale = options.noise_scale};
  if (robot.battery) battery_.emplace(*robot.battery);
  for (const JointDescription& joint : robot.joints) {
    drives_.push_back(std::make_unique<Drive>(joint, bus_, servo_options));
    drives_.back()->power_on(now_us_);
  }
  loads_.resize(drives_.size());
  if (robot.imu) {
    const LinkDescription& link = robot.links[static_cast<std::size_t>(robot.imu->link)];
    imu_.emplace(*robot.imu, link, options.world.gravity_W_m_per_s2, errors);
  }
  if (robot.left_ankle) ankles_[0].emplace(*robot.left_ankle, robot, errors);
  if (robot.right_ankle) ankles_[1].emplace(*robot.right_ankle, robot, errors);
  if (options.sensors_on_bus) attach_sensor_nodes();
  sample(0);
}

void Electronics::gather() {
  advance_bus();
  update_drives();
  collect_samples();
  update_sensor_nodes();
  if (!controller_stopped_) complete_input();
}

void Electronics::respond() {
  if (!controller_stopped_) serve_controller();
  watch_dog();
}

void Electronics::advance_bus() {
  const Stopwatch watch(shares_.bus_s, now_us_);
  for (const auto& babbler : babblers_) babbler->advance(now_us_);
  bus_.advance_to(now_us_);
}

void Electronics::update_drives() {
  const Stopwatch watch(shares_.drives_s, now_us_);
  for (std::size_t joint = 0; joint < drives_.size(); ++joint) {
    const int number = static_cast<int>(joint);
    drives_[joint]->set_enable_line(enable_line_);
    drives_[joint]->update(world_.joint(number), now_us_);
  }
}

void Electronics::drive_servos() {
  const Stopwatch watch(shares_.drives_s, now_us_);
  SupplyLoad load;
  for (std::size_t joint = 0; joint < drives_.size(); ++joint) {
    loads_[joint] = drives_[joint]->draw(world_.joint(static_cast<int>(joint)));
    load += loads_[joint];
  }
  const double step_s = world_.step_s();
  if (discharge_) battery_->set_open_circuit_V(open_circuit_V());
  const double battery_V = battery_ ? battery_->voltage_V(load) : 0.0;
  for (std::size_t joint = 0; joint < drives_.size(); ++joint) {
    const double whole_V = battery_ ? battery_V : robot_.joints[joint].servo.supply_V;
    const double supply_V = std::min(whole_V, highest_supply_V_.value_or(whole_V));
    drawn_J_ += step_s * supply_V * loads_[joint].current_A(supply_V);
    world_.set_servo(static_cast<int>(joint), drives_[joint]->torque(supply_V));
  }
}

void Electronics::discharge_battery(double open_circuit_V, std::uint64_t over_us) {
  discharge_ = Discharge{this->open_circuit_V(), open_circuit_V, now_us_, over_us};
}

double Electronics::open_circuit_V() const {
  if (!discharge_) return battery_->open_circuit_V();
  const std::uint64_t elapsed_us = now_us_ - discharge_->from_us;
  if (elapsed_us >= discharge_->over_us) return discharge_->to_V;
  const double share = static_cast<double>(elapsed_us) / static_cast<double>(discharge_->over_us);
  return std::lerp(discharge_->from_V, discharge_->to_V, share);
}

void Electronics::collect_samples() {
  hal::ImuSample sample;
  while (imu_ && imu_->poll(now_us_, sample)) take(sample);
  hal::AnkleSample ankle;
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    auto& sensor = ankles_[static_cast<std::size_t>(side)];
    while (sensor && sensor->poll(now_us_, ankle)) take(side, ankle);
  }
}

void Electronics::take(const hal::ImuSample& sample) {
  if (imu_node_) return imu_node_->take(sample);
  if (!input_.imu.push(sample) && input_.imu_overruns < 0xFFFF) ++input_.imu_overruns;
}

void Electronics::take(hal::Side side, const hal::AnkleSample& sample) {
  const auto number = static_cast<std::size_t>(side);
  if (ankle_nodes_[number]) return ankle_nodes_[number]->take(sample);
  input_.ankles[number] = sample;
  input_.ankle_fresh[number] = true;
}

void Electronics::attach_sensor_nodes() {
  if (imu_) imu_node_ = std::make_unique<SensorNode>(SensorKind::kInertial, kInertialNode, bus_);
  for (std::size_t side = 0; side < ankles_.size(); ++side) {
    if (ankles_[side])
      ankle_nodes_[side] =
          std::make_unique<SensorNode>(sensor_kind(ankles_[side]->kind()), kAnkleNodes[side], bus_);
  }
}

void Electronics::update_sensor_nodes() {
  if (imu_node_) imu_node_->update(now_us_);
  for (const auto& node : ankle_nodes_) {
    if (node) node->update(now_us_);
  }
}

void Electronics::complete_input() {
  input_.now_us = now_us_;
  input_.tick = tick_clock_.due(now_us_);
  const std::uint16_t receive_overruns = input_.can_status.receive_overruns;
  input_.can_status = bus_.status(controller_);
  input_.can_status.receive_overruns = receive_overruns;
  for (const hal::TransmitFifo fifo : {hal::kProcessFifo, hal::kAnswerFifo, hal::kBackgroundFifo}) {
    input_.transmit_space[fifo] = static_cast<std::uint16_t>(bus_.transmit_space(controller_, fifo));
    input_.transmit_pending[fifo] = bus_.transmit_pending(controller_, fifo);
  }
}

void Electronics::serve_controller() {
  {
    const Stopwatch watch(shares_.firmware_s, now_us_);
    host_.exchange(input_, output_);
  }
  input_.frames.clear();
  input_.imu.clear();
  input_.ankle_fresh = {};

  const std::uint64_t ready_us =
      now_us_ + (input_.tick ? tick_clock_.late_us() + options_.computing_time_us : options_.service_time_us);
  // The ports have refused all frames that would not fit.
  for (const hal::CanFrame& frame : output_.frames.view()) {
    static_cast<void>(bus_.queue(controller_, frame, ready_us));
  }
  if (output_.recover) bus_.recover(controller_);
  if (output_.watchdog_kicked) kicked_us_ = now_us_;
  enable_line_ = output_.drive_enabled && !bitten_;
}

void Electronics::watch_dog() {
  if (now_us_ - kicked_us_ < kWatchdog_us) return;
  bitten_ = true;
  enable_line_ = false;
}

void Electronics::sample(std::uint64_t now_us) {
  now_us_ = now_us;
  const Stopwatch watch(shares_.sensors_s, now_us_);
  if (imu_) imu_->step(world_, now_us_);
  for (auto& ankle : ankles_) {
    if (ankle) ankle->step(world_, now_us_);
  }
}

void Electronics::set_imu_running(bool running) {
  if (imu_) imu_->set_running(running);
}

void Electronics::set_ankle_running(hal::Side side, bool running) {
  auto& ankle = ankles_[static_cast<std::size_t>(side)];
  if (ankle) ankle->set_running(running);
}

void Electronics::add_frame_fault(const FrameFault& fault) {
  bus_faults_.add(fault);
  bus_.set_disturbance(&bus_faults_);
}

std::vector<BusMember> Electronics::bus_members() const {
  std::vector<BusMember> members{{kControllerNode, controller_}};
  for (std::size_t i = 0; i < drives_.size(); ++i)
    members.push_back({robot_.joints[i].drive.node_id, drives_[i]->bus_handle()});
  if (imu_node_) members.push_back({kInertialNode, imu_node_->bus_handle()});
  for (std::size_t side = 0; side < ankle_nodes_.size(); ++side)
    if (ankle_nodes_[side]) members.push_back({kAnkleNodes[side], ankle_nodes_[side]->bus_handle()});
  return members;
}

// Excludes data that exist only within a step.
void Electronics::archive(StateArchive& archive) {
  archive(now_us_, tick_clock_, host_, input_, output_, bus_, drives_, imu_, ankles_, imu_node_, ankle_nodes_,
          bus_faults_, babblers_, highest_supply_V_, battery_, discharge_, drawn_J_, kicked_us_, enable_line_,
          bitten_, controller_stopped_);
  if (!archive.writes()) bus_.set_disturbance(bus_faults_.empty() ? nullptr : &bus_faults_);
}

void Electronics::isolate_controller() {
  bus_.power_off(operator_);
  for (const auto& drive : drives_) bus_.power_off(drive->bus_handle());
}

void Electronics::rejoin_controller() {
  bus_.power_on(operator_);
  for (const auto& drive : drives_) {
    if (drive->listens()) bus_.power_on(drive->bus_handle());
  }
}

}  // namespace koboshi::sim_board
