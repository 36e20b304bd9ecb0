#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/canopen/dictionary.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::bus {

// An abort of the transfer by either side.
class SdoAborted : public std::runtime_error {
 public:
  explicit SdoAborted(canopen::AbortCode code);
  canopen::AbortCode code() const { return code_; }

 private:
  canopen::AbortCode code_;
};

// The text of an abort code in CiA 301, table 22.
std::string text_of(canopen::AbortCode code);

// Receives the progress of a transfer in bytes; a total of 0 means unknown.
using SdoProgress = std::function<void(std::size_t done, std::size_t total)>;

// The node did not answer in time.
class NoSdoAnswer : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A blocking client of one SDO channel (CiA 301, 7.2.4). Transfers objects of any size, by segments or by
// blocks, with a checksum if the server supports it.
//
// A channel belongs to one client, but another may use it: a controller polls the drives on their first one.
// Answers to others are skipped. A transfer that another client's request has ended is repeated, after a
// pause that doubles each time.
class SdoTransfer {
 public:
  static constexpr std::uint64_t kTimeout_us = 1'000'000;  // for each answer; a read without one is repeated
  static constexpr int kAttempts = 4;                      // of a transfer that others disturb
  static constexpr int kSilentAttempts = 2;                // of a read without an answer

  // Uses the node's first channel. The transport must outlive this.
  SdoTransfer(sim_board::Transport& transport, std::uint8_t node_id);
  // Uses the channel with these identifiers of requests and responses.
  SdoTransfer(sim_board::Transport& transport, std::uint16_t request, std::uint16_t response)
      : transport_(transport), request_(request), response_(response) {}

  std::uint16_t request_identifier() const { return request_; }

  // These throw SdoAborted, and NoSdoAnswer if the node does not answer.
  std::vector<std::uint8_t> read(canopen::ObjectAddress address);
  void write(canopen::ObjectAddress address, std::span<const std::uint8_t> data);
  std::vector<std::uint8_t> upload(canopen::ObjectAddress address, const SdoProgress& progress = {});
  void download(canopen::ObjectAddress address, std::span<const std::uint8_t> data,
                const SdoProgress& progress = {});

 private:
  using Data = std::array<std::uint8_t, 8>;

  // An answer to the request that begins a transfer names the object. A segment of a block begins with its
  // number instead of a command specifier.
  enum class Kind : std::uint8_t { kInitiate, kMessage, kBlockSegment };

  // Calls a transfer until it succeeds or has failed for good.
  template <typename Action>
  auto repeat(bool is_read, const Action& action);
  std::vector<std::uint8_t> read_once(canopen::ObjectAddress address);
  void write_once(canopen::ObjectAddress address, std::span<const std::uint8_t> data);
  std::vector<std::uint8_t> upload_once(canopen::ObjectAddress address, const SdoProgress& progress);
  void download_once(canopen::ObjectAddress address, std::span<const std::uint8_t> data,
                     const SdoProgress& progress);

  void send(const Data& data);
  bool is_answer(const Data& data, Kind kind, std::uint8_t specifier) const;
  // Returns the next answer to this transfer: one with this specifier. Throws SdoAborted for an abort.
  Data receive(Kind kind, std::uint8_t specifier = 0);
  Data ask(Kind kind, const Data& data, std::uint8_t specifier) {
    send(data);
    return receive(kind, specifier);
  }
  [[noreturn]] void abort(canopen::AbortCode code);
  std::vector<std::uint8_t> read_segments(std::size_t size);
  void write_segments(std::span<const std::uint8_t> data);
  // `with_crc`: the server can generate the checksum; without it, the bytes that hold it are not used (CiA
  // 301, 7.2.4.3.15).
  std::vector<std::uint8_t> read_blocks(std::size_t size, bool with_crc, const SdoProgress& progress);
  void end_upload(std::vector<std::uint8_t>& data, bool with_crc);
  void write_blocks(std::span<const std::uint8_t> data, std::uint8_t block, const SdoProgress& progress);

  sim_board::Transport& transport_;
  std::uint16_t request_;
  std::uint16_t response_;
  canopen::ObjectAddress address_;  // of the transfer under way
};

// The SDO channel of a node. Only drives have a second one (1201), for the operator's PC; a controller on the
// bus uses their first.
enum class SdoChannel : std::uint8_t { kAutomatic, kFirst, kSecond };

// Uses a drive's second channel and leaves the first to the controller. Throws std::invalid_argument for a
// node without one.
SdoTransfer second_sdo(sim_board::Transport& transport, std::uint8_t node_id);

// The device type, an object that every node has.
inline constexpr canopen::ObjectAddress kDeviceType{0x1000, 0};
// Returns the request for it on a node's first channel, or on a drive's second one.
hal::CanFrame device_type_request(std::uint8_t node_id, bool on_second);

// Time for an answer on a second channel before kAutomatic asks again, or takes the first one.
inline constexpr std::uint64_t kSecondSdoTimeout_us = 250'000;

// Uses this channel. kAutomatic: a drive's second one if the node answers on it within twice
// kSecondSdoTimeout_us; else the first.
SdoTransfer open_sdo(sim_board::Transport& transport, std::uint8_t node_id, SdoChannel channel);

}  // namespace koboshi::bus
