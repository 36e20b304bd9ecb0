#include "simulation/motion_language/compile/compile.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "simulation/model/image_writer.h"
#include "simulation/motion_language/compile/lower.h"
#include "simulation/motion_language/compile/speed.h"
#include "simulation/motion_language/compile/zmp_path.h"
#include "simulation/motion_language/parse/codes.h"
#include "simulation/motion_language/parse/parse.h"

namespace koboshi::simulation {
namespace {

constexpr std::array<std::string_view, 26> kMotionStatusTexts{
    "a good motion",
    "a motion cut short",
    "something that is no motion image",
    "a motion image of another version",
    "a motion image with a wrong size",
    "a motion image with a CRC-32 that does not fit",
    "a motion for another robot, or for another version of it",
    "a number of joints, variables, poses or steps beyond what the firmware takes",
    "a name that is empty or not printable",
    "a pose with bits that belong to no joint",
    "an angle beyond its joint's limits",
    "a step of unknown kind",
    "a step's time out of range",
    "a step to a pose that is not there",
    "loops that are not nested properly, or too deep",
    "a jump out of its loop or past the end, or jumps too long in sum",
    "no end",
    "a loop or a chain of jumps in which no time passes",
    "an attitude that is no direction",
    "a group of poses without joints, with joints that the robot has not, or for the joints of another",
    "a test without a condition, or a condition without its tests",
    "a source or variable that is not there",
    "a subroutine called from itself or a later one, one that does not return, or too many",
    "loops and calls too deep together",
    "an exit path that begins within a loop or subroutine",
    "a joint, gain, limit or percentage out of range",
};

std::uint32_t mask_of(const PoseSource& pose) {
  std::uint32_t joints = 0;
  for (std::size_t i = 0; i < pose.angles.size(); ++i) joints |= pose.angles[i] ? 1u << i : 0u;
  return joints;
}

// The poses by the joints that they move, in the order in which each set of joints first occurs. A pose
// without joints is in no group.
struct PoseTable {
  struct Group {
    std::uint32_t joints = 0;
    std::vector<std::size_t> poses;  // of the source
  };

  std::vector<Group> groups;
  std::vector<std::optional<std::uint16_t>> numbers;  // in the image, by pose of the source
  std::vector<std::size_t> order;                     // the poses of the source, by number

  explicit PoseTable(const std::vector<PoseSource>& poses) : numbers(poses.size()) {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const std::uint32_t joints = mask_of(poses[i]);
      if (joints == 0) continue;
      const auto found = std::find_if(groups.begin(), groups.end(),
                                      [&](const Group& group) { return group.joints == joints; });
      (found == groups.end() ? groups.emplace_back(Group{joints, {}}) : *found).poses.push_back(i);
    }
    for (const Group& group : groups) {
      for (const std::size_t pose : group.poses) {
        numbers[pose] = static_cast<std::uint16_t>(order.size());
        order.push_back(pose);
      }
    }
  }
};

void check_poses(const MotionSource& motion, const PoseTable& table, Diagnostics& diagnostics) {
  const auto too_many = [&](const PoseSource& pose, const std::string& found, std::size_t limit) {
    diagnostics.add({.code = code::kTooMany,
                     .place = pose.place,
                     .found = found,
                     .expected = "at most " + std::to_string(limit)});
  };
  for (const PoseSource& pose : motion.poses) {
    if (mask_of(pose) != 0 || motion.version < 2) continue;
    diagnostics.add({.code = code::kEmptyPose,
                     .place = pose.place,
                     .found = "the pose '" + pose.name + "' without a joint",
                     .expected = "at least one joint"});
  }
  if (motion.poses.size() > motion::kMaxPoses) {
    too_many(motion.poses.back(), std::to_string(motion.poses.size()) + " poses", motion::kMaxPoses);
  }
  if (table.groups.size() > motion::kMaxPoseGroups) {
    too_many(motion.poses[table.groups.back().poses.front()],
             "poses with " + std::to_string(table.groups.size()) + " different sets of joints",
             motion::kMaxPoseGroups);
  }
}

void write_name(ImageWriter& writer, const std::string& name) {
  for (std::size_t i = 0; i < motion::kNameSize; ++i) {
    writer.u8(i < name.size() ? static_cast<std::uint8_t>(name[i]) : std::uint8_t{0});
  }
}

// Writes the angles of a pose, packed from bit 0 upwards.
void write_pose(ImageWriter& writer, const PoseSource& pose) {
  std::uint32_t buffer = 0;
  int bits = 0;
  for (const auto& angle : pose.angles) {
    if (!angle) continue;
    constexpr std::uint32_t kMask = (1u << motion::kPoseBits) - 1;
    buffer |= (static_cast<std::uint32_t>(motion::pose_number(*angle)) & kMask) << bits;
    for (bits += motion::kPoseBits; bits >= 8; bits -= 8) {
      writer.u8(static_cast<std::uint8_t>(buffer));
      buffer >>= 8;
    }
  }
  if (bits > 0) writer.u8(static_cast<std::uint8_t>(buffer));
}

// Returns the oldest version of the image that has these steps, so that motions which need nothing new keep
// their bytes and play on older firmware.
std::uint16_t version_of(const std::vector<motion::Step>& steps) {
  std::uint16_t version = motion::kOldestMotionVersion;
  for (const motion::Step& step : steps) {
    const auto move = motion::Move::of(step);
    if (step.opcode == motion::Opcode::kGain || step.opcode == motion::Opcode::kWindow)
      return motion::kGainVersion;
    if (step.opcode == motion::Opcode::kMove &&
        (move.at_least || move.interpolation > motion::Interpolation::kCubic))
      version = motion::kAtLeastVersion;
  }
  return version;
}

std::vector<std::byte> make_image(const MotionSource& motion, const NamedModel& robot, const PoseTable& table,
                                  const LoweredMotion& lowered) {
  ImageWriter writer;
  writer.u32(robot.model.id);
  write_name(writer, motion.name);
  writer.u8(static_cast<std::uint8_t>(robot.model.joint_count));
  writer.u8(static_cast<std::uint8_t>(lowered.variables));
  writer.u8(static_cast<std::uint8_t>(table.groups.size()));
  writer.u8(0);
  writer.u16(static_cast<std::uint16_t>(table.order.size()));
  writer.u16(static_cast<std::uint16_t>(lowered.steps.size()));
  writer.u16(lowered.exit);
  writer.u16(0);
  for (const PoseTable::Group& group : table.groups) {
    writer.u32(group.joints);
    writer.u16(static_cast<std::uint16_t>(group.poses.size()));
    writer.u16(0);
  }
  for (const std::size_t pose : table.order) write_pose(writer, motion.poses[pose]);
  for (const motion::Step& step : lowered.steps) {
    writer.u8(static_cast<std::uint8_t>(step.opcode));
    writer.u8(step.mode);
    writer.u16(step.operand);
    writer.u32(step.value);
  }
  return writer.finish(motion::kMotionMagic, version_of(lowered.steps));
}

// Returns the place of an error that the firmware's validator found.
Place place_of(const motion::MotionVerdict& verdict, const CompiledMotion& compiled,
               const MotionSource& motion, const PoseTable& table) {
  using motion::MotionStatus;
  const auto at = [&](const std::vector<Place>& places) {
    return verdict.index < places.size() ? places[verdict.index] : Place{};
  };
  if (verdict.status == MotionStatus::kBadPose || verdict.status == MotionStatus::kBeyondLimits)
    return at(compiled.pose_places);
  if (verdict.status == MotionStatus::kBadGroup && verdict.index < table.groups.size())
    return motion.poses[table.groups[verdict.index].poses.front()].place;
  if (verdict.status == MotionStatus::kBadExit) return motion.exit_place;
  return at(compiled.step_places);
}

// Warns of the first lean that a motion declares although it moves no leg: played beside another motion or
// the walk, as it is made for, its lean does not count.
void check_leans(const motion::Motion& motion, const CompiledMotion& compiled, const robot::RobotModel& model,
                 Diagnostics& diagnostics) {
  if ((motion.claimed_joints() & model.leg_joints()) != 0) return;
  for (std::size_t i = 0; i < motion.step_count(); ++i) {
    if (motion.opcode(i) != motion::Opcode::kLean) continue;
    diagnostics.add({.code = code::kLeanWithoutLegs,
                     .severity = Severity::kWarning,
                     .place = compiled.step_places[i],
                     .found = "a lean declared by a motion that moves no leg",
                     .expected = "none: beside another motion or the walk it does not count"});
    return;
  }
}

}  // namespace

std::string describe(motion::MotionStatus status) {
  return std::string(kMotionStatusTexts.at(static_cast<std::size_t>(status)));
}

CompiledMotion compile_motion(const MotionSource& source, const NamedModel& robot, Diagnostics& diagnostics) {
  if (diagnostics.has_errors()) return {};
  const MotionSource motion = with_zmp_paths(source, robot, diagnostics);
  if (diagnostics.has_errors()) return {};
  const PoseTable table(motion.poses);
  check_poses(motion, table, diagnostics);
  check_speeds(motion, robot, diagnostics);
  LoweredMotion lowered = lower_motion(motion, table.numbers, diagnostics);
  if (diagnostics.has_errors()) return {};
  CompiledMotion compiled;
  for (const std::size_t pose : table.order) {
    compiled.pose_places.push_back(motion.poses[pose].place);
    compiled.pose_names.push_back(motion.poses[pose].name);
  }
  compiled.image = make_image(motion, robot, table, lowered);
  compiled.step_places = std::move(lowered.places);
  motion::Motion opened;
  const motion::MotionVerdict verdict = motion::Motion::open(compiled.image, robot.model, opened);
  if (verdict.ok()) {
    check_leans(opened, compiled, robot.model, diagnostics);
    return compiled;
  }
  diagnostics.add({.code = code::kRefused,
                   .place = place_of(verdict, compiled, motion, table),
                   .found = describe(verdict.status),
                   .expected = "a motion that the firmware accepts"});
  return {};
}

std::vector<std::byte> compile_motion(const MotionSource& motion, const NamedModel& robot) {
  Diagnostics diagnostics(motion.file);
  CompiledMotion compiled = compile_motion(motion, robot, diagnostics);
  diagnostics.throw_errors();
  return std::move(compiled.image);
}

std::vector<std::byte> compile_motion(const std::filesystem::path& file, const NamedModel& robot,
                                      std::span<const Override> overrides) {
  const MotionFile read = read_motion_file(file, overrides);
  Diagnostics diagnostics(read.path, read.text);
  const MotionSource motion = parse_motion(read, robot, diagnostics);
  CompiledMotion compiled = compile_motion(motion, robot, diagnostics);
  diagnostics.throw_errors();
  return std::move(compiled.image);
}

}  // namespace koboshi::simulation
