#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace koboshi::simulation {

enum class WhenFull {
  kWait,  // the producer waits; nothing is lost (lockstep)
  kDrop,  // the record is lost and counted; the producer never waits (real time)
};

// A single-producer, single-consumer queue of records of 64-bit words with a fixed allocation. The consumer
// is woken once per batch instead of per record, so the producer rarely makes a system call.
class Ring {
 public:
  struct Record {
    std::uint32_t kind = 0;
    std::span<const std::uint64_t> words;
  };

  // `capacity_words` must be a power of two of at least kBatches.
  Ring(std::size_t capacity_words, WhenFull when_full);

  // Producer: returns memory for a record of at most a quarter of the capacity, to be filled and published.
  // Empty if the record was dropped; then nothing must be published.
  std::span<std::uint64_t> claim(std::uint32_t kind, std::size_t words);
  void publish();
  // Producer: wakes the consumer for what has been published, before a batch is full.
  void hurry() { wake_consumer(); }
  // Producer: ends the stream.
  void close();
  std::uint64_t dropped() const { return dropped_; }

  // Consumer: waits for the next record, which is valid until released. Returns false if the ring is closed
  // and empty.
  [[nodiscard]] bool read(Record& record);
  void release();

  // A thread is woken after each of these parts of the capacity: often enough that neither waits for long,
  // seldom enough that system calls and changes of thread take less time than the writing.
  static constexpr std::size_t kBatches = 8;

 private:
  bool reserve(std::size_t words);
  bool has_space(std::size_t words) const;
  bool crosses_batch(std::uint64_t from, std::uint64_t to) const;
  void wake_consumer();
  void wake_producer();

  std::vector<std::uint64_t> words_;
  const std::uint64_t mask_;
  const std::uint64_t batch_mask_;
  const WhenFull when_full_;

  // Both count words without wrapping; their difference is the fill level. A record is a header and its
  // words, contiguous in memory.
  alignas(64) std::atomic<std::uint64_t> head_{0};  // written by the producer
  std::uint64_t claimed_until_ = 0;
  std::uint64_t dropped_ = 0;
  alignas(64) std::atomic<std::uint64_t> tail_{0};  // written by the consumer
  std::uint64_t read_until_ = 0;
  alignas(64) std::atomic<std::uint32_t> filled_{0};  // changes when the consumer should check again
  std::atomic<std::uint32_t> drained_{0};             // changes when the producer should check again
  std::atomic<bool> closed_{false};
};

}  // namespace koboshi::simulation
