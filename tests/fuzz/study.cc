#include "lab/tune/study.h"
#include "tests/fuzz/fuzz_input.h"

// A study (YAML).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("study.yaml");
  fuzz::read_or_refuse([&] { return lab::read_study(file.with({data, size})); });
  return 0;
}
