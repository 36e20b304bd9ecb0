#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "sim_board/random/random_stream.h"

namespace koboshi::sim_board {

// Deviation of a sampling instant from its nominal time: a whole number of microseconds, uniform within
// +-largest, independent from instant to instant.
class Jitter {
 public:
  Jitter(std::uint64_t largest_us, std::uint64_t seed, std::string_view name);

  // Returns the deviation of the next instant.
  std::int64_t sample_us();
  std::uint64_t largest_us() const { return static_cast<std::uint64_t>(largest_us_); }

 private:
  std::int64_t largest_us_;
  RandomStream random_;
};

// Clock of a sensor: sampling instants at whole multiples of its period, independent of the physics step,
// each displaced by its jitter.
class Sampler {
 public:
  struct Instant {
    std::uint64_t nominal_us = 0;
    std::uint64_t actual_us = 0;
  };

  // Largest jitter for which consecutive instants are at least 1 us apart.
  static std::uint64_t max_jitter_us(std::uint64_t period_us) { return (period_us - 1) / 2; }

  // Throws std::invalid_argument for a period of zero and for jitter above max_jitter_us().
  Sampler(std::uint64_t period_us, const Jitter& jitter);

  // Schedules the first instant nominally at the first multiple of the period after `time_us`, and actually
  // not before `time_us`.
  void start(std::uint64_t time_us);
  bool due(std::uint64_t time_us) const { return next_.actual_us <= time_us; }
  // Returns the next instant and schedules the one after it.
  Instant take();

 private:
  void schedule(std::uint64_t nominal_us);

  std::uint64_t period_us_;
  Jitter jitter_;
  Instant next_;
};

// Transport delay from a sensor to the board: a FIFO whose items can be taken a fixed time after they entered
// it. When it is full, the oldest item is lost, as in the FIFO of a sensor chip.
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

  // Takes the oldest item. Returns false and leaves `value` unchanged if none has arrived by `now_us`.
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

}  // namespace koboshi::sim_board
