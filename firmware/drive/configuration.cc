#include "firmware/drive/configuration.h"

#include <algorithm>
#include <iterator>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/pdo.h"
#include "hal/port/period.h"

namespace koboshi::drive {

namespace cia402 = canopen::cia402;
using canopen::kCobIdInvalid;
using canopen::kCobIdNoRemote;
using canopen::mapping;

// One SDO request. Its value is `constant` plus a value of the joint's drive.
struct Configuration::Step {
  enum class Purpose : std::uint8_t { kWrite, kExpect, kSupply };
  enum class DriveField : std::uint8_t {
    kNothing,
    kNodeId,
    kVendorId,
    kProductCode,
    kSerialNumber,
    kLowest,
    kHighest
  };

  Purpose purpose;
  canopen::ObjectAddress address;
  std::uint8_t size;
  std::uint32_t constant;
  DriveField field = DriveField::kNothing;
};

namespace {

constexpr std::uint32_t kRpdo = canopen::kRpdo1Base;
constexpr std::uint32_t kTpdo = canopen::kTpdo1Base | kCobIdNoRemote;
constexpr std::uint32_t kControllerLost =
    std::uint32_t{kControllerNodeId} << 16 | kControllerHeartbeatLost_ms;

// A drive that is mounted in reverse has its lowest position at the joint's upper limit.
std::uint32_t position_limit(const robot::Joint& joint, bool highest) {
  const auto [low, high] = std::minmax(
      {robot::drive_position(joint.drive, joint.lower), robot::drive_position(joint.drive, joint.upper)});
  return static_cast<std::uint32_t>(highest ? high : low);
}

}  // namespace

constexpr Configuration::Step Configuration::kSteps[] = {
    {Step::Purpose::kExpect, {0x1018, 1}, 4, 0, Step::DriveField::kVendorId},
    {Step::Purpose::kExpect, {0x1018, 2}, 4, 0, Step::DriveField::kProductCode},
    {Step::Purpose::kExpect, {0x1018, 4}, 4, 0, Step::DriveField::kSerialNumber},
    // RPDO 1: controlword and target position, in effect at SYNC.
    {Step::Purpose::kWrite, {0x1400, 1}, 4, kRpdo | kCobIdInvalid, Step::DriveField::kNodeId},
    {Step::Purpose::kWrite, {0x1400, 2}, 1, canopen::kSynchronousEverySync},
    {Step::Purpose::kWrite, {0x1400, 5}, 2, kTargetsLost_ms},
    {Step::Purpose::kWrite, {0x1600, 0}, 1, 0},
    {Step::Purpose::kWrite, {0x1600, 1}, 4, mapping(cia402::kControlword, 0, 16)},
    {Step::Purpose::kWrite, {0x1600, 2}, 4, mapping(cia402::kTargetPosition, 0, 32)},
    {Step::Purpose::kWrite, {0x1600, 0}, 1, 2},
    {Step::Purpose::kWrite, {0x1400, 1}, 4, kRpdo, Step::DriveField::kNodeId},
    // TPDO 1: statusword, position and torque, sampled at SYNC.
    {Step::Purpose::kWrite, {0x1800, 1}, 4, kTpdo | kCobIdInvalid, Step::DriveField::kNodeId},
    {Step::Purpose::kWrite, {0x1800, 2}, 1, canopen::kSynchronousEverySync},
    {Step::Purpose::kWrite, {0x1A00, 0}, 1, 0},
    {Step::Purpose::kWrite, {0x1A00, 1}, 4, mapping(cia402::kStatusword, 0, 16)},
    {Step::Purpose::kWrite, {0x1A00, 2}, 4, mapping(cia402::kPositionActual, 0, 32)},
    {Step::Purpose::kWrite, {0x1A00, 3}, 4, mapping(cia402::kTorqueActual, 0, 16)},
    {Step::Purpose::kWrite, {0x1A00, 0}, 1, 3},
    {Step::Purpose::kWrite, {0x1800, 1}, 4, kTpdo, Step::DriveField::kNodeId},
    // Supervision both ways, and the cycle.
    {Step::Purpose::kWrite, {0x1016, 1}, 4, kControllerLost},
    {Step::Purpose::kWrite, {0x1017, 0}, 2, kDriveHeartbeat_ms},
    {Step::Purpose::kWrite, {0x1006, 0}, 4, hal::kControlPeriod_us},
    {Step::Purpose::kWrite, {cia402::kInterpolationTimePeriod, 1}, 1, hal::kControlPeriod_us / 1000},
    {Step::Purpose::kWrite, {cia402::kSoftwarePositionLimit, 1}, 4, 0, Step::DriveField::kLowest},
    {Step::Purpose::kWrite, {cia402::kSoftwarePositionLimit, 2}, 4, 0, Step::DriveField::kHighest},
    {Step::Purpose::kWrite, {cia402::kModeOfOperation, 0}, 1, cia402::kCyclicSynchronousPosition},
    {Step::Purpose::kSupply, {cia402::kSupplyVoltage, 0}, 4, 0},
};

std::uint32_t Configuration::value_of(const Step& step) const {
  const robot::Drive& drive = joint_->drive;
  switch (step.field) {
    case Step::DriveField::kNothing:
      return step.constant;
    case Step::DriveField::kNodeId:
      return step.constant + drive.node_id;
    case Step::DriveField::kVendorId:
      return drive.vendor_id;
    case Step::DriveField::kProductCode:
      return drive.product_code;
    case Step::DriveField::kSerialNumber:
      return drive.serial_number;
    case Step::DriveField::kLowest:
      return position_limit(*joint_, false);
    case Step::DriveField::kHighest:
      return position_limit(*joint_, true);
  }
  return 0;
}

void Configuration::begin(const robot::Joint& joint) {
  client_.reset();
  joint_ = &joint;
  state_ = State::kBusy;
  fault_ = DriveFault::kNone;
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
  const Step& next = kSteps[number_];
  if (next.purpose == Step::Purpose::kWrite) {
    return client_.begin_write(joint_->drive.node_id, next.address, value_of(next), next.size, now_us);
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
      if (++attempt_ == kAttempts) fail(DriveFault::kNoAnswer);
      return;
    case canopen::SdoState::kAborted:
      return fail(DriveFault::kRefused);
    case canopen::SdoState::kDone:
      break;
  }
  const Step& done = kSteps[number_];
  if (done.purpose == Step::Purpose::kExpect && client_.value() != value_of(done)) {
    return fail(DriveFault::kWrongIdentity);
  }
  if (done.purpose == Step::Purpose::kSupply) supply_mV_ = client_.value();
  requested_ = false;
  attempt_ = 0;
  if (++number_ == std::size(kSteps)) state_ = State::kDone;
}

void Configuration::fail(DriveFault fault) {
  state_ = State::kFailed;
  fault_ = fault;
}

}  // namespace koboshi::drive
