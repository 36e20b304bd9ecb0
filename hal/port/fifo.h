#pragma once

#include <array>
#include <cstddef>

namespace koboshi::hal {

// A first-in first-out queue of compile-time size.
template <typename T, std::size_t kCapacity>
class Fifo {
 public:
  // Appends an item. Returns false, with the queue unchanged, if it is full.
  [[nodiscard]] bool push(const T& item) {
    if (size_ == kCapacity) return false;
    items_[(first_ + size_++) % kCapacity] = item;
    return true;
  }
  // Removes the oldest item. Returns false, with `item` unchanged, if the queue is empty.
  [[nodiscard]] bool pop(T& item) {
    if (size_ == 0) return false;
    item = items_[first_];
    first_ = (first_ + 1) % kCapacity;
    --size_;
    return true;
  }

 private:
  std::array<T, kCapacity> items_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace koboshi::hal
