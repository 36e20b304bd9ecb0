#include "base/yaml/yaml_reader.h"
#include "simulation/scenario/reader.h"
#include "tests/fuzz/fuzz_input.h"

// The parameters of a robot (YAML).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static fuzz::InputFile file("parameters.yaml");
  fuzz::read_or_refuse([&] { return simulation::read_robot_parameters(YamlFile(file.with({data, size}))); });
  return 0;
}
