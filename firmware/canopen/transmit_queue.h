#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "firmware/canopen/frame.h"
#include "firmware/fixed/contract.h"

namespace koboshi::canopen {

// A queue of frames in memory that the owner provides.
class FrameRing {
 public:
  explicit FrameRing(std::span<hal::CanFrame> slots) : slots_(slots) {}

  // False when it is full.
  bool push(const hal::CanFrame& frame) {
    if (size_ == slots_.size()) return false;
    slots_[(first_ + size_++) % slots_.size()] = frame;
    return true;
  }
  // The ring must not be empty.
  const hal::CanFrame& front() const {
    KOBOSHI_ASSERT(size_ > 0);
    return slots_[first_];
  }
  void pop() {
    KOBOSHI_ASSERT(size_ > 0);
    first_ = (first_ + 1) % slots_.size();
    --size_;
  }
  std::size_t size() const { return size_; }

 private:
  std::span<hal::CanFrame> slots_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

// Queues frames for which the sink has no room, in order, and counts those for which the queue has none. Each
// FIFO of the port has its own order: a heartbeat that waits delays no PDO.
class TransmitQueue final : public FrameSink {
 public:
  // Frames that may wait: two answers of each of two servers; an SDO request, the abort of a request that
  // timed out, an answer of LSS, and one in reserve (set by hand, 2026-11-23). Heartbeats never wait here.
  static constexpr std::size_t kAnswerBacklog = 4;
  static constexpr std::size_t kBackgroundBacklog = 4;

  // `backlog` holds frames of the process FIFO; the owner provides it.
  TransmitQueue(FrameSink& sink, std::span<hal::CanFrame> backlog)
      : sink_(sink), rings_{FrameRing(backlog), FrameRing(answer_backlog_), FrameRing(background_backlog_)} {}
  TransmitQueue(const TransmitQueue&) = delete;
  TransmitQueue& operator=(const TransmitQueue&) = delete;

  // False, and counted in lost(), when sink and backlog are full.
  bool send(const hal::CanFrame& frame) override { return offer(frame) || keep(frame); }
  // Sends a frame only if the sink has room now; for frames that may be sent later. Never counted as lost.
  bool offer(const hal::CanFrame& frame) {
    if (muted_) return true;
    FrameRing& ring = rings_[hal::transmit_fifo(frame)];
    if (ring.size() > 0) drain(ring);
    return ring.size() == 0 && sink_.send(frame);
  }
  // Sends the backlog as far as the sink has room.
  void flush() {
    for (FrameRing& ring : rings_) {
      if (ring.size() > 0) drain(ring);
    }
  }

  bool pending(hal::TransmitFifo fifo) const override {
    return rings_[fifo].size() > 0 || sink_.pending(fifo);
  }
  // While muted, drops frames that are sent; those that wait already are not dropped.
  void mute(bool muted) { muted_ = muted; }
  std::size_t backlog() const {
    return rings_[hal::kProcessFifo].size() + rings_[hal::kAnswerFifo].size() +
           rings_[hal::kBackgroundFifo].size();
  }
  // Frames that were lost; saturates.
  std::uint16_t lost() const { return lost_; }

 private:
  bool keep(const hal::CanFrame& frame) {
    if (rings_[hal::transmit_fifo(frame)].push(frame)) return true;
    if (lost_ < std::numeric_limits<std::uint16_t>::max()) ++lost_;
    return false;
  }
  void drain(FrameRing& ring) {
    while (ring.size() > 0 && sink_.send(ring.front())) ring.pop();
  }

  FrameSink& sink_;
  std::array<hal::CanFrame, kAnswerBacklog> answer_backlog_{};
  std::array<hal::CanFrame, kBackgroundBacklog> background_backlog_{};
  std::array<FrameRing, hal::kTransmitFifos> rings_;  // by TransmitFifo
  std::uint16_t lost_ = 0;
  bool muted_ = false;
};

}  // namespace koboshi::canopen
