#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/linux/file_descriptor.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::sim {

// A frame as python-can's interface udp_multicast packs it: one datagram with one MessagePack map (python-can
// 4, interfaces/udp_multicast/utils.py). The time is that of the epoch, in seconds.
std::vector<std::uint8_t> pack_datagram(const hal::CanFrame& frame, double timestamp_s);
// Nothing for what is no such datagram, or no classic frame with an 11-bit identifier.
std::optional<hal::CanFrame> unpack_datagram(std::span<const std::uint8_t> datagram);

// A bus between processes and machines that hear the same multicast group. What is sent here is not heard
// here.
class UdpMulticast final : public Transport {
 public:
  // Throws std::invalid_argument for a group that is no IPv4 multicast address, std::system_error for what
  // the system refuses, such as a machine without a route to the group.
  UdpMulticast(const std::string& group, std::uint16_t port);

  bool send(const hal::CanFrame& frame, std::uint64_t time_us) override;
  std::optional<hal::CanFrame> receive() override;
  std::string place() const override { return place_; }
  int descriptor() const override { return receiver_.number(); }

 private:
  std::string place_;
  hal::FileDescriptor receiver_;
  hal::FileDescriptor sender_;  // of a port of its own, by which our datagrams are known
  std::uint16_t sender_port_ = 0;
};

}  // namespace koboshi::sim
