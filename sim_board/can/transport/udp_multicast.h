#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "hal/linux/file_descriptor.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::sim_board {

// A frame in the format of python-can's udp_multicast: one datagram with one MessagePack map (python-can 4,
// interfaces/udp_multicast/utils.py). The time is in seconds since the epoch. python-can's own datagrams are
// one or two bytes shorter for identifiers below 0x100; here frames of equal data size have equal datagram
// size, as required for trains.
struct Datagram {
  static constexpr std::size_t kCapacity_bytes = 162;  // with 8 bytes of data

  std::span<const std::uint8_t> view() const { return std::span(bytes).first(size); }

  std::array<std::uint8_t, kCapacity_bytes> bytes;
  std::size_t size = 0;
};
Datagram pack_datagram(const hal::CanFrame& frame, double timestamp_s);
// Returns nothing for a datagram that holds no frame.
std::optional<BusFrame> unpack_datagram(std::span<const std::uint8_t> datagram);

struct UdpOptions {
  // Time to live, IPv6: hop limit. 0: datagrams stay on this machine; 1: in the network segment.
  std::uint8_t ttl = 0;
  std::string interface {};  // empty: the one that the routing table chooses for the group
};

// A bus between processes and machines in the same multicast group, of IPv4 or IPv6. Takes only datagrams
// that were sent to this group: Linux would deliver others to the port, too, those of every group that a
// process of the host has joined (ip(7): IP_MULTICAST_ALL) and those to the host itself. The kernel drops the
// datagrams that this object sent itself.
//
// Each datagram in the kernel costs microseconds. All datagrams of a millisecond are therefore sent in one
// system call, and consecutive ones of equal size as one train, which the kernel splits only for receivers
// other than this class (udp(7): UDP_SEGMENT, UDP_GRO).
class UdpMulticast final : public Transport {
 public:
  static constexpr std::size_t kBatch = 64;  // also the kernel's UDP_MAX_SEGMENTS

  // Throws std::invalid_argument if the group is not a multicast address or there is no such interface, and
  // std::system_error if a system call fails, for example without a route to the group.
  UdpMulticast(const std::string& group, std::uint16_t port, const UdpOptions& options = {});

  // Buffers the frame until the next flush.
  bool send(const hal::CanFrame& frame, std::uint64_t time_us) override;
  // Frames that the system has no room for stay buffered.
  void flush() override;
  std::optional<hal::CanFrame> receive() override;
  void watch_foreign(TakeForeign take) override { take_foreign_ = std::move(take); }
  std::uint64_t dropped() const override;
  std::string place() const override { return place_; }
  int descriptor() const override { return receiver_.number(); }
  bool is_slow() const override { return true; }

 private:
  // The group's address and port.
  struct Group {
    // Throws std::invalid_argument.
    Group(const std::string& text, std::uint16_t port);

    bool is_ipv6() const { return address.ss_family == AF_INET6; }
    const sockaddr* pointer() const { return reinterpret_cast<const sockaddr*>(&address); }
    socklen_t length() const { return is_ipv6() ? sizeof(sockaddr_in6) : sizeof(sockaddr_in); }
    const in_addr& ipv4() const { return reinterpret_cast<const sockaddr_in&>(address).sin_addr; }
    const in6_addr& ipv6() const { return reinterpret_cast<const sockaddr_in6&>(address).sin6_addr; }

    sockaddr_storage address{};
  };

  hal::FileDescriptor udp_socket() const;
  void join(int interface_index);
  void choose_route(int interface_index, int ttl);
  void drop_own_datagrams();
  bool fetch();
  bool is_for_group(msghdr& message);

  Group group_;
  std::string place_;
  TakeForeign take_foreign_;
  hal::FileDescriptor receiver_;
  hal::FileDescriptor sender_;  // bound to its own port, which identifies our datagrams
  bool trains_ = false;         // whether the system supports them
  std::array<Datagram, kBatch> outgoing_;
  std::size_t outgoing_count_ = 0;
  std::uint64_t own_messages_ = 0;                  // own messages that the receiver's filter has dropped
  std::array<std::uint8_t, 65536> incoming_bytes_;  // the maximum size of an IP packet
  std::span<const std::uint8_t> incoming_;          // unread part
  std::size_t incoming_size_ = 0;                   // of each datagram in it
};

}  // namespace koboshi::sim_board
