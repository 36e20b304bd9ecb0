#include "tests/fuzz/fuzz_input.h"
#include "view/recording/read_recording.h"

// A recording (MCAP).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("run.mcap");
  fuzz::read_or_refuse([&] { return view::read_recording(file.with({data, size})); });
  return 0;
}
