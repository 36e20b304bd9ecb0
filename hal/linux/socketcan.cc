#include "hal/linux/socketcan.h"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>

namespace koboshi::hal {
namespace {

// Half a second of a full bus, at the kernel's reckoning of 0.5 KiB and more a frame.
constexpr int kBuffer_bytes = 4 << 20;

void set(const FileDescriptor& socket, int level, int option, int value) {
  checked(::setsockopt(socket.number(), level, option, &value, sizeof value), "an option of a CAN socket");
}

std::optional<CanFrame> from_kernel(const can_frame& raw) {
  if ((raw.can_id & (CAN_EFF_FLAG | CAN_ERR_FLAG)) != 0 || raw.can_dlc > CAN_MAX_DLEN) return std::nullopt;
  CanFrame frame{.identifier = static_cast<std::uint16_t>(raw.can_id & CAN_SFF_MASK),
                 .size = raw.can_dlc,
                 .remote = (raw.can_id & CAN_RTR_FLAG) != 0};
  if (!frame.remote) std::copy_n(raw.data, frame.size, frame.data.begin());
  return frame;
}

}  // namespace

SocketCan::SocketCan(const std::string& interface) {
  socket_ = FileDescriptor(
      checked(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW), "SocketCAN"));
  const unsigned index = if_nametoindex(interface.c_str());
  if (index == 0) throw std::system_error(errno, std::generic_category(), "the CAN interface " + interface);
  set(socket_, SOL_SOCKET, SO_RCVBUF, kBuffer_bytes);
  set(socket_, SOL_SOCKET, SO_SNDBUF, kBuffer_bytes);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(index);
  checked(::bind(socket_.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
          "the CAN interface " + interface);
}

bool SocketCan::send(const CanFrame& frame) {
  can_frame raw{};
  raw.can_id = frame.identifier | (frame.remote ? CAN_RTR_FLAG : 0u);
  raw.can_dlc = frame.size;
  std::copy_n(frame.data.begin(), frame.size, raw.data);
  const ssize_t sent = ::write(socket_.number(), &raw, sizeof raw);
  if (sent == static_cast<ssize_t>(sizeof raw)) return true;
  if (sent < 0 && errno != ENOBUFS && errno != EAGAIN) checked(-1, "sending on a CAN interface");
  return false;
}

std::optional<CanFrame> SocketCan::receive() {
  can_frame raw{};
  for (;;) {
    const ssize_t got = ::read(socket_.number(), &raw, sizeof raw);
    if (got < 0 && errno == EAGAIN) return std::nullopt;
    checked(static_cast<int>(got), "receiving from a CAN interface");
    if (got != static_cast<ssize_t>(sizeof raw)) continue;
    if (const auto frame = from_kernel(raw)) return frame;
  }
}

}  // namespace koboshi::hal
