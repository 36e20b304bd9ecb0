#include "sim_board/can/transport/udp_multicast.h"
#include "tests/fuzz/fuzz_input.h"

// A datagram of a bus over UDP. A classic frame that is packed again is the same frame.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  const auto frame = sim_board::unpack_datagram({data, size});
  const auto* classic = frame ? std::get_if<hal::CanFrame>(&*frame) : nullptr;
  if (classic == nullptr) return 0;
  const sim_board::Datagram datagram = sim_board::pack_datagram(*classic, 0.0);
  if (sim_board::unpack_datagram(datagram.view()) != frame) __builtin_trap();
  return 0;
}
