#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "hal/linux/file_descriptor.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::sim {

// A frame as python-can's interface udp_multicast packs it: one datagram with one MessagePack map (python-can
// 4, interfaces/udp_multicast/utils.py). The time is that of the epoch, in seconds. Of python-can's own
// datagrams, those of identifiers below 0x100 are one or two bytes shorter: here all frames with as many
// bytes of data are of one size, as a train of datagrams wants it.
struct Datagram {
  static constexpr std::size_t kCapacity_bytes = 162;  // of 8 bytes of data

  std::span<const std::uint8_t> view() const { return std::span(bytes).first(size); }

  std::array<std::uint8_t, kCapacity_bytes> bytes;
  std::size_t size = 0;
};
Datagram pack_datagram(const hal::CanFrame& frame, double timestamp_s);
// Nothing for what is no such datagram, or no classic frame with an 11-bit identifier.
std::optional<hal::CanFrame> unpack_datagram(std::span<const std::uint8_t> datagram);

// A bus between processes and machines that hear the same multicast group. What is sent here is not heard
// here: the kernel drops it.
//
// A datagram through the kernel costs microseconds, so those of a millisecond go there in one system call,
// and those of one size beside each other as one train, which the kernel takes apart where they arrive,
// and not for one of these ends (udp(7): UDP_SEGMENT, UDP_GRO).
class UdpMulticast final : public Transport {
 public:
  static constexpr std::size_t kBatch = 64;  // of the kernel's UDP_MAX_SEGMENTS, too

  // Throws std::invalid_argument for a group that is no IPv4 multicast address, std::system_error for what
  // the system refuses, such as a machine without a route to the group.
  UdpMulticast(const std::string& group, std::uint16_t port);

  // Keeps the frame for the next flush.
  bool send(const hal::CanFrame& frame, std::uint64_t time_us) override;
  // What the system has no room for stays and is tried again.
  void flush() override;
  std::optional<hal::CanFrame> receive() override;
  std::uint64_t dropped() const override;
  std::string place() const override { return place_; }
  int descriptor() const override { return receiver_.number(); }
  bool is_slow() const override { return true; }

 private:
  void drop_own_datagrams();
  bool fetch();

  std::string place_;
  hal::FileDescriptor receiver_;
  hal::FileDescriptor sender_;  // of a port of its own, by which our datagrams are known
  bool trains_ = false;         // whether the system takes them
  std::array<Datagram, kBatch> outgoing_;
  std::size_t outgoing_count_ = 0;
  std::uint64_t own_messages_ = 0;  // that were sent, and thrown away again by the receiver's filter
  std::array<std::uint8_t, 65536> incoming_bytes_;  // the largest that IP has
  std::span<const std::uint8_t> incoming_;          // what of it is to be read
  std::size_t incoming_size_ = 0;                   // of each datagram in it
};

}  // namespace koboshi::sim
