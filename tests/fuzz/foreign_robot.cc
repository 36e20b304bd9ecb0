#include "tests/fuzz/fuzz_input.h"
#include "tools/import/read/robot_reader.h"

// A robot of another maker (URDF, SDF; MJCF where the build has MuJoCo), without its meshes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("robot.urdf");
  fuzz::read_or_refuse([&] {
    tools::ImportReport report;
    return tools::read_foreign_robot(file.with({data, size}), report);
  });
  return 0;
}
