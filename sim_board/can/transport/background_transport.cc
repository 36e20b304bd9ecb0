#include "sim_board/can/transport/background_transport.h"

#include <poll.h>

#include <ctime>
#include <utility>

namespace koboshi::sim_board {
namespace {

constexpr timespec kPause{.tv_sec = 0, .tv_nsec = 500'000};
constexpr int kRoundsADropCheck = 100;  // each check costs a system call

}  // namespace

BackgroundTransport::BackgroundTransport(std::unique_ptr<Transport> transport)
    : transport_(std::move(transport)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

BackgroundTransport::~BackgroundTransport() {
  thread_.request_stop();
  thread_.join();
}

bool BackgroundTransport::send(const hal::CanFrame& frame, std::uint64_t time_us) {
  const std::lock_guard lock(mutex_);
  if (outgoing_.size() == kCapacity) return false;
  outgoing_.push_back({frame, time_us});
  return true;
}

std::optional<hal::CanFrame> BackgroundTransport::receive() {
  if (incoming_next_ == incoming_.size()) {
    if (!has_arrived_.load(std::memory_order_relaxed)) return std::nullopt;
    incoming_.clear();
    incoming_next_ = 0;
    const std::lock_guard lock(mutex_);
    has_arrived_ = false;
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    incoming_.swap(arrived_);
    if (incoming_.empty()) return std::nullopt;
  }
  return incoming_[incoming_next_++];
}

void BackgroundTransport::run(const std::stop_token& stop) {
  try {
    while (!stop.stop_requested()) {
      pass_on();
      wait_a_while();
    }
    pass_on();
    dropped_ = transport_->dropped();
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    has_arrived_ = true;
  }
}

void BackgroundTransport::wait_a_while() const {
  pollfd arrival{.fd = full_ ? -1 : transport_->descriptor(), .events = POLLIN, .revents = 0};
  ::ppoll(&arrival, 1, &kPause, nullptr);
}

void BackgroundTransport::pass_on() {
  send_waiting();
  fetch_arrived();
  if (++rounds_ % kRoundsADropCheck == 0) dropped_ = transport_->dropped();
}

void BackgroundTransport::send_waiting() {
  while (has_waiting()) {
    const Outgoing& next = waiting_[waiting_next_];
    if (!transport_->send(next.frame, next.time_us)) break;  // no room: retried later
    ++waiting_next_;
  }
  transport_->flush();
}

bool BackgroundTransport::has_waiting() {
  if (waiting_next_ < waiting_.size()) return true;
  waiting_.clear();
  waiting_next_ = 0;
  const std::lock_guard lock(mutex_);
  waiting_.swap(outgoing_);
  return !waiting_.empty();
}

// Calls the system without holding the lock.
void BackgroundTransport::fetch_arrived() {
  while (fetched_.size() < kCapacity) {
    const auto frame = transport_->receive();
    if (!frame) break;
    fetched_.push_back(*frame);
  }
  if (fetched_.empty()) return;
  const std::lock_guard lock(mutex_);
  full_ = arrived_.size() + fetched_.size() > kCapacity;
  if (full_) return;
  arrived_.insert(arrived_.end(), fetched_.begin(), fetched_.end());
  fetched_.clear();
  has_arrived_ = true;
}

}  // namespace koboshi::sim_board
