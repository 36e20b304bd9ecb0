#include "sim_board/can/babbler.h"

namespace koboshi::sim_board {

Babbler::Babbler(Bus& bus, const Babble& babble)
    : bus_(bus),
      babble_(babble),
      handle_(bus.attach(*this, AcceptanceFilter(), kTransmitFifo)),
      next_us_(babble.from_us) {
  bus_.power_off(handle_);
}

void Babbler::advance(std::uint64_t end_us) {
  if (bus_.now_us() >= babble_.until_us) return bus_.power_off(handle_);
  if (end_us <= babble_.from_us) return;
  bus_.power_on(handle_);
  if (babble_.interval_us == 0) {
    const hal::TransmitFifo fifo = hal::transmit_fifo(babble_.frame);
    while (bus_.transmit_space(handle_, fifo) > 0)
      static_cast<void>(bus_.queue(handle_, babble_.frame, next_us_));
    return;
  }
  // Frames that find no room are lost.
  for (; next_us_ < end_us && next_us_ < babble_.until_us; next_us_ += babble_.interval_us)
    static_cast<void>(bus_.queue(handle_, babble_.frame, next_us_));
}

void Babbler::archive(StateArchive& archive) { archive(next_us_); }

}  // namespace koboshi::sim_board
