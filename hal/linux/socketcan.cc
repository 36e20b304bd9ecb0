#include "hal/linux/socketcan.h"

#include <linux/can/raw.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <span>
#include <utility>

#include "hal/linux/interface_kind.h"
#include "hal/linux/socket_option.h"

namespace koboshi::hal {
namespace {

// Half a second of a full bus; the kernel counts at least 0.5 KiB per frame.
constexpr int kBuffer_bytes = 4 << 20;

// A sendmmsg/recvmmsg message for each of these frames, which must outlive it.
template <typename Frame>
class Messages {
 public:
  explicit Messages(std::span<Frame> frames) : count_(static_cast<unsigned>(frames.size())) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      parts_[i] = {&frames[i], sizeof(Frame)};
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

std::optional<CanFrame> from_kernel(const canfd_frame& raw) {
  if ((raw.can_id & (CAN_EFF_FLAG | CAN_ERR_FLAG)) != 0 || raw.len > CAN_MAX_DLEN) return std::nullopt;
  CanFrame frame{.identifier = static_cast<std::uint16_t>(raw.can_id & CAN_SFF_MASK),
                 .size = raw.len,
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

void SocketCan::watch_foreign(TakeForeign take) {
  // An interface or a kernel without CAN FD carries no such frames.
  const int on = 1;
  static_cast<void>(::setsockopt(socket_.number(), SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on));
  set_option(socket_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, can_err_mask_t{CAN_ERR_MASK});
  take_foreign_ = std::move(take);
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
  Messages<can_frame> messages{std::span(outgoing_).first(outgoing_count_)};
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
    const std::size_t next = incoming_next_++;
    const bool is_fd = incoming_is_fd_[next];
    const auto frame = is_fd ? std::nullopt : from_kernel(incoming_[next]);
    if (frame) return frame;
    if (take_foreign_) take_foreign_(incoming_[next], is_fd);
  }
}

// Receives a batch of frames. Returns false if there is none.
bool SocketCan::fetch() {
  Messages<canfd_frame> messages{incoming_};
  incoming_next_ = incoming_count_ = 0;
  const int got = ::recvmmsg(socket_.number(), messages.headers(), messages.count(), MSG_DONTWAIT, nullptr);
  if (got < 0 && errno == EAGAIN) return false;
  incoming_count_ = static_cast<std::size_t>(checked(got, "receiving from a CAN interface"));
  for (std::size_t i = 0; i < incoming_count_; ++i)
    incoming_is_fd_[i] = messages.headers()[i].msg_len == CANFD_MTU;
  return incoming_count_ > 0;
}

}  // namespace koboshi::hal
