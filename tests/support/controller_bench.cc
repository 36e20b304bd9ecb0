#include "tests/support/controller_bench.h"

#include "firmware/canopen/frame.h"
#include "tests/support/factory_values.h"
#include "tests/support/robot_storage.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::test {
namespace {

using motion::Opcode;

constexpr std::uint16_t kCommandIdentifier = 0x201;
constexpr int kHeartbeat_ms = 100;

robot::RobotModel load_encoded(std::span<const std::byte> image) {
  robot::RobotModel model;
  if (robot::load_model(image, model) != robot::ModelStatus::kOk) std::abort();
  return model;
}

}  // namespace

std::vector<std::byte> factory_storage() {
  return factory_storage(encode(factory_values(), load_encoded(encode(make_test_robot())).id));
}

std::vector<std::byte> factory_storage_with_bend() {
  const robot::RobotModel model = load_encoded(encode(make_test_robot()));
  std::vector<fixed::Angle> bent(model.joint_count);
  bent[kKnee] = degrees(60);
  const TestMotion bending{
      .name = "bend", .poses = {bent}, .steps = {{Opcode::kMove, 0, 200'000}, {Opcode::kEnd}}};
  const TestMotion failing{.name = "fails",
                           .poses = {bent},
                           .steps = {{Opcode::kMove, 0, 200'000}, {Opcode::kFail}, {Opcode::kEnd}}};
  return factory_storage(encode(factory_values(), model.id),
                         {encode(bending, model.id), encode(failing, model.id)});
}

std::vector<std::byte> factory_storage(std::span<const std::byte> parameters,
                                       const std::vector<std::vector<std::byte>>& further_motions) {
  const std::vector<std::byte> model_image = encode(make_test_robot());
  const robot::RobotModel model = load_encoded(model_image);
  std::vector<fixed::Angle> stand(model.joint_count);
  stand[kKnee] = degrees(40);
  std::vector<fixed::Angle> nod = stand;
  nod[kHeadTilt] = degrees(20);
  const TestMotion standing{
      .name = "stand", .poses = {stand}, .steps = {{Opcode::kMove, 0, 500'000}, {Opcode::kEnd}}};
  const TestMotion nodding{.name = "nod",
                           .poses = {stand, nod},
                           .steps = {{Opcode::kLoopBegin, 0},
                                     {Opcode::kMove, 1, 200'000},
                                     {Opcode::kMove, 0, 200'000},
                                     {Opcode::kLoopEnd, 0},
                                     {Opcode::kEnd}}};
  std::vector<std::vector<std::byte>> motions{encode(standing, model.id), encode(nodding, model.id)};
  motions.insert(motions.end(), further_motions.begin(), further_motions.end());
  return make_storage(model_image, motions, parameters);
}

ControllerBench::ControllerBench() {
  // 1 g upwards: the reading at rest.
  imu_sample.accelerometer_raw[2] = static_cast<std::int16_t>(9.80665 / 39.2 * 32768);
  restart(factory_storage());
  for (std::size_t i = 0; i < model().joint_count; ++i) drives.emplace_back(model().joints[i].drive);
}

void ControllerBench::restart(std::span<const std::byte> storage) {
  board.storage.load(0, storage);
  controller_ = std::make_unique<app::Controller>(board.ports());
}

void ControllerBench::run_ms(int duration_ms) {
  for (int i = 0; i < duration_ms; ++i) {
    feed_sensors();
    repeat_velocity();
    controller_->service(now_us_);
    if (now_us_ % app::Controller::kTick_us == 0) controller_->tick(now_us_);
    exchange_frames();
    now_us_ += 1'000;
  }
}

bool ControllerBench::run_until(behaviour::State state, int limit_ms) {
  for (int i = 0; i < limit_ms && now().state != state; ++i) run_ms(1);
  return now().state == state;
}

bool ControllerBench::run_until_standing() {
  if (!run_until(behaviour::State::kLimp)) return false;
  run_ms(20);
  command(behaviour::Command::kEnable);
  return run_until(behaviour::State::kStanding);
}

bool ControllerBench::run_until_ready_to_walk() {
  if (!run_until(behaviour::State::kLimp)) return false;
  for (int ms = 0; ms < 2'000 && values().diagnosis.gyro_calibrations == 0; ++ms) run_ms(1);
  return values().diagnosis.gyro_calibrations != 0 && run_until_standing();
}

void ControllerBench::command(behaviour::Command command, std::int16_t argument) {
  hal::CanFrame frame{.identifier = kCommandIdentifier, .size = 3};
  frame.data[0] = static_cast<std::uint8_t>(command);
  canopen::store_u16(&frame.data[1], static_cast<std::uint16_t>(argument));
  board.can.deliver(frame);
  run_ms(1);
}

fixed::Angle ControllerBench::target(std::size_t joint) const {
  return robot::joint_angle(model().joints[joint].drive, values().drives.target_position[joint]);
}

std::optional<hal::CanFrame> ControllerBench::last_sent(std::uint16_t identifier) const {
  for (auto it = sent.rbegin(); it != sent.rend(); ++it) {
    if (it->frame.identifier == identifier) return it->frame;
  }
  return std::nullopt;
}

void ControllerBench::tell_drives(const hal::CanFrame& frame) {
  std::vector<hal::CanFrame> answers;
  for (DriveStub& drive : drives) drive.on_frame(frame, answers);
  for (const hal::CanFrame& answer : answers) board.can.deliver(answer);
}

void ControllerBench::exchange_frames() {
  std::vector<hal::CanFrame> answers;
  for (const hal::CanFrame& frame : board.can.sent()) {
    sent.push_back({now_us_, frame});
    for (DriveStub& drive : drives) drive.on_frame(frame, answers);
  }
  board.can.clear_sent();
  for (const hal::CanFrame& frame : answers) board.can.deliver(frame);
  if (now_us_ / 1'000 % kHeartbeat_ms != 5) return;
  for (const DriveStub& drive : drives) {
    if (drive.beats && !drive.hangs) board.can.deliver(drive.heartbeat());
  }
}

void ControllerBench::repeat_velocity() {
  constexpr std::uint64_t kRepetition_us = 100'000;
  if (!velocity_repeats || now().state != behaviour::State::kWalking || now_us_ % kRepetition_us != 0) return;
  const walk::Velocity& velocity = values().velocity;
  hal::CanFrame frame{.identifier = kVelocityIdentifier, .size = 6};
  canopen::store_u16(&frame.data[0], static_cast<std::uint16_t>(velocity.forward_mm_per_s));
  canopen::store_u16(&frame.data[2], static_cast<std::uint16_t>(velocity.left_mm_per_s));
  canopen::store_u16(&frame.data[4], static_cast<std::uint16_t>(velocity.turn_mrad_per_s));
  board.can.deliver(frame);
}

void ControllerBench::feed_sensors() {
  if (imu_speaks) board.imu.deliver(imu_sample);
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    if (ankle_speaks[static_cast<std::size_t>(side)]) board.ankles.deliver(side, {});
  }
}

}  // namespace koboshi::test
