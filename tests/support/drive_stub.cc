#include "tests/support/drive_stub.h"

#include "firmware/canopen/frame.h"
#include "firmware/canopen/sdo/protocol.h"

namespace koboshi::test {

using canopen::cia402::Command;
using State = DriveStub::State;

namespace {

State follow(State state, std::uint16_t controlword) {
  switch (canopen::cia402::command_of(controlword)) {
    case Command::kDisableVoltage:
    case Command::kQuickStop:  // an ideal drive stops at once
      return State::kSwitchOnDisabled;
    case Command::kShutdown:
      return State::kReadyToSwitchOn;
    case Command::kSwitchOn:
      return state == State::kReadyToSwitchOn || state == State::kOperationEnabled ? State::kSwitchedOn
                                                                                   : state;
    case Command::kEnableOperation:
      return state == State::kSwitchedOn ? State::kOperationEnabled : state;
  }
  return state;
}

}  // namespace

DriveStub::DriveStub(const robot::Drive& drive) : node_id_(drive.node_id) {
  set_object(0x1018, 1, drive.vendor_id);
  set_object(0x1018, 2, drive.product_code);
  set_object(0x1018, 4, drive.serial_number);
  set_object(canopen::cia402::kSupplyVoltage, 0, 7400);
  set_object(canopen::cia402::kMaxTorque, 0, 1000);
}

void DriveStub::on_frame(const hal::CanFrame& frame, std::vector<hal::CanFrame>& answers) {
  if (hangs) return;
  if (frame.identifier == canopen::kNmtCobId) return on_nmt(frame, answers);
  const bool asked =
      frame.identifier == canopen::kSdoRequestBase + node_id_ && frame.data[0] != canopen::sdo::kAbort;
  if (asked && answers_sdo) answers.push_back(answer(frame));
  if (!operational_) return;
  if (frame.identifier == canopen::kRpdo1Base + node_id_) {
    next_controlword_ = canopen::load_u16(&frame.data[0]);
    next_target_ = static_cast<std::int32_t>(canopen::load_u32(&frame.data[2]));
  }
  if (frame.identifier == canopen::kSyncCobId) {
    cycle(next_controlword_, next_target_);
    answers.push_back(cyclic_answer());
  }
}

std::uint16_t DriveStub::cycle(std::uint16_t next_controlword, std::int32_t next_target) {
  controlword = next_controlword;
  target = next_target;
  const bool stuck = !enables && state == State::kReadyToSwitchOn;
  if (state != State::kFault && !stuck) state = follow(state, controlword);
  if (state == State::kOperationEnabled && object(canopen::cia402::kMaxTorque, 0) > 0) position = target;
  return statusword();
}

std::uint16_t DriveStub::statusword() const {
  const bool following = follows && state == State::kOperationEnabled;
  return static_cast<std::uint16_t>(canopen::cia402::statusword_of(state) |
                                    (following ? canopen::cia402::kFollowsCommand : 0u));
}

void DriveStub::on_nmt(const hal::CanFrame& frame, std::vector<hal::CanFrame>& answers) {
  const auto message = canopen::decode_nmt(frame);
  if (message->node_id != 0 && message->node_id != node_id_) return;
  operational_ = message->command == canopen::NmtCommand::kStart;
  if (message->command != canopen::NmtCommand::kResetNode) return;
  state = State::kSwitchOnDisabled;
  set_object(canopen::cia402::kMaxTorque, 0, 1000);
  answers.push_back(boot_up());
}

hal::CanFrame DriveStub::answer(const hal::CanFrame& request) {
  const auto address = canopen::sdo::address_of(request.data);
  const bool reads = request.data[0] == canopen::sdo::kInitiateUploadRequest;
  hal::CanFrame response{.identifier = static_cast<std::uint16_t>(canopen::kSdoResponseBase + node_id_),
                         .size = 8};
  if (refuses == address) {
    response.data = canopen::sdo::message(canopen::sdo::kAbort, address, 0x0602'0000);
  } else if (reads) {
    response.data = canopen::sdo::message(canopen::sdo::expedited(canopen::sdo::kInitiateUploadResponse, 4),
                                          address, object(address.index, address.subindex));
  } else {
    set_object(address.index, address.subindex, canopen::sdo::data_of(request.data));
    response.data = canopen::sdo::message(canopen::sdo::kInitiateDownloadResponse, address, 0);
  }
  return response;
}

hal::CanFrame DriveStub::cyclic_answer() const {
  hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(canopen::kTpdo1Base + node_id_), .size = 8};
  canopen::store_u16(&frame.data[0], statusword());
  canopen::store_u32(&frame.data[2], static_cast<std::uint32_t>(position));
  return frame;
}

hal::CanFrame DriveStub::boot_up() const {
  return canopen::encode(canopen::Heartbeat{node_id_, canopen::NmtState::kInitialising});
}

hal::CanFrame DriveStub::heartbeat() const {
  const auto nmt = operational_ ? canopen::NmtState::kOperational : canopen::NmtState::kPreOperational;
  return canopen::encode(canopen::Heartbeat{node_id_, nmt});
}

hal::CanFrame DriveStub::emergency(std::uint16_t code) const {
  return canopen::encode(canopen::Emergency{.node_id = node_id_, .code = code, .error_register = 1});
}

}  // namespace koboshi::test
