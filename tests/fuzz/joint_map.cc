#include "tools/motion_files/joint_map.h"

#include "sim_board/description/load.h"
#include "tests/fuzz/fuzz_input.h"

// The joints of a file of another maker by a map (YAML), for a motion with names, with numbers, and in the
// other direction. A joint that is found is one of the robot's.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static const sim_board::RobotDescription robot =
      sim_board::load_robot(std::string(KOBOSHI_SOURCE_DIR) + "/robots/koboshi/robot.sdf");
  static fuzz::InputFile file("map.yaml");
  const auto& path = file.with({data, size});
  for (const bool numbered : {false, true}) {
    tools::ForeignMotion motion;
    motion.unit = numbered ? tools::ForeignMotion::Unit::kTicks : tools::ForeignMotion::Unit::kRadians;
    for (int servo = 1; servo <= 3; ++servo) {
      tools::ForeignJoint joint{.name = numbered ? "servo " + std::to_string(servo) : "PelvR"};
      if (servo == 2 && !numbered) joint.name = "left_knee";
      if (numbered) joint.servo_id = servo;
      motion.joints.push_back(joint);
    }
    motion.sections = {{.frames = {{.place = "line 1", .move_us = 1'000, .values = {0.1, -0.2, 0.3}}}}};
    const auto map = fuzz::read_or_refuse([&] { return tools::find_joints("motion", motion, robot, path); });
    if (map && map->joints.size() != motion.joints.size()) __builtin_trap();
    for (std::size_t i = 0; map && i < map->joints.size(); ++i) {
      if (map->joints[i] && map->joints[i]->joint >= robot.joints.size()) __builtin_trap();
    }
    fuzz::read_or_refuse([&] { return tools::foreign_joints(robot, numbered, numbered, path); });
  }
  return 0;
}
