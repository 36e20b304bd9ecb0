#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace koboshi::sim {

enum class WhenFull {
  kWait,  // the producer waits: nothing is lost (lockstep)
  kDrop,  // the record is lost and counted: the producer is never held up (real time)
};

// A queue of records of 64-bit words from one producer thread to one consumer thread, in memory taken once.
// The consumer is woken a batch at a time, not for each record, so that the producer hardly ever enters the
// kernel.
class Ring {
 public:
  struct Record {
    std::uint32_t kind = 0;
    std::span<const std::uint64_t> words;
  };

  // The capacity is a power of two of at least kBatchWords.
  Ring(std::size_t capacity_words, WhenFull when_full);

  // Producer. Memory for a record of at most a quarter of the capacity, to be filled and published; empty
  // when it was dropped, and then there is nothing to publish.
  std::span<std::uint64_t> claim(std::uint32_t kind, std::size_t words);
  void publish();
  // No record follows.
  void close();
  std::uint64_t dropped() const { return dropped_; }

  // Consumer. Waits for the next record, which is valid until it is released. False once the ring is closed
  // and empty.
  [[nodiscard]] bool read(Record& record);
  void release();

  static constexpr std::size_t kBatchWords = 2048;

 private:
  bool reserve(std::size_t words);
  bool has_space(std::size_t words) const;
  void wake_consumer();
  void wake_producer();

  std::vector<std::uint64_t> words_;
  const std::uint64_t mask_;
  const WhenFull when_full_;

  // Both count words for ever; their difference is what is in the ring. A record is a header and its words,
  // in one piece.
  alignas(64) std::atomic<std::uint64_t> head_{0};  // written by the producer
  std::uint64_t claimed_until_ = 0;
  std::uint64_t dropped_ = 0;
  alignas(64) std::atomic<std::uint64_t> tail_{0};  // written by the consumer
  std::uint64_t read_until_ = 0;
  alignas(64) std::atomic<std::uint32_t> filled_{0};  // changes when the consumer should look again
  std::atomic<std::uint32_t> drained_{0};             // changes when the producer should look again
  std::atomic<bool> closed_{false};
};

}  // namespace koboshi::sim
