#include "hal/linux/socketcan.h"

#include <linux/can/raw.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <span>

#include "hal/linux/interface_kind.h"
#include "hal/linux/socket_option.h"

namespace koboshi::hal {
namespace {

// Half a second of a full bus; the kernel counts at least 0.5 KiB per frame.
constexpr int kBuffer_bytes = 4 << 20;

// A sendmmsg/recvmmsg message for each of these frames, which must outlive it.
class Messages {
 public:
  explicit Messages(std::span<can_frame> frames) : count_(static_cast<unsigned>(frames.size())) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      parts_[i] = {&frames[i], sizeof(can_frame)};
      headers_[i].msg_hdr.msg_iov = &parts_[i];
      headers_[i].msg_hdr.msg_iovlen = 1;
    }
  }
  mmsghdr* headers() { return headers_.data(); }
  unsigned count() const { return count_; }

 private:
  std::array<iovec, SocketCan::kBatch> parts_{};
  std::array<mmsghdr, SocketCan::kBatch> headers_{};
  unsigned count_;
};

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
  set_option(socket_, SOL_SOCKET, SO_RCVBUF, kBuffer_bytes);
  set_option(socket_, SOL_SOCKET, SO_SNDBUF, kBuffer_bytes);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = interface_index(interface);
  checked(::bind(socket_.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
          "the CAN interface " + interface);
}

bool SocketCan::send(const CanFrame& frame) {
  if (outgoing_count_ == kBatch) flush();
  if (outgoing_count_ == kBatch) return false;
  can_frame& raw = outgoing_[outgoing_count_++];
  raw = {};
  raw.can_id = frame.identifier | (frame.remote ? CAN_RTR_FLAG : 0u);
  raw.can_dlc = frame.size;
  std::copy_n(frame.data.begin(), frame.size, raw.data);
  return true;
}

void SocketCan::flush() {
  if (outgoing_count_ == 0) return;
  Messages messages{std::span(outgoing_).first(outgoing_count_)};
  const int sent = ::sendmmsg(socket_.number(), messages.headers(), messages.count(), 0);
  if (sent < 0 && errno != ENOBUFS && errno != EAGAIN) checked(-1, "sending on a CAN interface");
  const auto done = static_cast<std::size_t>(std::max(sent, 0));
  std::copy(outgoing_.begin() + static_cast<std::ptrdiff_t>(done),
            outgoing_.begin() + static_cast<std::ptrdiff_t>(outgoing_count_), outgoing_.begin());
  outgoing_count_ -= done;
}

std::optional<CanFrame> SocketCan::receive() {
  for (;;) {
    if (incoming_next_ == incoming_count_ && !fetch()) return std::nullopt;
    if (const auto frame = from_kernel(incoming_[incoming_next_++])) return frame;
  }
}

// Receives a batch of frames. Returns false if there is none.
bool SocketCan::fetch() {
  Messages messages{incoming_};
  incoming_next_ = incoming_count_ = 0;
  const int got = ::recvmmsg(socket_.number(), messages.headers(), messages.count(), MSG_DONTWAIT, nullptr);
  if (got < 0 && errno == EAGAIN) return false;
  incoming_count_ = static_cast<std::size_t>(checked(got, "receiving from a CAN interface"));
  return incoming_count_ > 0;
}

}  // namespace koboshi::hal
