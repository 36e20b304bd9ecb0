#include "simulation/scenario/reader.h"
#include "tests/fuzz/fuzz_input.h"

// A scenario (YAML), with the files of the default robot that it may name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("scenario.yaml");
  fuzz::read_or_refuse([&] { return simulation::read_scenario(file.with({data, size})); });
  return 0;
}
