#include "bus/can/device_file.h"
#include "tests/fuzz/fuzz_input.h"

// An electronic data sheet or a device configuration file (EDS, DCF).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("device.eds");
  fuzz::read_or_refuse([&] { return bus::read_device_file(file.with({data, size}), 0x10); });
  return 0;
}
