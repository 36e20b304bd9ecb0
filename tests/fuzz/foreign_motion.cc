#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "tests/fuzz/fuzz_input.h"
#include "tools/motion_files/convert.h"
#include "tools/motion_files/format/readers.h"

// A motion of another maker, from the bytes of the file to the text of a motion file. Joint i of the file is
// joint i of the default robot.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static const simulation::NamedModel robot = simulation::load_named_model(
      sim_board::load_robot(std::string(KOBOSHI_SOURCE_DIR) + "/robots/koboshi/robot.sdf"));
  const auto motions = fuzz::read_or_refuse([&] {
    return tools::read_foreign_motions("motion", fuzz::text_of({data, size}));
  });
  if (!motions) return 0;
  for (const tools::ForeignMotion& motion : *motions) {
    tools::JointMap map;
    for (std::size_t i = 0; i < motion.joints.size(); ++i) {
      map.joints.emplace_back();
      if (i < robot.joint_names.size()) map.joints.back() = tools::MappedJoint{.joint = i, .unit_rad = 1e-3};
    }
    fuzz::read_or_refuse([&] {
      return tools::convert_motion("motion", motion, map, robot, {.retime = true, .largest_clamp_rad = {}});
    });
  }
  return 0;
}
