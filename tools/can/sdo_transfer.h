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

// The server refused, or either side broke off.
class SdoAborted : public std::runtime_error {
 public:
  explicit SdoAborted(canopen::AbortCode code);
  canopen::AbortCode code() const { return code_; }

 private:
  canopen::AbortCode code_;
};

// What CiA 301, table 22, says of a code.
std::string text_of(canopen::AbortCode code);

// How far a transfer has come, in bytes; a total of 0 is not known.
using SdoProgress = std::function<void(std::size_t done, std::size_t total)>;

// The client's side of one SDO channel (CiA 301, 7.2.4), for a person or a test that waits for it. Objects of
// any size, by segments or by blocks with a checksum.
class SdoTransfer {
 public:
  static constexpr std::uint64_t kTimeout_us = 1'000'000;  // for each answer

  // On the node's default channel. The transport must outlive it.
  SdoTransfer(sim::Transport& transport, std::uint8_t node_id);
  // On any channel: identifiers of requests and responses.
  SdoTransfer(sim::Transport& transport, std::uint16_t request, std::uint16_t response)
      : transport_(transport), request_(request), response_(response) {}

  // Throw SdoAborted, and std::runtime_error where nobody answers.
  std::vector<std::uint8_t> read(canopen::ObjectAddress address);
  void write(canopen::ObjectAddress address, std::span<const std::uint8_t> data);
  std::vector<std::uint8_t> upload(canopen::ObjectAddress address, const SdoProgress& progress = {});
  void download(canopen::ObjectAddress address, std::span<const std::uint8_t> data,
                const SdoProgress& progress = {});

 private:
  using Data = std::array<std::uint8_t, 8>;

  void send(const Data& data);
  Data receive();
  // Sends, and returns the answer, whose specifier must be this one.
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

// On a drive's second channel, which leaves the controller's alone. Throws std::invalid_argument for a node
// that has none: its identifiers are another node's.
SdoTransfer second_sdo(sim::Transport& transport, std::uint8_t node_id);

}  // namespace koboshi::tools
