#include "sim_board/description/servo_types.h"
#include "tests/fuzz/fuzz_input.h"

// A library of servo types (XML).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("servos.xml");
  fuzz::read_or_refuse([&] { return sim_board::read_servo_types(file.with({data, size})); });
  return 0;
}
