#include "tests/fuzz/fuzz_input.h"
#include "tools/import/decide/decisions.h"

// The decisions of an import (import.yaml).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("import.yaml");
  fuzz::read_or_refuse([&] { return tools::read_decisions(file.with({data, size})); });
  return 0;
}
