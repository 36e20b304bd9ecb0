#include "tools/can/source.h"

#include <poll.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "sim_board/can/candump_log.h"

namespace koboshi::tools {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kRoomTimeout_us = 1'000'000;

std::uint64_t since_us(Clock::time_point start) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start).count());
}

class LogSource final : public FrameSource {
 public:
  explicit LogSource(const std::filesystem::path& file) : reader_(file) {}

  std::optional<TimedFrame> next(std::uint64_t) override {
    const auto logged = reader_.next();
    if (!logged) return std::nullopt;
    return TimedFrame{logged->frame, logged->time_us};
  }
  bool is_live() const override { return false; }

 private:
  sim::CandumpReader reader_;
};

class LiveSource final : public FrameSource {
 public:
  explicit LiveSource(sim::Transport& transport) : transport_(transport), start_(Clock::now()) {}

  std::optional<TimedFrame> next(std::uint64_t timeout_us) override {
    const Clock::time_point asked = Clock::now();
    for (;;) {
      if (const auto frame = transport_.receive()) return TimedFrame{*frame, since_us(start_)};
      const std::uint64_t waited_us = since_us(asked);
      if (waited_us >= timeout_us) return std::nullopt;
      wait_for_frames(transport_, timeout_us - waited_us);
    }
  }
  bool is_live() const override { return true; }

 private:
  sim::Transport& transport_;
  Clock::time_point start_;
};

}  // namespace

std::unique_ptr<FrameSource> open_log(const std::filesystem::path& place) {
  return std::make_unique<LogSource>(std::filesystem::is_directory(place) ? place / "can.log" : place);
}

std::unique_ptr<FrameSource> listen_to(sim::Transport& transport) {
  return std::make_unique<LiveSource>(transport);
}

void send_surely(sim::Transport& transport, const hal::CanFrame& frame) {
  const Clock::time_point start = Clock::now();
  while (!transport.send(frame, 0)) {
    if (since_us(start) > kRoomTimeout_us) throw std::runtime_error("the bus takes no frames");
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  transport.flush();
}

void wait_for_frames(const sim::Transport& transport, std::uint64_t timeout_us) {
  pollfd file{.fd = transport.descriptor(), .events = POLLIN, .revents = 0};
  const timespec timeout{.tv_sec = static_cast<time_t>(timeout_us / 1'000'000),
                         .tv_nsec = static_cast<long>(timeout_us % 1'000'000 * 1000)};
  ppoll(&file, 1, &timeout, nullptr);
}

}  // namespace koboshi::tools
