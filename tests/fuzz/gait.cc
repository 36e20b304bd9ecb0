#include "simulation/gait/gait.h"
#include "tests/fuzz/fuzz_input.h"

// A gait (YAML).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("gait.yaml");
  fuzz::read_or_refuse([&] { return simulation::read_gait(file.with({data, size})); });
  return 0;
}
