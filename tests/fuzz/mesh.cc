#include "tests/fuzz/fuzz_input.h"
#include "view/capture/stl.h"

// A mesh (STL, binary or ASCII). A damaged one is a finding of the robot's check, no error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("mesh.stl");
  const view::StlFile mesh = view::read_stl(file.with({data, size}));
  if (mesh.mesh.has_value() != mesh.fault.empty()) __builtin_trap();
  return 0;
}
