#include "sim_board/can/sdo_block_tracker.h"

#include "firmware/canopen/sdo/protocol.h"

namespace koboshi::sim_board {
namespace {

namespace sdo = canopen::sdo;

constexpr std::uint8_t kCommandMask = sdo::kSpecifierMask | sdo::kBlockSubcommandMask;

// Bit 1 of an initiate message says whether the size is given.
constexpr bool begins_block(std::uint8_t command, std::uint8_t specifier) {
  return (command & (sdo::kSpecifierMask | sdo::kBlockEnd)) == (specifier | sdo::kBlockInitiate);
}

}  // namespace

bool SdoBlockTracker::follow(const Data& data, bool is_request) {
  return is_request ? follow_request(data) : follow_response(data);
}

bool SdoBlockTracker::follow_request(const Data& data) {
  if (state_ == State::kDownload) return take_segment(data[0], State::kDownloadConfirm);
  const std::uint8_t command = data[0] & kCommandMask;
  if (begins_block(data[0], sdo::kBlockDownloadRequest)) {
    state_ = State::kDownloadRequested;
  } else if (command == (sdo::kBlockUploadRequest | sdo::kBlockInitiate)) {
    state_ = State::kUploadRequested;
    size_ = data[4];
  } else if (command == (sdo::kBlockUploadRequest | sdo::kBlockStartUpload)) {
    // The log may begin after the request.
    if (state_ != State::kUploadRequested) size_ = sdo::kMaxBlockSize;
    state_ = State::kUpload;
    sequence_ = 0;
  } else if (command == (sdo::kBlockUploadRequest | sdo::kBlockConfirm) &&
             (state_ == State::kUpload || state_ == State::kUploadConfirm)) {
    confirm(data, State::kUpload);
  } else {
    state_ = State::kIdle;
  }
  return false;
}

bool SdoBlockTracker::follow_response(const Data& data) {
  if (state_ == State::kUpload) return take_segment(data[0], State::kUploadConfirm);
  const std::uint8_t command = data[0] & kCommandMask;
  if (state_ == State::kDownloadRequested && command == (sdo::kBlockDownloadResponse | sdo::kBlockInitiate)) {
    state_ = State::kDownload;
    size_ = data[4];
    sequence_ = 0;
    last_ = false;
  } else if (command == (sdo::kBlockDownloadResponse | sdo::kBlockConfirm) &&
             (state_ == State::kDownload || state_ == State::kDownloadConfirm)) {
    confirm(data, State::kDownload);
  } else if (state_ != State::kUploadRequested || !begins_block(data[0], sdo::kBlockUploadResponse)) {
    state_ = State::kIdle;
  }
  return false;
}

// The receiver drops a segment that does not follow the one before, but it is none the less a segment.
// Sequence number 0, as in an abort, and one beyond the block end the transfer.
bool SdoBlockTracker::take_segment(std::uint8_t command, State when_complete) {
  const std::uint8_t sequence = command & ~sdo::kBlockLastSegment & 0xFF;
  if (sequence == 0 || sequence > size_) {
    state_ = State::kIdle;
    return false;
  }
  sequence_ = sequence;
  last_ = (command & sdo::kBlockLastSegment) != 0;
  if (last_ || sequence == size_) state_ = when_complete;
  return true;
}

// The receiver has this many segments of the block and accepts this size of the next.
void SdoBlockTracker::confirm(const Data& data, State next_block) {
  const bool is_complete = last_ && data[1] == sequence_;
  state_ = is_complete ? State::kIdle : next_block;
  size_ = data[2];
  sequence_ = 0;
  last_ = false;
}

}  // namespace koboshi::sim_board
