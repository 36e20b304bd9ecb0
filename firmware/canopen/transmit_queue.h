#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/canopen/frame.h"

namespace koboshi::canopen {

// Keeps in order what the sink has no room for, and counts what does not even fit here. Memory is the
// owner's.
class TransmitQueue final : public FrameSink {
 public:
  TransmitQueue(FrameSink& sink, std::span<hal::CanFrame> backlog) : sink_(sink), backlog_(backlog) {}

  // False, and counted in lost(), when sink and backlog are full.
  bool send(const hal::CanFrame& frame) override { return offer(frame) || keep(frame); }
  // Only for a sink that has room now; for frames that can wait. Never counted as lost.
  bool offer(const hal::CanFrame& frame) {
    flush();
    return size_ == 0 && sink_.send(frame);
  }
  // Hands the backlog to the sink as far as it has room.
  void flush() {
    if (size_ > 0) drain();
  }

  std::size_t backlog() const { return size_; }
  // Frames that were not sent; saturates.
  std::uint16_t lost() const { return lost_; }

 private:
  void drain();
  bool keep(const hal::CanFrame& frame);

  FrameSink& sink_;
  std::span<hal::CanFrame> backlog_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  std::uint16_t lost_ = 0;
};

}  // namespace koboshi::canopen
