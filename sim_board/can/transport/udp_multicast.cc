#include "sim_board/can/transport/udp_multicast.h"

#include <arpa/inet.h>
#include <linux/filter.h>
#include <netinet/in.h>
#include <netinet/udp.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "hal/linux/socket_option.h"

namespace koboshi::sim {
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

sockaddr_in address_of(in_addr host, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr = host;
  address.sin_port = htons(port);
  return address;
}

hal::FileDescriptor udp_socket() {
  return hal::FileDescriptor(
      checked(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), "a UDP socket"));
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
    if (size > (fd ? ForeignFrame::kMaxBytes : hal::CanFrame{}.data.size())) return std::nullopt;
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

UdpMulticast::UdpMulticast(const std::string& group, std::uint16_t port)
    : place_(group + ":" + std::to_string(port)), receiver_(udp_socket()), sender_(udp_socket()) {
  in_addr host{};
  if (inet_pton(AF_INET, group.c_str(), &host) != 1 || !IN_MULTICAST(ntohl(host.s_addr)))
    throw std::invalid_argument(group + " is no IPv4 multicast address");
  set_option(receiver_, SOL_SOCKET, SO_REUSEADDR, 1);
  set_option(receiver_, SOL_SOCKET, SO_RCVBUF, kBuffer_bytes);
  const sockaddr_in here = address_of({htonl(INADDR_ANY)}, port);
  checked(::bind(receiver_.number(), reinterpret_cast<const sockaddr*>(&here), sizeof here),
          "UDP port of " + place_);
  set_option(receiver_, IPPROTO_IP, IP_ADD_MEMBERSHIP,
             ip_mreq{.imr_multiaddr = host, .imr_interface = {htonl(INADDR_ANY)}});

  set_option(sender_, SOL_SOCKET, SO_SNDBUF, kBuffer_bytes);
  set_option(sender_, IPPROTO_IP, IP_MULTICAST_TTL, 1);
  const sockaddr_in there = address_of(host, port);
  checked(::connect(sender_.number(), reinterpret_cast<const sockaddr*>(&there), sizeof there),
          "a route to " + place_);
  // Fails on a system without segmentation offload; each message gives its own segment size.
  const int none = 0;
  trains_ = ::setsockopt(sender_.number(), SOL_UDP, UDP_SEGMENT, &none, sizeof none) == 0;
  // Without GRO, the kernel splits our own trains before it applies the filter.
  const int whole = 1;
  static_cast<void>(::setsockopt(receiver_.number(), SOL_UDP, UDP_GRO, &whole, sizeof whole));
  drop_own_datagrams();
}

// The group returns our own datagrams. A filter drops them without a copy or a system call.
void UdpMulticast::drop_own_datagrams() {
  sockaddr_in own{};
  socklen_t length = sizeof own;
  checked(::getsockname(sender_.number(), reinterpret_cast<sockaddr*>(&own), &length), "a UDP socket");
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
  alignas(cmsghdr) std::array<std::uint8_t, CMSG_SPACE(sizeof(int))> control_bytes;
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control_bytes.data();
  message.msg_controllen = control_bytes.size();
  const ssize_t got = ::recvmsg(receiver_.number(), &message, 0);
  if (got < 0) return false;
  incoming_ = std::span(incoming_bytes_).first(static_cast<std::size_t>(got));
  incoming_size_ = incoming_.size();
  const cmsghdr* const control = CMSG_FIRSTHDR(&message);
  if (control == nullptr || control->cmsg_level != SOL_UDP || control->cmsg_type != UDP_GRO) return true;
  int size = 0;
  std::memcpy(&size, CMSG_DATA(control), sizeof size);
  incoming_size_ = static_cast<std::size_t>(size);
  return true;
}

}  // namespace koboshi::sim
