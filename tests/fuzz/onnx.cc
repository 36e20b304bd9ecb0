#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/policy/policy.h"
#include "sim_board/description/load.h"
#include "simulation/policy/signal_names.h"
#include "tests/fuzz/fuzz_input.h"
#include "tools/policy/onnx_reader.h"
#include "tools/policy/quantise.h"

// A network (ONNX), from the bytes of the file to the image of a policy, for as many signals and joints as it
// has inputs and outputs. The firmware accepts every image that is made.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static const simulation::NamedModel robot = simulation::load_named_model(
      sim_board::load_robot(std::string(KOBOSHI_SOURCE_DIR) + "/robots/koboshi/robot.sdf"));
  static fuzz::InputFile file("net.onnx");
  const auto& path = file.with({data, size});
  const auto network = fuzz::read_or_refuse([&] { return tools::read_onnx(path); });
  if (!network || network->inputs() > policy::kMaxInputs) return 0;
  tools::PolicyMap map{.name = "fuzz"};
  static const auto signals = simulation::signal_names(robot.joint_names, {});
  for (std::size_t i = 0; i < network->inputs(); ++i) {
    const simulation::SignalName& signal = signals[i % signals.size()];
    map.inputs.push_back({.name = signal.name, .signal = signal.signal, .unit = signal.unit});
  }
  for (const char* const joint :
       {"left_ankle_roll", "right_ankle_roll", "left_ankle_pitch", "left_hip_roll"}) {
    if (map.outputs.size() == network->outputs()) break;
    const auto found = std::ranges::find(robot.joint_names, joint);
    map.outputs.push_back({.joint = joint,
                           .index = static_cast<std::uint8_t>(found - robot.joint_names.begin()),
                           .scale_rad = 0.1,
                           .bound_rad = 0.1,
                           .rate_rad_per_s = 1.0});
  }
  std::vector<std::vector<double>> rows(3, std::vector<double>(network->inputs()));
  for (std::size_t i = 0; i < network->inputs(); ++i) {
    rows[1][i] = 0.1;
    rows[2][i] = -0.2;
  }
  const auto quantised =
      fuzz::read_or_refuse([&] { return tools::quantise(*network, map, rows, robot, path); });
  policy::Policy policy;
  if (!quantised) return 0;
  if (const policy::PolicyVerdict opened = policy::Policy::open(quantised->image, robot.model, policy);
      !opened.ok()) {
    std::fprintf(stderr, "refused: %d at %u\n", static_cast<int>(opened.status), unsigned{opened.index});
    __builtin_trap();
  }
  return 0;
}
