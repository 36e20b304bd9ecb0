#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "tests/fuzz/fuzz_input.h"

// A robot file (SDF), and the model for the firmware that is made of it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  const std::string text(fuzz::text_of({data, size}));
  const auto robot = fuzz::read_or_refuse([&] { return sim_board::load_robot("robot.sdf", text); });
  if (robot) fuzz::read_or_refuse([&] { return simulation::load_named_model(*robot); });
  return 0;
}
