#include "tests/fuzz/fuzz_input.h"
#include "tests/unit/firmware/canopen/test_node.h"

// A CANopen node, with its SDO server, PDOs, LSS and network management, between frames of the fuzzer. Each
// frame: milliseconds since the last one, identifier, size, data.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  canopen::TestNode node(0x10, canopen::kTestDevice);
  node.bytes.bytes = canopen::counted_bytes(300);
  node.make_operational();
  fuzz::Numbers numbers({data, size});
  std::uint64_t now_us = 0;
  while (!numbers.empty()) {
    now_us += 1000ull * numbers.byte();
    const std::uint16_t word = numbers.u16();
    hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(word & 0x7FF),
                        .size = static_cast<std::uint8_t>(std::min(word >> 12, 8)),
                        .remote = (word & 0x800) != 0};
    for (std::size_t i = 0; i < frame.size && !frame.remote; ++i) frame.data[i] = numbers.byte();
    node.hear(frame, now_us);
    node.node.process(now_us);
    if (node.bytes.open < 0 || node.bytes.open > 1) __builtin_trap();
    if (node.values.mode < -1 || node.values.mode > 10)
      __builtin_trap();  // the limits of 6060 and 607A, by any service
    if (node.values.target < -1000 || node.values.target > 1000) __builtin_trap();
    node.sink.frames.clear();
    node.written.clear();
  }
  return 0;
}
