#include "sim_board/can/transport/slcan.h"
#include "tests/fuzz/fuzz_input.h"

// Characters of a host to a serial CAN adapter. Every frame that it takes is one of CAN 2.0A.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  sim_board::SlcanProtocol protocol;
  const std::string_view text = fuzz::text_of({data, size});
  for (std::size_t begin = 0; begin < text.size(); begin += 7)
    static_cast<void>(protocol.take(text.substr(begin, 7)));
  for (const hal::CanFrame& frame : protocol.frames()) {
    if (frame.identifier > 0x7FF || frame.size > 8) __builtin_trap();
    static_cast<void>(protocol.line_of(frame, 59'999'000));
  }
  return 0;
}
