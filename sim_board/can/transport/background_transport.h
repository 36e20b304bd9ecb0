#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "sim_board/can/transport/transport.h"

namespace koboshi::sim_board {

// Moves the calls of a transport to a separate thread, so that system calls do not delay the simulation. The
// thread polls for frames to send every half millisecond, so that the simulation need not wake it, and reads
// incoming frames as soon as they arrive.
class BackgroundTransport final : public Transport {
 public:
  // Capacity of the queue in each direction: one second of a full bus. Beyond it, `send` refuses frames, and
  // incoming frames stay in the transport.
  static constexpr std::size_t kCapacity = 8192;

  explicit BackgroundTransport(std::unique_ptr<Transport> transport);
  // Sends the queued frames while the transport has room.
  ~BackgroundTransport() override;

  bool send(const hal::CanFrame& frame, std::uint64_t time_us) override;
  // Rethrows the thread's exception, once.
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

  std::unique_ptr<Transport> transport_;  // used by the thread only, except for constant properties

  std::mutex mutex_;  // protects the following members
  std::vector<Outgoing> outgoing_;
  std::vector<hal::CanFrame> arrived_;
  std::exception_ptr failure_;
  std::atomic<bool> has_arrived_ = false;  // or the thread has failed; checked without the lock
  std::atomic<std::uint64_t> dropped_ = 0;

  // Owned by the thread: frames to send, and received frames not yet handed over.
  std::vector<Outgoing> waiting_;
  std::size_t waiting_next_ = 0;
  std::vector<hal::CanFrame> fetched_;
  bool full_ = false;
  int rounds_ = 0;

  std::vector<hal::CanFrame> incoming_;  // owned by the simulation
  std::size_t incoming_next_ = 0;

  std::jthread thread_;  // declared last, so that it ends first
};

}  // namespace koboshi::sim_board
