#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace koboshi::sim {

// The way from a sensor to the board: what enters at one time can be taken a whole number of microseconds
// later, in order. Where nobody takes anything, the oldest is lost, as in a sensor's own FIFO.
template <typename T>
class Delay {
 public:
  // Holds `capacity` items, at least one.
  Delay(std::uint64_t delay_us, std::size_t capacity) : delay_us_(delay_us), items_(capacity) {}

  void push(const T& value, std::uint64_t time_us) {
    if (size_ == items_.size()) drop_oldest();
    items_[(first_ + size_) % items_.size()] = {value, time_us + delay_us_};
    ++size_;
  }

  // Takes the oldest item. False, and `value` untouched, when none has arrived by `now_us`.
  [[nodiscard]] bool poll(std::uint64_t now_us, T& value) {
    if (size_ == 0 || items_[first_].arrival_us > now_us) return false;
    value = items_[first_].value;
    drop_oldest();
    return true;
  }

  void clear() { size_ = 0; }

 private:
  struct Item {
    T value{};
    std::uint64_t arrival_us = 0;
  };
  void drop_oldest() {
    first_ = (first_ + 1) % items_.size();
    --size_;
  }

  std::uint64_t delay_us_;
  std::vector<Item> items_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace koboshi::sim
