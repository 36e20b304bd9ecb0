#include "simulation/motion/compile.h"

#include <array>
#include <map>
#include <optional>
#include <string_view>

#include "firmware/motion/instructions.h"
#include "sim_board/input/error.h"
#include "simulation/model/image_writer.h"
#include "simulation/motion/parse.h"
#include "simulation/motion/speed.h"

namespace koboshi::simulation {
namespace {

using motion::Opcode;
using sim::InputError;
using Kind = StepSource::Kind;

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

std::uint32_t joints_of(const PoseSource& pose) {
  std::uint32_t joints = 0;
  for (std::size_t i = 0; i < pose.angles.size(); ++i) joints |= pose.angles[i] ? 1u << i : 0u;
  return joints;
}

// The poses in the order of the image: grouped by the joints that they move, the groups and the poses of each
// as they come in the source. A pose without joints is in no group.
class PoseTable {
 public:
  struct Group {
    std::uint32_t joints = 0;
    std::vector<std::size_t> poses;  // of the source
  };

  explicit PoseTable(const MotionSource& motion) : numbers_(motion.poses.size()) {
    for (std::size_t i = 0; i < motion.poses.size(); ++i) {
      if (const std::uint32_t joints = joints_of(motion.poses[i]); joints != 0)
        group_of(joints).poses.push_back(i);
    }
    for (const Group& group : groups_) {
      for (const std::size_t pose : group.poses) {
        numbers_[pose] = static_cast<std::uint16_t>(order_.size());
        order_.push_back(pose);
      }
    }
  }

  const std::vector<Group>& groups() const { return groups_; }
  std::size_t size() const { return order_.size(); }
  // Returns the number in the image of a pose of the source; none for one without joints.
  std::optional<std::uint16_t> number(std::size_t pose) const { return numbers_[pose]; }
  // Returns the pose of the source that has this number in the image.
  std::size_t source(std::size_t number) const { return order_[number]; }

 private:
  Group& group_of(std::uint32_t joints) {
    for (Group& group : groups_) {
      if (group.joints == joints) return group;
    }
    return groups_.emplace_back(Group{joints, {}});
  }

  std::vector<Group> groups_;
  std::vector<std::optional<std::uint16_t>> numbers_;  // by pose of the source
  std::vector<std::size_t> order_;
};

// Writes the steps in the firmware's order and records the line of each.
class StepWriter {
 public:
  StepWriter(const MotionSource& motion, const PoseTable& poses) : motion_(motion), poses_(poses) {
    write(motion.steps);
    if (steps_.empty() || steps_.back().opcode != Opcode::kEnd || labels_at_end()) {
      add({Opcode::kEnd, 0, 0}, motion.steps.empty() ? 0 : motion.steps.back().line);
    }
    set_jump_targets();
  }

  const std::vector<motion::Step>& steps() const { return steps_; }
  int line(std::size_t index) const { return index < lines_.size() ? lines_[index] : 0; }

 private:
  void add(const motion::Step& step, int line) {
    if (steps_.size() == motion::kMaxSteps) {
      throw InputError(motion_.file, line, "more than " + std::to_string(motion::kMaxSteps) + " steps",
                       "fewer");
    }
    steps_.push_back(step);
    lines_.push_back(line);
  }

  std::uint16_t next_index() const { return static_cast<std::uint16_t>(steps_.size()); }

  bool labels_at_end() const {
    for (const auto& [label, index] : labels_) {
      if (index == steps_.size()) return true;
    }
    return false;
  }

  void write(const std::vector<StepSource>& steps) {
    for (const StepSource& step : steps) write(step);
  }

  void write(const StepSource& step) {
    switch (step.kind) {
      case Kind::kMove:
        return write_move(step);
      case Kind::kWait:
        return add({Opcode::kWait, 0, step.time_us}, step.line);
      case Kind::kLoop:
        return write_loop(step);
      case Kind::kLabel:
        return place_label(step);
      case Kind::kJump:
        jumps_.emplace_back(steps_.size(), &step);
        return add({Opcode::kJump, 0, 0}, step.line);
      case Kind::kExpect:
        return add(step.attitude.step(), step.line);
      case Kind::kEnd:
        return add({Opcode::kEnd, 0, 0}, step.line);
    }
  }

  // A move to a pose without joints is a wait.
  void write_move(const StepSource& step) {
    const std::optional<std::uint16_t> pose = poses_.number(step.pose);
    add({pose ? Opcode::kMove : Opcode::kWait, pose.value_or(0), step.time_us}, step.line);
  }

  void write_loop(const StepSource& loop) {
    const std::uint16_t begin = next_index();
    add({Opcode::kLoopBegin, loop.times, 0}, loop.line);
    write(loop.body);
    add({Opcode::kLoopEnd, begin, 0}, loop.line);
  }

  void place_label(const StepSource& step) {
    if (!labels_.emplace(step.label, next_index()).second) {
      throw InputError(motion_.file, step.line, "a second label '" + step.label + "'", "one of a name");
    }
  }

  void set_jump_targets() {
    for (const auto& [index, step] : jumps_) {
      const auto found = labels_.find(step->label);
      if (found == labels_.end()) {
        throw InputError(motion_.file, step->line, "a jump to '" + step->label + "'", "a label of this file");
      }
      steps_[index].operand = found->second;
    }
  }

  const MotionSource& motion_;
  const PoseTable& poses_;
  std::vector<motion::Step> steps_;
  std::vector<int> lines_;
  std::map<std::string, std::uint16_t> labels_;
  std::vector<std::pair<std::size_t, const StepSource*>> jumps_;
};

void write_name(ImageWriter& writer, const std::string& name) {
  for (std::size_t i = 0; i < motion::kNameSize; ++i) {
    writer.u8(i < name.size() ? static_cast<std::uint8_t>(name[i]) : std::uint8_t{0});
  }
}

// Writes the angles of the joints that the pose moves, one after the other without gaps.
void write_pose(ImageWriter& writer, const PoseSource& pose) {
  std::uint32_t buffer = 0;
  int bits = 0;
  const auto flush = [&](int least) {
    for (; bits >= least; bits -= 8, buffer >>= 8) writer.u8(static_cast<std::uint8_t>(buffer));
  };
  for (const auto& angle : pose.angles) {
    if (!angle) continue;
    constexpr std::uint32_t kMask = (1u << motion::kPoseBits) - 1;
    buffer |= (static_cast<std::uint32_t>(motion::pose_number(*angle)) & kMask) << bits;
    bits += motion::kPoseBits;
    flush(8);
  }
  flush(1);
}

void write_poses(ImageWriter& writer, const MotionSource& motion, const PoseTable& poses) {
  for (const PoseTable::Group& group : poses.groups()) {
    writer.u32(group.joints);
    writer.u16(static_cast<std::uint16_t>(group.poses.size()));
    writer.u16(0);
  }
  for (const PoseTable::Group& group : poses.groups()) {
    for (const std::size_t pose : group.poses) write_pose(writer, motion.poses[pose]);
  }
}

void write_steps(ImageWriter& writer, const std::vector<motion::Step>& steps) {
  for (const motion::Step& step : steps) {
    writer.u8(static_cast<std::uint8_t>(step.opcode));
    writer.u8(step.mode);
    writer.u16(step.operand);
    writer.u32(step.value);
  }
}

// Returns the source line of an error that the firmware's validator found.
int line_of(const motion::MotionVerdict& verdict, const MotionSource& motion, const PoseTable& poses,
            const StepWriter& steps) {
  using enum motion::MotionStatus;
  if (verdict.status == kBadPose || verdict.status == kBeyondLimits)
    return motion.poses[poses.source(verdict.index)].line;
  if (verdict.status == kBadGroup) return motion.poses[poses.groups()[verdict.index].poses.front()].line;
  return steps.line(verdict.index);
}

}  // namespace

std::string describe(motion::MotionStatus status) {
  return std::string(kMotionStatusTexts.at(static_cast<std::size_t>(status)));
}

std::vector<std::byte> compile_motion(const MotionSource& motion, const NamedModel& robot) {
  check_speeds(motion, robot);
  if (motion.poses.size() > motion::kMaxPoses) {
    throw InputError(motion.file, motion.poses.back().line, std::to_string(motion.poses.size()) + " poses",
                     "at most " + std::to_string(motion::kMaxPoses));
  }
  const PoseTable poses(motion);
  const StepWriter steps(motion, poses);
  ImageWriter writer;
  writer.u32(robot.model.id);
  write_name(writer, motion.name);
  writer.u8(static_cast<std::uint8_t>(robot.model.joint_count));
  writer.u8(0);  // variables
  writer.u8(static_cast<std::uint8_t>(poses.groups().size()));
  writer.u8(0);
  writer.u16(static_cast<std::uint16_t>(poses.size()));
  writer.u16(static_cast<std::uint16_t>(steps.steps().size()));
  writer.u16(motion::kNoStep);  // exit path
  writer.u16(0);
  write_poses(writer, motion, poses);
  write_steps(writer, steps.steps());
  std::vector<std::byte> image = writer.finish(motion::kMotionMagic, motion::kMotionVersion);
  motion::Motion opened;
  const motion::MotionVerdict verdict = motion::Motion::open(image, robot.model, opened);
  if (!verdict.ok()) {
    throw InputError(motion.file, line_of(verdict, motion, poses, steps), describe(verdict.status),
                     "a motion that the firmware accepts");
  }
  return image;
}

std::vector<std::byte> compile_motion(const std::filesystem::path& file, const NamedModel& robot,
                                      std::span<const sim::Override> overrides) {
  return compile_motion(parse_motion(file, robot, overrides), robot);
}

}  // namespace koboshi::simulation
