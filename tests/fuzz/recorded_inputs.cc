#include "tools/policy/recorded_inputs.h"

#include "tests/fuzz/fuzz_input.h"

// The recorded inputs of a policy (CSV). Each row has a number for each name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("trace.csv");
  const auto rows = fuzz::read_or_refuse([&] {
    return tools::read_recorded_columns(file.with({data, size}), {"roll", "pitch"});
  });
  if (!rows) return 0;
  if (rows->empty()) __builtin_trap();
  for (const auto& row : *rows) {
    if (row.size() != 2) __builtin_trap();
  }
  return 0;
}
