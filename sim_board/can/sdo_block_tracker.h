#pragma once

#include <array>
#include <cstdint>

namespace koboshi::sim_board {

// Follows the block transfers of one SDO channel by its frames (CiA 301, 7.2.4.3.9 to 7.2.4.3.15). A segment
// of a block begins with its sequence number, which looks like a command: an observer without this state
// takes its data for reads and writes.
class SdoBlockTracker {
 public:
  using Data = std::array<std::uint8_t, 8>;

  // Follows a message of eight bytes from the client (`is_request`) or the server. Returns whether it is a
  // segment of a block.
  bool follow(const Data& data, bool is_request);
  // Ends the transfer, as a reset of the node does.
  void reset() { *this = {}; }

 private:
  enum class State : std::uint8_t {
    kIdle,
    kDownloadRequested,
    kDownload,         // the client sends segments
    kDownloadConfirm,  // it has sent the last one of a block
    kUploadRequested,
    kUpload,  // the server sends segments
    kUploadConfirm,
  };

  bool follow_request(const Data& data);
  bool follow_response(const Data& data);
  bool take_segment(std::uint8_t command, State when_complete);
  void confirm(const Data& data, State next_block);

  State state_ = State::kIdle;
  std::uint8_t size_ = 0;      // segments of a block
  std::uint8_t sequence_ = 0;  // of the latest segment
  bool last_ = false;          // it is the last of the transfer
};

}  // namespace koboshi::sim_board
