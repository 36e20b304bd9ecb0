#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/canopen/dictionary.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::tools {

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

// A blocking client of one SDO channel (CiA 301, 7.2.4). Transfers objects of any size, by segments or by
// blocks with a checksum.
class SdoTransfer {
 public:
  static constexpr std::uint64_t kTimeout_us = 1'000'000;  // for each answer

  // Uses the node's default channel. The transport must outlive this.
  SdoTransfer(sim::Transport& transport, std::uint8_t node_id);
  // Uses the channel with these identifiers of requests and responses.
  SdoTransfer(sim::Transport& transport, std::uint16_t request, std::uint16_t response)
      : transport_(transport), request_(request), response_(response) {}

  // These throw SdoAborted, and std::runtime_error if the node does not answer.
  std::vector<std::uint8_t> read(canopen::ObjectAddress address);
  void write(canopen::ObjectAddress address, std::span<const std::uint8_t> data);
  std::vector<std::uint8_t> upload(canopen::ObjectAddress address, const SdoProgress& progress = {});
  void download(canopen::ObjectAddress address, std::span<const std::uint8_t> data,
                const SdoProgress& progress = {});

 private:
  using Data = std::array<std::uint8_t, 8>;

  // A segment of a block begins with its number instead of a command specifier.
  enum class Kind : std::uint8_t { kMessage, kBlockSegment };

  void send(const Data& data);
  bool is_for_another(const Data& answer) const;
  // Returns the next answer to this transfer.
  Data receive(Kind kind = Kind::kMessage);
  // Sends a request and returns the answer. Aborts if the answer has another specifier.
  Data ask(const Data& data, std::uint8_t specifier);
  [[noreturn]] void abort(canopen::AbortCode code);
  std::vector<std::uint8_t> read_segments(std::size_t size);
  void write_segments(std::span<const std::uint8_t> data);
  std::vector<std::uint8_t> read_blocks(std::size_t size, const SdoProgress& progress);
  void end_upload(std::vector<std::uint8_t>& data);
  void write_blocks(std::span<const std::uint8_t> data, std::uint8_t block, const SdoProgress& progress);

  sim::Transport& transport_;
  std::uint16_t request_;
  std::uint16_t response_;
  canopen::ObjectAddress address_;  // of the transfer under way
};

// Uses a drive's second channel and leaves the first to the controller. Throws std::invalid_argument for a
// node without one.
SdoTransfer second_sdo(sim::Transport& transport, std::uint8_t node_id);

}  // namespace koboshi::tools
