#include "simulation/record/ring.h"

#include <bit>
#include <cassert>

namespace koboshi::simulation {
namespace {

constexpr std::uint32_t kFiller =
    0xFFFFFFFF;  // marks unused words at the end of the memory, where a record did not fit

std::uint64_t make_header(std::uint32_t kind, std::size_t words) { return std::uint64_t{kind} << 32 | words; }

}  // namespace

Ring::Ring(std::size_t capacity_words, WhenFull when_full)
    : words_(capacity_words),
      mask_(capacity_words - 1),
      batch_mask_(~std::uint64_t{capacity_words / kBatches - 1}),
      when_full_(when_full) {
  assert(std::has_single_bit(capacity_words) && capacity_words >= kBatches);
}

std::span<std::uint64_t> Ring::claim(std::uint32_t kind, std::size_t words) {
  const std::size_t needed = words + 1;
  assert(words > 0 && needed <= words_.size() / 4 && kind != kFiller);
  const std::uint64_t head = head_.load(std::memory_order_relaxed);
  const std::size_t to_end = words_.size() - (head & mask_);
  const std::size_t filler = to_end < needed ? to_end : 0;
  if (!reserve(filler + needed)) {
    ++dropped_;
    return {};
  }
  if (filler > 0) words_[head & mask_] = make_header(kFiller, filler - 1);
  const std::uint64_t begin = (head + filler) & mask_;
  words_[begin] = make_header(kind, words);
  claimed_until_ = head + filler + needed;
  return {&words_[begin + 1], words};
}

bool Ring::has_space(std::size_t words) const {
  const std::uint64_t used = head_.load(std::memory_order_relaxed) - tail_.load(std::memory_order_acquire);
  return words_.size() - used >= words;
}

bool Ring::crosses_batch(std::uint64_t from, std::uint64_t to) const {
  return ((from ^ to) & batch_mask_) != 0;
}

bool Ring::reserve(std::size_t words) {
  while (!has_space(words)) {
    if (when_full_ == WhenFull::kDrop) return false;
    const std::uint32_t drained = drained_.load();
    wake_consumer();
    if (has_space(words)) break;
    drained_.wait(drained);
  }
  return true;
}

void Ring::publish() {
  const std::uint64_t before = head_.load(std::memory_order_relaxed);
  head_.store(claimed_until_, std::memory_order_release);
  if (crosses_batch(before, claimed_until_)) wake_consumer();
}

void Ring::close() {
  closed_.store(true);
  wake_consumer();
}

bool Ring::read(Record& record) {
  for (;;) {
    const std::uint32_t filled = filled_.load();
    const bool closed = closed_.load();
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail != head_.load(std::memory_order_acquire)) {
      const std::uint64_t header = words_[tail & mask_];
      const auto words = static_cast<std::size_t>(header & 0xFFFFFFFFu);
      record.kind = static_cast<std::uint32_t>(header >> 32);
      read_until_ = tail + words + 1;
      if (record.kind != kFiller) {
        record.words = {&words_[(tail & mask_) + 1], words};
        return true;
      }
      release();
    } else {
      if (closed) return false;
      wake_producer();  // the producer may need less space than a batch
      filled_.wait(filled);
    }
  }
}

void Ring::release() {
  const std::uint64_t before = tail_.load(std::memory_order_relaxed);
  tail_.store(read_until_, std::memory_order_release);
  if (crosses_batch(before, read_until_)) wake_producer();
}

void Ring::wake_consumer() {
  filled_.fetch_add(1);
  filled_.notify_one();
}

void Ring::wake_producer() {
  drained_.fetch_add(1);
  drained_.notify_one();
}

}  // namespace koboshi::simulation
