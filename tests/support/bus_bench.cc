#include "tests/support/bus_bench.h"

#include <algorithm>
#include <cmath>

#include "firmware/canopen/frame.h"
#include "tests/support/controller_bench.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::test {
namespace {

constexpr std::uint64_t kService_us = 1'000;
constexpr std::uint64_t kServicesATick = 10;
constexpr std::uint64_t kTickComputing_us = 500;  // as on the simulated board
constexpr std::uint64_t kServiceComputing_us = 50;
constexpr std::size_t kTransmitFifo = 32;
constexpr std::uint16_t kCommandIdentifier = 0x201;
constexpr double kSupply_V = 7.4;

}  // namespace

// --- A controller

BusBench::Unit::Unit(sim_board::Bus& bus, double clock_rate)
    : bus_(bus),
      handle_(bus.attach(*this, sim_board::AcceptanceFilter::all(), kTransmitFifo)),
      clock_rate_(clock_rate),
      begin_us_(bus.now_us()),
      storage_([] {
        hal::FakeStorage storage(128, 2048);
        storage.load(0, factory_storage());
        return storage;
      }()),
      board_(storage_),
      controller_(board_.board()) {}

std::uint64_t BusBench::Unit::next_us() const {
  return begin_us_ +
         static_cast<std::uint64_t>(std::llround(static_cast<double>(services_ * kService_us) / clock_rate_));
}

void BusBench::Unit::on_frame(const hal::CanFrame& frame, std::uint64_t) {
  if (!input_.frames.push(frame)) ++input_.can_status.receive_overruns;
}

void BusBench::Unit::feed_sensors() {
  hal::ImuSample upright;
  upright.accelerometer_raw[2] = static_cast<std::int16_t>(9.80665 / 39.2 * 32768);
  static_cast<void>(input_.imu.push(upright));
  input_.ankle_fresh = {true, true};
}

void BusBench::Unit::serve(std::uint64_t now_us) {
  const bool tick = services_ % kServicesATick == 0;
  input_.now_us = services_++ * kService_us;
  if (!runs) return;
  input_.tick = tick;
  feed_sensors();
  const std::uint16_t overruns = input_.can_status.receive_overruns;
  input_.can_status = bus_.status(handle_);
  input_.can_status.receive_overruns = overruns;
  for (const hal::TransmitFifo fifo : {hal::kProcessFifo, hal::kAnswerFifo, hal::kBackgroundFifo}) {
    input_.transmit_space[fifo] = static_cast<std::uint16_t>(bus_.transmit_space(handle_, fifo));
    input_.transmit_pending[fifo] = bus_.transmit_pending(handle_, fifo);
  }
  board_.begin(input_);
  controller_.service(input_.now_us);
  if (tick) controller_.tick(input_.now_us);
  output_ = board_.end();
  input_.frames.clear();
  input_.imu.clear();
  const std::uint64_t ready_us = now_us + (tick ? kTickComputing_us : kServiceComputing_us);
  for (const hal::CanFrame& frame : output_.frames.view())
    static_cast<void>(bus_.queue(handle_, frame, ready_us));
  if (output_.recover) bus_.recover(handle_);
}

// --- The bench

BusBench::BusBench(double clock_rate) : pc_handle_(bus.attach(pc_, sim_board::AcceptanceFilter(), 64)) {
  const std::vector<std::byte> image = encode(make_test_robot());
  if (robot::load_model(image, model_) != robot::ModelStatus::kOk) std::abort();
  bus.set_observer(this);
  units_.push_back(std::make_unique<Unit>(bus, clock_rate));
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint)
    add_drive(joint, model_.joints[joint].drive.serial_number);
}

sim_board::Drive& BusBench::add_drive(std::size_t like_joint, std::uint32_t serial_number) {
  const robot::Drive& like = model_.joints[like_joint].drive;
  auto joint = std::make_unique<Joint>();
  joint->description.name = "joint " + std::to_string(drives_.size());
  joint->description.max_speed_rad_per_s = 7.48;
  joint->description.drive = {.node_id = like.node_id,
                              .vendor_id = like.vendor_id,
                              .product_code = like.product_code,
                              .serial_number = serial_number};
  joint->drive = std::make_unique<sim_board::Drive>(joint->description, bus);
  joint->drive->power_on(now_us_);
  return *drives_.emplace_back(std::move(joint))->drive;
}

void BusBench::run_until_us(std::uint64_t end_us) {
  while (now_us_ < end_us) {
    std::uint64_t next_us = std::min(end_us, drives_due_us_);
    for (const auto& unit : units_) next_us = std::min(next_us, unit->next_us());
    now_us_ = next_us;
    for (const auto& babbler : babblers_) babbler->advance(now_us_);
    bus.advance_to(now_us_);
    if (drives_due_us_ <= now_us_) update_drives();
    for (const auto& unit : units_) {
      if (unit->next_us() <= now_us_) unit->serve(now_us_);
    }
  }
}

void BusBench::update_drives() {
  drives_due_us_ += kService_us;
  for (const auto& joint : drives_) {
    joint->drive->set_enable_line(units_[0]->drive_enable_line());
    joint->drive->update(joint->shaft, now_us_);
    joint->drive->draw(joint->shaft);
    joint->drive->torque(kSupply_V);
    if (joint->drive->makes_torque())
      joint->shaft.position_rad = joint->drive->values().position_demand * sim_board::kRadPerPositionUnit;
  }
}

bool BusBench::run_until(behaviour::State state, int limit_ms) {
  for (int i = 0; i < limit_ms && controller().state() != state; ++i) run_ms(1);
  return controller().state() == state;
}

bool BusBench::run_until_standing() {
  if (!run_until(behaviour::State::kLimp)) return false;
  run_ms(20);
  command(behaviour::Command::kEnable);
  return run_until(behaviour::State::kStanding);
}

int BusBench::count_in(canopen::cia402::State state) const {
  return static_cast<int>(
      std::ranges::count_if(drives_, [state](const auto& joint) { return joint->drive->state() == state; }));
}

void BusBench::say(const hal::CanFrame& frame) { static_cast<void>(bus.queue(pc_handle_, frame, now_us_)); }

void BusBench::command(behaviour::Command command, std::int16_t argument) {
  hal::CanFrame frame{.identifier = kCommandIdentifier, .size = 3};
  frame.data[0] = static_cast<std::uint8_t>(command);
  canopen::store_u16(&frame.data[1], static_cast<std::uint16_t>(argument));
  say(frame);
  run_ms(10);
}

std::vector<std::uint16_t> BusBench::emergencies(std::uint8_t node_id) const {
  std::vector<std::uint16_t> codes;
  for (const SeenFrame& frame : seen) {
    const auto emergency = canopen::decode_emergency(frame.frame);
    if (emergency && emergency->node_id == node_id && emergency->code != canopen::error_code::kNoError)
      codes.push_back(emergency->code);
  }
  return codes;
}

std::vector<BusBench::SeenFrame> BusBench::seen_with(std::uint16_t identifier) const {
  std::vector<SeenFrame> found;
  std::ranges::copy_if(seen, std::back_inserter(found),
                       [identifier](const SeenFrame& frame) { return frame.frame.identifier == identifier; });
  return found;
}

void BusBench::on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) {
  seen.push_back({frame, start_us, end_us});
}

}  // namespace koboshi::test
