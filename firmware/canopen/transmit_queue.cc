#include "firmware/canopen/transmit_queue.h"

#include <limits>

namespace koboshi::canopen {

bool TransmitQueue::keep(const hal::CanFrame& frame) {
  if (size_ == backlog_.size()) {
    if (lost_ < std::numeric_limits<std::uint16_t>::max()) ++lost_;
    return false;
  }
  backlog_[(first_ + size_) % backlog_.size()] = frame;
  ++size_;
  return true;
}

void TransmitQueue::drain() {
  while (size_ > 0 && sink_.send(backlog_[first_])) {
    first_ = (first_ + 1) % backlog_.size();
    --size_;
  }
}

}  // namespace koboshi::canopen
