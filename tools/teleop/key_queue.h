#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <optional>

#include "tools/teleop/key.h"

namespace koboshi::tools {

// Keys on their way from one thread to another; neither waits.
class KeyQueue {
 public:
  static constexpr std::size_t kCapacity = 64;

  // Returns false, and drops the key, if the queue is full.
  [[nodiscard]] bool push(Key key) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == kCapacity) return false;
    keys_[head % kCapacity] = key;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  [[nodiscard]] std::optional<Key> pop() {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return std::nullopt;
    const Key key = keys_[tail % kCapacity];
    tail_.store(tail + 1, std::memory_order_release);
    return key;
  }

 private:
  std::array<Key, kCapacity> keys_{};
  // Both count without wrapping.
  std::atomic<std::size_t> head_ = 0;  // written by the producer
  std::atomic<std::size_t> tail_ = 0;  // written by the consumer
};

}  // namespace koboshi::tools
