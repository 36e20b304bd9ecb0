#include "firmware/canopen/transmit_queue.h"

#include <limits>

namespace koboshi::canopen {

bool TransmitQueue::keep(const hal::CanFrame& frame) {
  if (rings_[hal::transmit_fifo(frame)].push(frame)) return true;
  if (lost_ < std::numeric_limits<std::uint16_t>::max()) ++lost_;
  return false;
}

void TransmitQueue::drain(FrameRing& ring) {
  while (ring.size() > 0 && sink_.send(ring.front())) ring.pop();
}

}  // namespace koboshi::canopen
