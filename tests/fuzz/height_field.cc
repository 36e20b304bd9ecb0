#include "simulation/scenario/height_file.h"
#include "tests/fuzz/fuzz_input.h"

// The heights of a ground (PGM or CSV).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("heights");
  fuzz::read_or_refuse([&] { return simulation::read_height_file(file.with({data, size})); });
  return 0;
}
