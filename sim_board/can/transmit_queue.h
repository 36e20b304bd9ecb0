#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hal/port/can.h"

namespace koboshi::sim_board {

struct QueuedFrame {
  hal::CanFrame frame;
  std::uint64_t ready_us = 0;
};

// A transmit FIFO of a CAN controller with a fixed allocation.
class TransmitQueue {
 public:
  explicit TransmitQueue(std::size_t capacity) : slots_(capacity) { assert(capacity > 0); }

  bool empty() const { return size_ == 0; }
  std::size_t space() const { return slots_.size() - size_; }
  // Returns false if the FIFO is full.
  bool push(const QueuedFrame& frame) {
    if (space() == 0) return false;
    const std::size_t end = first_ + size_++;
    slots_[end < slots_.size() ? end : end - slots_.size()] = frame;
    return true;
  }
  const QueuedFrame& front() const { return slots_[first_]; }
  void pop() {
    assert(!empty());
    first_ = first_ + 1 == slots_.size() ? 0 : first_ + 1;
    --size_;
  }
  void clear() { first_ = size_ = 0; }

 private:
  std::vector<QueuedFrame> slots_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace koboshi::sim_board
