#include "bus/can/source.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <deque>
#include <istream>
#include <stdexcept>
#include <streambuf>
#include <thread>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "hal/linux/file_descriptor.h"

namespace koboshi::bus {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kStandardInput = "-";
constexpr std::uint64_t kRoomTimeout_us = 1'000'000;

std::uint64_t since_us(Clock::time_point start) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start).count());
}

// Returns whether the descriptor is readable within this time.
bool poll_for_input(int descriptor, std::uint64_t timeout_us) {
  pollfd file{.fd = descriptor, .events = POLLIN, .revents = 0};
  const timespec timeout{.tv_sec = static_cast<time_t>(timeout_us / 1'000'000),
                         .tv_nsec = static_cast<long>(timeout_us % 1'000'000 * 1000)};
  return ppoll(&file, 1, &timeout, nullptr) > 0;
}

// Reads a pipe, a terminal or a device. Ends when the user ends the command, also before a pipe has a writer.
class PipeBuffer final : public std::streambuf {
 public:
  PipeBuffer(const std::filesystem::path& file, WaitForInput wait)
      : descriptor_(file == kStandardInput ? dup(STDIN_FILENO)
                                           : ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)),
        wait_(std::move(wait)) {}

  bool is_open() const { return descriptor_.number() >= 0; }
  bool is_ended_by_user() const { return ended_by_user_; }

 protected:
  int_type underflow() override {
    ssize_t got = -1;
    do {
      if (!wait_for_input()) return traits_type::eof();
      got = ::read(descriptor_.number(), bytes_.data(), bytes_.size());
    } while (got < 0 && errno == EAGAIN);
    if (got <= 0) return traits_type::eof();
    setg(bytes_.data(), bytes_.data(), bytes_.data() + got);
    return traits_type::to_int_type(bytes_.front());
  }

 private:
  static constexpr std::uint64_t kPatience_us = 1'000'000;

  bool wait_for_input() {
    while (!poll_for_input(descriptor_.number(), wait_ ? 0 : kPatience_us)) {
      ended_by_user_ = wait_ && !wait_(descriptor_.number(), kPatience_us);
      if (ended_by_user_) return false;
    }
    return true;
  }

  hal::FileDescriptor descriptor_;
  WaitForInput wait_;
  bool ended_by_user_ = false;
  std::array<char, 65536> bytes_;
};

std::filesystem::path file_of(const LogChoice& log) {
  return std::filesystem::is_directory(log.place) ? log.place / "can.log" : log.place;
}

// Whether the file can be read only once.
bool is_pipe(const std::filesystem::path& file) {
  return file == kStandardInput || (std::filesystem::exists(file) && !std::filesystem::is_regular_file(file));
}

InputError no_frames_of(const std::string& interface, const std::vector<std::string>& others,
                        const std::filesystem::path& file) {
  return {file, 0, "no frames of " + one_line(interface),
          "an interface of the log: " + one_line(join_alternatives(others))};
}

class LogSource final : public FrameSource {
 public:
  LogSource(const LogChoice& log, const WaitForInput& wait) : interface_(log.interface) {
    const std::filesystem::path file = file_of(log);
    if (!is_pipe(file)) {
      name_ = file;
      reader_.emplace(file, log.times);
      return;
    }
    pipe_.emplace(file, wait);
    if (!pipe_->is_open()) throw InputError(file, 0, "no readable file", "a CAN log");
    stream_.emplace(&*pipe_);
    name_ = file == kStandardInput ? "standard input" : file;
    reader_.emplace(*stream_, name_, log.times);
  }

  std::optional<TimedFrame> next(std::uint64_t) override {
    while (auto logged = reader_->next()) {
      if (!interface_.empty() && logged->interface != interface_) {
        if (!found_ && std::ranges::find(others_, logged->interface) == others_.end())
          others_.push_back(std::move(logged->interface));
        continue;
      }
      found_ = true;
      return TimedFrame{logged->frame, logged->time_us, std::move(logged->interface), logged->direction};
    }
    if (!found_ && !others_.empty() && !(pipe_ && pipe_->is_ended_by_user()))
      throw no_frames_of(interface_, others_, name_);
    return std::nullopt;
  }
  bool is_live() const override { return false; }
  bool is_arriving() const override { return pipe_.has_value(); }
  std::vector<std::string> take_remarks() override {
    const std::vector<std::string>& all = reader_->remarks();
    // The end of the reading is not that of the log.
    const bool ends_early = pipe_ && pipe_->is_ended_by_user() && reader_->is_cut_off();
    const std::size_t end = all.size() - (ends_early ? 1 : 0);
    std::vector<std::string> remarks;
    for (; taken_ < end; ++taken_) remarks.push_back(all[taken_]);
    return remarks;
  }

 private:
  std::string interface_;
  bool found_ = false;               // a frame of it
  std::vector<std::string> others_;  // interfaces of the frames before
  std::size_t taken_ = 0;            // remarks
  std::filesystem::path name_;
  std::optional<PipeBuffer> pipe_;
  std::optional<std::istream> stream_;
  std::optional<sim_board::CandumpReader> reader_;
};

void collect_interfaces(const LogChoice& log, std::vector<std::string>& names) {
  const std::filesystem::path file = file_of(log);
  if (is_pipe(file)) return;
  LogSource source({.place = file, .times = log.times}, {});
  while (const auto timed = source.next(0)) {
    if (std::ranges::find(names, timed->interface) == names.end()) names.push_back(timed->interface);
  }
}

class LiveSource final : public FrameSource {
 public:
  LiveSource(sim_board::Transport& transport, WaitForInput wait)
      : transport_(transport), wait_(std::move(wait)), start_(Clock::now()) {
    transport.watch_foreign([this](const sim_board::ForeignFrame& frame) { arrived_.emplace_back(frame); });
  }
  ~LiveSource() override { transport_.watch_foreign({}); }

  std::optional<TimedFrame> next(std::uint64_t timeout_us) override {
    const Clock::time_point asked = Clock::now();
    for (;;) {
      if (arrived_.empty()) {
        if (const auto frame = transport_.receive()) arrived_.emplace_back(*frame);  // after foreign ones
      }
      if (!arrived_.empty()) {
        TimedFrame timed{arrived_.front(), since_us(start_)};
        arrived_.pop_front();
        return timed;
      }
      const std::uint64_t waited_us = since_us(asked);
      if (waited_us >= timeout_us || !wait(timeout_us - waited_us)) return std::nullopt;
    }
  }
  bool is_live() const override { return true; }
  bool is_arriving() const override { return true; }

 private:
  bool wait(std::uint64_t timeout_us) {
    if (wait_) return wait_(transport_.descriptor(), timeout_us);
    wait_for_frames(transport_, timeout_us);
    return true;
  }

  sim_board::Transport& transport_;
  WaitForInput wait_;
  Clock::time_point start_;
  std::deque<sim_board::BusFrame> arrived_;
};

}  // namespace

std::unique_ptr<FrameSource> open_log(const LogChoice& log, const WaitForInput& wait) {
  return std::make_unique<LogSource>(log, wait);
}

std::vector<std::string> interfaces_of(const LogChoice& log) {
  std::vector<std::string> names;
  try {
    collect_interfaces(log, names);
  } catch (const InputError&) {  // reported when it is read in earnest
  }
  return names;
}

std::vector<std::string> check_log(const LogChoice& log) {
  std::vector<std::string> names;
  collect_interfaces(log, names);
  if (!log.interface.empty() && !names.empty() && std::ranges::find(names, log.interface) == names.end())
    throw no_frames_of(log.interface, names, file_of(log));
  return names;
}

std::unique_ptr<FrameSource> listen_to(sim_board::Transport& transport, const WaitForInput& wait) {
  return std::make_unique<LiveSource>(transport, wait);
}

void send_surely(sim_board::Transport& transport, const hal::CanFrame& frame) {
  const Clock::time_point start = Clock::now();
  while (!transport.send(frame, 0)) {
    if (since_us(start) > kRoomTimeout_us) throw std::runtime_error("the bus takes no frames");
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  transport.flush();
}

void wait_for_frames(const sim_board::Transport& transport, std::uint64_t timeout_us) {
  poll_for_input(transport.descriptor(), timeout_us);
}

}  // namespace koboshi::bus
