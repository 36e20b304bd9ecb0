#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace koboshi::hal::stm32 {

// A queue between the program and an interrupt handler of the same core: one side only pushes, the other only
// pops, and neither masks interrupts. Each index has one writer (Lamport 1977); release and acquire order it
// after the item.
template <typename T, std::size_t kCapacity>
class InterruptRing {
  static_assert(std::has_single_bit(kCapacity), "the free-running counters wrap at a power of two");

 public:
  // By the side that pushes. False, and the queue as it was, when it is full.
  [[nodiscard]] bool push(const T& item) {
    const std::uint32_t pushed = pushed_.load(std::memory_order_relaxed);
    if (pushed - popped_.load(std::memory_order_acquire) == kCapacity) return false;
    items_[pushed % kCapacity] = item;
    pushed_.store(pushed + 1, std::memory_order_release);
    return true;
  }
  // By the side that pops. False, and `item` untouched, when the queue is empty.
  [[nodiscard]] bool pop(T& item) {
    const std::uint32_t popped = popped_.load(std::memory_order_relaxed);
    if (pushed_.load(std::memory_order_acquire) == popped) return false;
    item = items_[popped % kCapacity];
    popped_.store(popped + 1, std::memory_order_release);
    return true;
  }
  // By either side; the other may change it at any time.
  [[nodiscard]] std::size_t size() const {
    return pushed_.load(std::memory_order_relaxed) - popped_.load(std::memory_order_relaxed);
  }

 private:
  std::array<T, kCapacity> items_{};
  std::atomic<std::uint32_t> pushed_{0};
  std::atomic<std::uint32_t> popped_{0};
};

}  // namespace koboshi::hal::stm32
