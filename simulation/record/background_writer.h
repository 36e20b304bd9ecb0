#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <thread>

#include "simulation/record/ring.h"

namespace koboshi::simulation {

// A thread that writes what a simulation puts into a ring, so that a step neither formats nor waits for the
// disk. The first error ends the writing; it is reported to the producer.
class BackgroundWriter {
 public:
  static constexpr std::size_t kDefaultRingWords = std::size_t{1}
                                                   << 16;  // 512 KiB, more than a second of a walk

  // `write` is called in the thread for each record and may throw.
  BackgroundWriter(std::size_t ring_words, WhenFull when_full,
                   std::function<void(const Ring::Record&)> write);
  // Writes the remaining records and ignores errors: call `close` first to detect them.
  ~BackgroundWriter() { finish(); }
  BackgroundWriter(const BackgroundWriter&) = delete;
  BackgroundWriter& operator=(const BackgroundWriter&) = delete;

  // As Ring::claim, Ring::publish and Ring::hurry.
  std::span<std::uint64_t> claim(std::uint32_t kind, std::size_t words) { return ring_.claim(kind, words); }
  void publish() { ring_.publish(); }
  void hurry() { ring_.hurry(); }
  // Throws the error, if there was one.
  void check() const {
    if (failed_.load(std::memory_order_acquire)) std::rethrow_exception(error_);
  }

  // Writes all records and ends the thread; nothing may be claimed afterwards. Throws the error.
  void close();
  // Number of records lost because the ring was full.
  std::uint64_t dropped() const { return ring_.dropped(); }

 private:
  void write_records();
  void finish();

  Ring ring_;
  const std::function<void(const Ring::Record&)> write_;
  std::exception_ptr error_;  // of the thread; read after it has ended or once failed_ is set
  std::atomic<bool> failed_ = false;
  std::thread writer_;
};

}  // namespace koboshi::simulation
