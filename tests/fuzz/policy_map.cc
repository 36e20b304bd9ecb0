#include "tools/policy/policy_map.h"

#include "sim_board/description/load.h"
#include "tests/fuzz/fuzz_input.h"

// How the inputs and outputs of a network are those of the default robot (YAML).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static const simulation::NamedModel robot = simulation::load_named_model(
      sim_board::load_robot(std::string(KOBOSHI_SOURCE_DIR) + "/robots/koboshi/robot.sdf"));
  static fuzz::InputFile file("map.yaml");
  fuzz::read_or_refuse([&] { return tools::read_policy_map(file.with({data, size}), robot); });
  return 0;
}
