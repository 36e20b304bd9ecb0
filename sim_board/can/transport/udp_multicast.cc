#include "sim_board/can/transport/udp_multicast.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "hal/linux/socket_option.h"

namespace koboshi::sim {
namespace {

using Json = nlohmann::json;
using hal::checked;
using hal::set_option;

constexpr int kBuffer_bytes = 4 << 20;
constexpr std::size_t kLargestDatagram_bytes = 1500;
constexpr unsigned kStandardIdentifiers = 0x800;

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

// Of a field that may be missing.
bool is_true(const Json& message, const char* name) { return message.value(name, false); }

}  // namespace

std::vector<std::uint8_t> pack_datagram(const hal::CanFrame& frame, double timestamp_s) {
  std::vector<std::uint8_t> data;
  if (!frame.remote) data.assign(frame.data.begin(), frame.data.begin() + frame.size);
  const Json message{{"timestamp", timestamp_s},
                     {"arbitration_id", frame.identifier},
                     {"is_extended_id", false},
                     {"is_remote_frame", frame.remote},
                     {"is_error_frame", false},
                     {"channel", nullptr},
                     {"dlc", frame.size},
                     {"data", Json::binary(std::move(data))},
                     {"is_fd", false},
                     {"bitrate_switch", false},
                     {"error_state_indicator", false}};
  return Json::to_msgpack(message);
}

std::optional<hal::CanFrame> unpack_datagram(std::span<const std::uint8_t> datagram) {
  const Json message = Json::from_msgpack(datagram.begin(), datagram.end(), true, false);
  if (!message.is_object()) return std::nullopt;
  try {
    if (is_true(message, "is_extended_id") || is_true(message, "is_error_frame") || is_true(message, "is_fd"))
      return std::nullopt;
    const auto identifier = message.at("arbitration_id").get<unsigned>();
    const auto size = message.at("dlc").get<unsigned>();
    hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(identifier),
                        .size = static_cast<std::uint8_t>(size),
                        .remote = is_true(message, "is_remote_frame")};
    if (identifier >= kStandardIdentifiers || size > frame.data.size()) return std::nullopt;
    if (frame.remote) return frame;
    const auto& data = message.at("data").get_binary();
    if (data.size() != size) return std::nullopt;
    std::ranges::copy(data, frame.data.begin());
    return frame;
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
  sockaddr_in own{};
  socklen_t length = sizeof own;
  checked(::getsockname(sender_.number(), reinterpret_cast<sockaddr*>(&own), &length), "a UDP socket");
  sender_port_ = own.sin_port;
}

bool UdpMulticast::send(const hal::CanFrame& frame, std::uint64_t) {
  const std::vector<std::uint8_t> datagram = pack_datagram(frame, epoch_s());
  const ssize_t sent = ::send(sender_.number(), datagram.data(), datagram.size(), 0);
  return sent == static_cast<ssize_t>(datagram.size());
}

std::optional<hal::CanFrame> UdpMulticast::receive() {
  std::array<std::uint8_t, kLargestDatagram_bytes> datagram{};
  for (;;) {
    sockaddr_in from{};
    socklen_t length = sizeof from;
    const ssize_t got = ::recvfrom(receiver_.number(), datagram.data(), datagram.size(), 0,
                                   reinterpret_cast<sockaddr*>(&from), &length);
    if (got < 0) return std::nullopt;
    if (from.sin_port == sender_port_) continue;
    if (const auto frame = unpack_datagram(std::span(datagram).first(static_cast<std::size_t>(got))))
      return frame;
  }
}

}  // namespace koboshi::sim
