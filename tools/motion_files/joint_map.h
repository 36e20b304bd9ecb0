#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim_board/description/description.h"
#include "simulation/model/robot_model.h"
#include "tools/motion_files/format/foreign_motion.h"

namespace koboshi::tools {

// How the values of one joint of a motion file become angles of a robot's joint:
//   angle = sign * (value - zero) * unit_rad
struct MappedJoint {
  std::size_t joint = 0;  // of the robot
  double sign = 1.0;      // 1 or -1
  double zero = 0.0;      // value at joint angle zero, in the file's unit
  double unit_rad = 1.0;  // of the file's values: 1 for rad, or a tick
};

// By joint of the file; nothing: its values are dropped.
struct JointMap {
  std::vector<std::optional<MappedJoint>> joints{};
  std::vector<ForeignNote> notes{};  // what was guessed or dropped
};

class JointMapFile;

// Finds the robot's joint for each joint of the file, in this order:
//   - in the map of `map`, if there is one;
//   - a numbered servo by the robot's `koboshi:maker`;
//   - by the name that the joint has in the file from which the robot was imported (import.yaml beside the
//     robot's file), with the sign and the zero of that file, which are those of the drive's shaft;
//   - by the name that a joint of a DARwIn-OP has in Webots or in its URDF, with that robot's sign;
//   - by its name, if exactly one joint or role has it or means the same. Where more of the angles are within
//     the joint's limits with the opposite sign, it is taken, and for the pitch of hips and ankles where the
//     soles are then much more level.
// Throws InputError, naming `file`, if no joint of the file is found, or a numbered servo is not, because a
// motion without a part of its joints is another motion; the message says what to do.
[[nodiscard]] JointMap find_joints(const std::filesystem::path& file, const ForeignMotion& motion,
                                   const sim_board::RobotDescription& robot,
                                   const JointMapFile* map = nullptr);
// The same with the map of a file, which is none if its path is empty.
[[nodiscard]] JointMap find_joints(const std::filesystem::path& file, const ForeignMotion& motion,
                                   const sim_board::RobotDescription& robot,
                                   const std::filesystem::path& map_file);

// The joints of the robot itself, in their order, in rad.
[[nodiscard]] JointMap same_joints(const simulation::NamedModel& robot);

// How a file names or numbers a joint of the robot, and counts its angle.
struct NamedForeignJoint {
  ForeignJoint joint;
  MappedJoint mapped;
};

// The reverse, by joint of the robot: the names or, if `numbered`, the numbers that its joints have in files
// of another maker. They are those of the map file, then numbers are the robot's `koboshi:maker` and names
// its own. Nothing for a joint that has no number.
[[nodiscard]] std::vector<std::optional<NamedForeignJoint>> foreign_joints(
    const sim_board::RobotDescription& robot, bool numbered, bool ticks,
    const std::filesystem::path& map_file = {});

}  // namespace koboshi::tools
