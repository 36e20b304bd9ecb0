#include "firmware/canopen/sdo/client.h"

#include <algorithm>

#include "firmware/canopen/frame.h"
#include "firmware/canopen/sdo/protocol.h"

namespace koboshi::canopen {
namespace {

hal::CanFrame request(std::uint8_t node_id, std::uint8_t command, ObjectAddress address, std::uint32_t data) {
  hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(kSdoRequestBase + node_id), .size = 8};
  frame.data = sdo::message(command, address, data);
  return frame;
}

}  // namespace

bool SdoClient::begin_write(std::uint8_t node_id, ObjectAddress address, std::uint32_t value,
                            std::size_t size, std::uint64_t now_us) {
  if (size < 1 || size > 4) return false;
  const std::uint8_t command = sdo::expedited(sdo::kInitiateDownloadRequest, size);
  if (!begin(request(node_id, command, address, value), node_id, address, now_us)) return false;
  writing_ = true;
  return true;
}

bool SdoClient::begin_read(std::uint8_t node_id, ObjectAddress address, std::uint64_t now_us) {
  if (!begin(request(node_id, sdo::kInitiateUploadRequest, address, 0), node_id, address, now_us))
    return false;
  writing_ = false;
  return true;
}

bool SdoClient::begin(const hal::CanFrame& request, std::uint8_t node_id, ObjectAddress address,
                      std::uint64_t now_us) {
  if (state_ == SdoState::kBusy || !sink_.send(request)) return false;
  state_ = SdoState::kBusy;
  node_id_ = node_id;
  address_ = address;
  abort_code_ = AbortCode::kNone;
  deadline_us_ = now_us + timeout_us_;
  return true;
}

bool SdoClient::answers(const hal::CanFrame& frame) {
  if (frame.identifier != kSdoResponseBase + node_id_ || frame.remote || frame.size != 8) return false;
  const std::uint8_t command = frame.data[0];
  const bool same_object = sdo::address_of(frame.data) == address_;
  if (command == sdo::kAbort) {
    // An abort for another object belongs to an earlier transfer that timed out.
    if (!same_object) return false;
    abort_code_ = static_cast<AbortCode>(sdo::data_of(frame.data));
    state_ = SdoState::kAborted;
    return true;
  }
  if (!same_object) return false;
  accept(frame);
  return true;
}

void SdoClient::accept(const hal::CanFrame& response) {
  const std::uint8_t command = response.data[0];
  if (writing_ && command == sdo::kInitiateDownloadResponse) {
    state_ = SdoState::kDone;
  } else if (!writing_ && sdo::is_expedited(command, sdo::kInitiateUploadResponse)) {
    size_ = static_cast<std::uint8_t>(sdo::expedited_size(command));
    value_ = sdo::data_of(response.data);
    if (size_ < 4) value_ &= (1u << (8 * size_)) - 1;
    state_ = SdoState::kDone;
  } else {
    abort(AbortCode::kCommandSpecifierUnknown);
    state_ = SdoState::kAborted;
  }
}

void SdoClient::time_out() {
  abort(AbortCode::kTimedOut);
  state_ = SdoState::kTimedOut;
}

void SdoClient::abort(AbortCode code) {
  abort_code_ = code;
  // Without room the server runs into its own time-out.
  static_cast<void>(sink_.send(request(node_id_, sdo::kAbort, address_, static_cast<std::uint32_t>(code))));
}

}  // namespace koboshi::canopen
