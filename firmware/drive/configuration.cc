#include "firmware/drive/configuration.h"

#include <algorithm>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/cob_id.h"
#include "firmware/canopen/pdo.h"

namespace koboshi::drive {

namespace cia402 = canopen::cia402;
using canopen::kCobIdInvalid;
using canopen::kCobIdNoRemote;
using canopen::mapping;

// One SDO request. Reads are compared with `value` unless `purpose` says otherwise.
struct Configuration::Step {
  enum class Purpose : std::uint8_t { kWrite, kExpect, kSupply };

  Purpose purpose;
  canopen::ObjectAddress address;
  std::uint32_t value;
  std::uint8_t size;
};

Configuration::Step Configuration::step(std::size_t number) const {
  using enum Step::Purpose;
  const robot::Drive& drive = joint_->drive;
  const std::uint32_t rpdo = canopen::kRpdo1Base + drive.node_id;
  const std::uint32_t tpdo = (canopen::kTpdo1Base + drive.node_id) | kCobIdNoRemote;
  const std::int32_t ends[] = {robot::drive_position(drive, joint_->lower),
                               robot::drive_position(drive, joint_->upper)};
  const auto [low, high] = std::minmax(ends[0], ends[1]);
  const Step steps[kStepCount] = {
      {kExpect, {0x1018, 1}, drive.vendor_id, 4},
      {kExpect, {0x1018, 2}, drive.product_code, 4},
      {kExpect, {0x1018, 4}, drive.serial_number, 4},
      // RPDO 1: controlword and target position, in effect at SYNC.
      {kWrite, {0x1400, 1}, rpdo | kCobIdInvalid, 4},
      {kWrite, {0x1400, 2}, canopen::kSynchronousEverySync, 1},
      {kWrite, {0x1600, 0}, 0, 1},
      {kWrite, {0x1600, 1}, mapping(cia402::kControlword, 0, 16), 4},
      {kWrite, {0x1600, 2}, mapping(cia402::kTargetPosition, 0, 32), 4},
      {kWrite, {0x1600, 0}, 2, 1},
      {kWrite, {0x1400, 1}, rpdo, 4},
      // TPDO 1: statusword, position and torque, sampled at SYNC.
      {kWrite, {0x1800, 1}, tpdo | kCobIdInvalid, 4},
      {kWrite, {0x1800, 2}, canopen::kSynchronousEverySync, 1},
      {kWrite, {0x1A00, 0}, 0, 1},
      {kWrite, {0x1A00, 1}, mapping(cia402::kStatusword, 0, 16), 4},
      {kWrite, {0x1A00, 2}, mapping(cia402::kPositionActual, 0, 32), 4},
      {kWrite, {0x1A00, 3}, mapping(cia402::kTorqueActual, 0, 16), 4},
      {kWrite, {0x1A00, 0}, 3, 1},
      {kWrite, {0x1800, 1}, tpdo, 4},
      // Supervision both ways, and the cycle.
      {kWrite, {0x1016, 1}, (std::uint32_t{kControllerNodeId} << 16) | kControllerHeartbeatLost_ms, 4},
      {kWrite, {0x1017, 0}, kDriveHeartbeat_ms, 2},
      {kWrite, {0x1006, 0}, kCycle_us, 4},
      {kWrite, {cia402::kInterpolationTimePeriod, 1}, kCycle_us / 1000, 1},
      {kWrite, {cia402::kSoftwarePositionLimit, 1}, static_cast<std::uint32_t>(low), 4},
      {kWrite, {cia402::kSoftwarePositionLimit, 2}, static_cast<std::uint32_t>(high), 4},
      {kWrite, {cia402::kModeOfOperation, 0}, std::uint32_t{cia402::kCyclicSynchronousPosition}, 1},
      {kSupply, {cia402::kSupplyVoltage, 0}, 0, 4},
  };
  return steps[number];
}

void Configuration::begin(const robot::Joint& joint) {
  client_.reset();
  joint_ = &joint;
  state_ = State::kBusy;
  trouble_ = Trouble::kNone;
  number_ = 0;
  attempt_ = 0;
  requested_ = false;
}

void Configuration::process(std::uint64_t now_us) {
  if (state_ != State::kBusy) return;
  if (requested_) finish_step();
  if (state_ == State::kBusy && !requested_) requested_ = begin_step(now_us);
}

bool Configuration::begin_step(std::uint64_t now_us) {
  const Step next = step(number_);
  if (next.purpose == Step::Purpose::kWrite) {
    return client_.begin_write(joint_->drive.node_id, next.address, next.value, next.size, now_us);
  }
  return client_.begin_read(joint_->drive.node_id, next.address, now_us);
}

void Configuration::finish_step() {
  switch (client_.state()) {
    case canopen::SdoState::kIdle:
    case canopen::SdoState::kBusy:
      return;
    case canopen::SdoState::kTimedOut:
      requested_ = false;
      if (++attempt_ == kAttempts) fail(Trouble::kNoAnswer);
      return;
    case canopen::SdoState::kAborted:
      return fail(Trouble::kRefused);
    case canopen::SdoState::kDone:
      break;
  }
  const Step done = step(number_);
  if (done.purpose == Step::Purpose::kExpect && client_.value() != done.value) {
    return fail(Trouble::kWrongIdentity);
  }
  if (done.purpose == Step::Purpose::kSupply) supply_mV_ = client_.value();
  requested_ = false;
  attempt_ = 0;
  if (++number_ == kStepCount) state_ = State::kDone;
}

void Configuration::fail(Trouble trouble) {
  state_ = State::kFailed;
  trouble_ = trouble;
}

}  // namespace koboshi::drive
