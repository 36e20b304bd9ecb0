#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace koboshi::hal::stm32 {

// A lock-free queue between the program and an interrupt handler of the same core: one side only pushes, the
// other only pops, and neither masks interrupts. Each index has a single writer (Lamport 1977);
// release-acquire ordering publishes the item before the index.
template <typename T, std::size_t kCapacity>
class InterruptRing {
  static_assert(std::has_single_bit(kCapacity), "the free-running counters wrap at a power of two");

 public:
  // Called by the pushing side. Returns false, with the queue unchanged, if it is full.
  [[nodiscard]] bool push(const T& item) {
    const std::uint32_t pushed = pushed_.load(std::memory_order_relaxed);
    if (pushed - popped_.load(std::memory_order_acquire) == kCapacity) return false;
    items_[pushed % kCapacity] = item;
    pushed_.store(pushed + 1, std::memory_order_release);
    return true;
  }
  // Called by the popping side. Returns false, with `item` unchanged, if the queue is empty.
  [[nodiscard]] bool pop(T& item) {
    const std::uint32_t popped = popped_.load(std::memory_order_relaxed);
    if (pushed_.load(std::memory_order_acquire) == popped) return false;
    item = items_[popped % kCapacity];
    popped_.store(popped + 1, std::memory_order_release);
    return true;
  }
  // May be called by either side; the other side may change the result at any time.
  [[nodiscard]] std::size_t size() const {
    return pushed_.load(std::memory_order_relaxed) - popped_.load(std::memory_order_relaxed);
  }

 private:
  std::array<T, kCapacity> items_{};
  std::atomic<std::uint32_t> pushed_{0};
  std::atomic<std::uint32_t> popped_{0};
};

}  // namespace koboshi::hal::stm32
