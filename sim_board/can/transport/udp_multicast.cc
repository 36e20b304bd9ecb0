#include "sim_board/can/transport/udp_multicast.h"

#include <arpa/inet.h>
#include <linux/filter.h>
#include <net/if.h>
#include <netinet/in.h>
#include <netinet/udp.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "hal/linux/socket_option.h"

namespace koboshi::sim_board {
namespace {

using Json = nlohmann::json;
using hal::checked;
using hal::set_option;

constexpr int kBuffer_bytes = 4 << 20;
constexpr unsigned kStandardIdentifiers = 0x800;
constexpr unsigned kExtendedIdentifiers = 0x2000'0000;

double epoch_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// Returns 0, the choice of the routing table, for an empty name.
int index_of(const std::string& interface) {
  if (interface.empty()) return 0;
  const unsigned index = if_nametoindex(interface.c_str());
  if (index == 0)
    throw std::invalid_argument("found --interface " + interface +
                                ", expected a network interface, as `ip link` " + "lists them");
  return static_cast<int>(index);
}

// Returns a boolean field, which may be missing.
bool is_true(const Json& message, const char* name) { return message.value(name, false); }

// Appends values to a datagram in MessagePack's encoding; all numbers are big-endian.
class Packer {
 public:
  explicit Packer(Datagram& datagram) : datagram_(datagram) {}

  void byte(unsigned value) { datagram_.bytes[datagram_.size++] = static_cast<std::uint8_t>(value); }
  void bytes(const void* data, std::size_t size) {
    std::memcpy(datagram_.bytes.data() + datagram_.size, data, size);
    datagram_.size += size;
  }
  void number(std::uint64_t value, int size) {
    while (--size >= 0) byte(static_cast<unsigned>(value >> 8 * size & 0xFF));
  }
  void key(std::string_view name) {  // up to 31 characters
    byte(0xA0u | static_cast<unsigned>(name.size()));
    bytes(name.data(), name.size());
  }
  void truth(std::string_view name, bool value) {
    key(name);
    byte(value ? 0xC3 : 0xC2);
  }

 private:
  Datagram& datagram_;
};

// Datagrams prepared for sendmmsg: one message per train (datagrams of equal size, which its control data
// gives) or per datagram. The datagrams must outlive this object.
class Messages {
 public:
  Messages(std::span<Datagram> datagrams, bool trains) {
    for (std::size_t i = 0; i < datagrams.size(); ++i) {
      parts_[i] = {datagrams[i].bytes.data(), datagrams[i].size};
      if (i > 0 && trains && datagrams[i].size == datagrams[i - 1].size) {
        msghdr& train = headers_[count_ - 1].msg_hdr;
        if (++train.msg_iovlen == 2) name_size(train, datagrams[i].size);
      } else {
        msghdr& first = headers_[count_++].msg_hdr;
        first.msg_iov = &parts_[i];
        first.msg_iovlen = 1;
      }
    }
  }
  // Returns the number of sent datagrams, or -1 with errno if there is none. Adds their messages to
  // `messages`.
  int send(const hal::FileDescriptor& socket, std::uint64_t& messages) {
    const int sent = ::sendmmsg(socket.number(), headers_.data(), count_, 0);
    if (sent < 0) return sent;
    messages += static_cast<std::uint64_t>(sent);
    std::size_t datagrams = 0;
    for (int i = 0; i < sent; ++i) datagrams += headers_[static_cast<std::size_t>(i)].msg_hdr.msg_iovlen;
    return static_cast<int>(datagrams);
  }

 private:
  struct Control {
    alignas(cmsghdr) std::array<std::uint8_t, CMSG_SPACE(sizeof(std::uint16_t))> bytes;
  };

  void name_size(msghdr& train, std::size_t size) {
    train.msg_control = controls_[count_ - 1].bytes.data();
    train.msg_controllen = sizeof(Control);
    cmsghdr* const control = CMSG_FIRSTHDR(&train);
    control->cmsg_level = SOL_UDP;
    control->cmsg_type = UDP_SEGMENT;
    control->cmsg_len = CMSG_LEN(sizeof(std::uint16_t));
    const auto segment = static_cast<std::uint16_t>(size);
    std::memcpy(CMSG_DATA(control), &segment, sizeof segment);
  }

  std::array<iovec, UdpMulticast::kBatch> parts_;
  std::array<mmsghdr, UdpMulticast::kBatch> headers_{};
  std::array<Control, UdpMulticast::kBatch> controls_;
  unsigned count_ = 0;
};

}  // namespace

Datagram pack_datagram(const hal::CanFrame& frame, double timestamp_s) {
  const std::size_t size = frame.remote ? 0 : frame.size;
  Datagram datagram;
  Packer pack(datagram);
  pack.byte(0x8B);  // a map of eleven
  pack.key("timestamp");
  pack.byte(0xCB);
  pack.number(std::bit_cast<std::uint64_t>(timestamp_s), 8);
  pack.key("arbitration_id");
  pack.byte(0xCD);
  pack.number(frame.identifier, 2);
  pack.truth("is_extended_id", false);
  pack.truth("is_remote_frame", frame.remote);
  pack.truth("is_error_frame", false);
  pack.key("channel");
  pack.byte(0xC0);  // nil
  pack.key("dlc");
  pack.byte(frame.size);
  pack.key("data");
  pack.byte(0xC4);
  pack.byte(static_cast<unsigned>(size));
  pack.bytes(frame.data.data(), size);
  pack.truth("is_fd", false);
  pack.truth("bitrate_switch", false);
  pack.truth("error_state_indicator", false);
  return datagram;
}

std::optional<BusFrame> unpack_datagram(std::span<const std::uint8_t> datagram) {
  const Json message = Json::from_msgpack(datagram.begin(), datagram.end(), true, false);
  if (!message.is_object()) return std::nullopt;
  try {
    const bool extended = is_true(message, "is_extended_id");
    const bool error = is_true(message, "is_error_frame");
    const bool fd = is_true(message, "is_fd");
    const bool remote = is_true(message, "is_remote_frame");
    const auto identifier = message.at("arbitration_id").get<unsigned>();
    const auto size = message.at("dlc").get<unsigned>();  // python-can's dlc is the number of bytes
    const bool standard = !extended && !error;
    if (identifier >= (standard ? kStandardIdentifiers : kExtendedIdentifiers)) return std::nullopt;
    if (fd ? !is_fd_size(size) : size > hal::CanFrame{}.data.size()) return std::nullopt;
    const auto fill = [&](auto frame) -> std::optional<BusFrame> {
      frame.size = static_cast<std::uint8_t>(size);
      frame.remote = remote;
      if (remote) return frame;
      const auto& data = message.at("data").get_binary();
      if (data.size() != size) return std::nullopt;
      std::ranges::copy(data, frame.data.begin());
      return frame;
    };
    if (standard && !fd) return fill(hal::CanFrame{.identifier = static_cast<std::uint16_t>(identifier)});
    const unsigned flags = (is_true(message, "bitrate_switch") ? 1u : 0u) |
                           (is_true(message, "error_state_indicator") ? 2u : 0u);
    return fill(ForeignFrame{.kind = error ? ForeignFrame::Kind::kError
                                     : fd  ? ForeignFrame::Kind::kFd
                                           : ForeignFrame::Kind::kExtended,
                             .extended = extended && !error,
                             .flags = static_cast<std::uint8_t>(fd ? flags : 0),
                             .identifier = identifier});
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

UdpMulticast::Group::Group(const std::string& text, std::uint16_t port) {
  if (auto& v4 = reinterpret_cast<sockaddr_in&>(address);
      inet_pton(AF_INET, text.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(port);
    if (IN_MULTICAST(ntohl(v4.sin_addr.s_addr))) return;
  }
  address = {};
  if (auto& v6 = reinterpret_cast<sockaddr_in6&>(address);
      inet_pton(AF_INET6, text.c_str(), &v6.sin6_addr) == 1) {
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(port);
    if (IN6_IS_ADDR_MULTICAST(&v6.sin6_addr)) return;
  }
  throw std::invalid_argument(text + " is no multicast address, such as 239.74.163.2");
}

UdpMulticast::UdpMulticast(const std::string& group, std::uint16_t port, const UdpOptions& options)
    : group_(group, port),
      place_((group_.is_ipv6() ? "[" + group + "]" : group) + ":" + std::to_string(port)),
      receiver_(udp_socket()),
      sender_(udp_socket()) {
  const int interface_index = index_of(options.interface);
  if (group_.is_ipv6())  // links have their own groups ff02::
    reinterpret_cast<sockaddr_in6&>(group_.address).sin6_scope_id =
        static_cast<std::uint32_t>(interface_index);
  set_option(receiver_, SOL_SOCKET, SO_REUSEADDR, 1);
  set_option(receiver_, SOL_SOCKET, SO_RCVBUF, kBuffer_bytes);
  checked(::bind(receiver_.number(), group_.pointer(), group_.length()), "UDP port of " + place_);
  join(interface_index);

  set_option(sender_, SOL_SOCKET, SO_SNDBUF, kBuffer_bytes);
  choose_route(interface_index, options.ttl);
  checked(::connect(sender_.number(), group_.pointer(), group_.length()), "a route to " + place_);
  // Fails on a system without segmentation offload; each message gives its own segment size.
  const int none = 0;
  trains_ = ::setsockopt(sender_.number(), SOL_UDP, UDP_SEGMENT, &none, sizeof none) == 0;
  // Without GRO, the kernel splits our own trains before it applies the filter.
  const int whole = 1;
  static_cast<void>(::setsockopt(receiver_.number(), SOL_UDP, UDP_GRO, &whole, sizeof whole));
  drop_own_datagrams();
}

hal::FileDescriptor UdpMulticast::udp_socket() const {
  return hal::FileDescriptor(checked(
      ::socket(group_.address.ss_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), "a UDP socket"));
}

// The socket receives what arrives by its own membership only, with the destination of each datagram.
void UdpMulticast::join(int interface_index) {
  if (group_.is_ipv6()) {
    set_option(receiver_, IPPROTO_IPV6, IPV6_MULTICAST_ALL, 0);
    set_option(receiver_, IPPROTO_IPV6, IPV6_RECVPKTINFO, 1);
    set_option(receiver_, IPPROTO_IPV6, IPV6_JOIN_GROUP,
               ipv6_mreq{.ipv6mr_multiaddr = group_.ipv6(),
                         .ipv6mr_interface = static_cast<unsigned>(interface_index)});
  } else {
    set_option(receiver_, IPPROTO_IP, IP_MULTICAST_ALL, 0);
    set_option(receiver_, IPPROTO_IP, IP_PKTINFO, 1);
    set_option(receiver_, IPPROTO_IP, IP_ADD_MEMBERSHIP,
               ip_mreqn{.imr_multiaddr = group_.ipv4(), .imr_address = {}, .imr_ifindex = interface_index});
  }
}

void UdpMulticast::choose_route(int interface_index, int ttl) {
  if (group_.is_ipv6()) {
    set_option(sender_, IPPROTO_IPV6, IPV6_MULTICAST_HOPS, ttl);
    if (interface_index != 0) set_option(sender_, IPPROTO_IPV6, IPV6_MULTICAST_IF, interface_index);
  } else {
    set_option(sender_, IPPROTO_IP, IP_MULTICAST_TTL, ttl);
    const ip_mreqn interface { .imr_multiaddr = {}, .imr_address = {}, .imr_ifindex = interface_index };
    if (interface_index != 0) set_option(sender_, IPPROTO_IP, IP_MULTICAST_IF, interface);
  }
}

// The group returns our own datagrams. A filter drops them without a copy or a system call.
void UdpMulticast::drop_own_datagrams() {
  // The port is at the same place in the addresses of both families.
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  checked(::getsockname(sender_.number(), reinterpret_cast<sockaddr*>(&address), &length), "a UDP socket");
  const auto& own = reinterpret_cast<const sockaddr_in&>(address);
  sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_H | BPF_ABS, 0),  // the source port, the first field of the UDP header
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, ntohs(own.sin_port), 0, 1),
      BPF_STMT(BPF_RET | BPF_K, 0),
      BPF_STMT(BPF_RET | BPF_K, UINT32_MAX),
  };
  set_option(receiver_, SOL_SOCKET, SO_ATTACH_FILTER,
             sock_fprog{.len = std::size(program), .filter = program});
}

bool UdpMulticast::send(const hal::CanFrame& frame, std::uint64_t) {
  if (outgoing_count_ == kBatch) flush();
  if (outgoing_count_ == kBatch) return false;
  outgoing_[outgoing_count_++] = pack_datagram(frame, epoch_s());
  return true;
}

void UdpMulticast::flush() {
  if (outgoing_count_ == 0) return;
  const auto outgoing = std::span(outgoing_).first(outgoing_count_);
  int sent = Messages(outgoing, trains_).send(sender_, own_messages_);
  // An interface without checksum offload rejects trains.
  if (sent < 0 && trains_ && errno == EIO) {
    trains_ = false;
    sent = Messages(outgoing, trains_).send(sender_, own_messages_);
  }
  if (sent <= 0) return;
  std::ranges::copy(outgoing.subspan(static_cast<std::size_t>(sent)), outgoing_.begin());
  outgoing_count_ -= static_cast<std::size_t>(sent);
}

std::uint64_t UdpMulticast::dropped() const {
  const std::uint64_t all = hal::drops(receiver_);
  return all - std::min(all, own_messages_);
}

std::optional<hal::CanFrame> UdpMulticast::receive() {
  while (!incoming_.empty() || fetch()) {
    const auto datagram = incoming_.first(std::min(incoming_size_, incoming_.size()));
    incoming_ = incoming_.subspan(datagram.size());
    const auto frame = unpack_datagram(datagram);
    if (!frame) continue;
    if (const auto* standard = std::get_if<hal::CanFrame>(&*frame)) return *standard;
    if (take_foreign_) take_foreign_(std::get<ForeignFrame>(*frame));
  }
  return std::nullopt;
}

// Receives a datagram, or a train with the size of all datagrams but the last. Returns false if there is
// none.
bool UdpMulticast::fetch() {
  iovec part{incoming_bytes_.data(), incoming_bytes_.size()};
  alignas(cmsghdr) std::array<std::uint8_t, CMSG_SPACE(sizeof(int)) + CMSG_SPACE(sizeof(in6_pktinfo))>
      control_bytes;
  for (;;) {
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control_bytes.data();
    message.msg_controllen = control_bytes.size();
    const ssize_t got = ::recvmsg(receiver_.number(), &message, 0);
    if (got < 0) return false;
    incoming_ = std::span(incoming_bytes_).first(static_cast<std::size_t>(got));
    incoming_size_ = incoming_.size();
    if (is_for_group(message)) return true;
  }
}

// Reads the control data of a datagram: its destination, and the size of the datagrams of a train.
bool UdpMulticast::is_for_group(msghdr& message) {
  bool to_group = false;
  for (cmsghdr* control = CMSG_FIRSTHDR(&message); control != nullptr;
       control = CMSG_NXTHDR(&message, control)) {
    const std::uint8_t* const data = CMSG_DATA(control);
    if (control->cmsg_level == SOL_UDP && control->cmsg_type == UDP_GRO) {
      int size = 0;
      std::memcpy(&size, data, sizeof size);
      incoming_size_ = static_cast<std::size_t>(size);
    } else if (control->cmsg_level == IPPROTO_IP && control->cmsg_type == IP_PKTINFO) {
      to_group = std::memcmp(data + offsetof(in_pktinfo, ipi_addr), &group_.ipv4(), sizeof(in_addr)) == 0;
    } else if (control->cmsg_level == IPPROTO_IPV6 && control->cmsg_type == IPV6_PKTINFO) {
      to_group = std::memcmp(data + offsetof(in6_pktinfo, ipi6_addr), &group_.ipv6(), sizeof(in6_addr)) == 0;
    }
  }
  return to_group;
}

}  // namespace koboshi::sim_board
