#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "sim_board/can/transport/transport.h"

namespace koboshi::sim {

// A transport whose calls are made by a thread of its own, which takes the time of a system call from the
// simulation. It looks for frames to send every half millisecond, so that the simulation need not wake it,
// and for frames that came in as soon as they do.
class BackgroundTransport final : public Transport {
 public:
  // Frames that may wait each way: a second of a full bus. Beyond, those to be sent are refused, and those
  // that came in wait where they are.
  static constexpr std::size_t kCapacity = 8192;

  explicit BackgroundTransport(std::unique_ptr<Transport> transport);
  // Lets go of what still waits, as far as there is room for it.
  ~BackgroundTransport() override;

  bool send(const hal::CanFrame& frame, std::uint64_t time_us) override;
  // Throws what the thread ended with, once.
  std::optional<hal::CanFrame> receive() override;
  std::uint64_t dropped() const override { return dropped_.load(std::memory_order_relaxed); }
  std::string place() const override { return transport_->place(); }
  bool is_live() const override { return transport_->is_live(); }

 private:
  struct Outgoing {
    hal::CanFrame frame;
    std::uint64_t time_us;
  };

  void run(const std::stop_token& stop);
  void wait_a_while() const;
  void pass_on();
  void send_waiting();
  bool has_waiting();
  void fetch_arrived();

  std::unique_ptr<Transport> transport_;  // the thread's, but for what never changes

  std::mutex mutex_;  // of what follows
  std::vector<Outgoing> outgoing_;
  std::vector<hal::CanFrame> arrived_;
  std::exception_ptr failure_;
  std::atomic<bool> has_arrived_ = false;  // or failed; so that a look costs no lock
  std::atomic<std::uint64_t> dropped_ = 0;

  // The thread's: what is being sent, and what came in and is not handed over yet.
  std::vector<Outgoing> waiting_;
  std::size_t waiting_next_ = 0;
  std::vector<hal::CanFrame> fetched_;
  bool full_ = false;
  int rounds_ = 0;

  std::vector<hal::CanFrame> incoming_;  // the simulation's
  std::size_t incoming_next_ = 0;

  std::jthread thread_;  // ends before all else
};

}  // namespace koboshi::sim
