#include "firmware/canopen/transmit_queue.h"

#include <limits>

namespace koboshi::canopen {

bool TransmitQueue::send(const hal::CanFrame& frame) {
  flush();
  if (size_ == 0 && sink_.send(frame)) return true;
  if (size_ == backlog_.size()) {
    if (lost_ < std::numeric_limits<std::uint16_t>::max()) ++lost_;
    return false;
  }
  backlog_[(first_ + size_) % backlog_.size()] = frame;
  ++size_;
  return true;
}

void TransmitQueue::flush() {
  while (size_ > 0 && sink_.send(backlog_[first_])) {
    first_ = (first_ + 1) % backlog_.size();
    --size_;
  }
}

}  // namespace koboshi::canopen
