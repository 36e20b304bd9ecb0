#include "simulation/motion/compile.h"

#include <array>
#include <map>
#include <string_view>

#include "sim_board/input/error.h"
#include "simulation/model/image_writer.h"
#include "simulation/motion/parse.h"
#include "simulation/motion/speed.h"

namespace koboshi::simulation {
namespace {

using motion::Opcode;
using sim::InputError;
using Kind = StepSource::Kind;

constexpr std::array<std::string_view, 19> kMotionStatusTexts{
    "a good motion",
    "a motion cut short",
    "something that is no motion image",
    "a motion image of another version",
    "a motion image with a wrong size",
    "a motion image with a CRC-32 that does not fit",
    "a motion for another robot, or for another version of it",
    "a number of joints, poses or steps beyond what the firmware takes",
    "a name that is empty or not printable",
    "a pose with joints that the robot has not",
    "an angle beyond its joint's limits",
    "a step of unknown kind",
    "a step's time out of range",
    "a step to a pose that is not there",
    "loops that are not nested properly, or too deep",
    "a jump out of its loop or past the end, or too many jumps",
    "no end",
    "a loop or a chain of jumps in which no time passes",
    "an attitude that is no direction",
};

// Writes the steps in the firmware's order and records the line of each.
class StepWriter {
 public:
  explicit StepWriter(const MotionSource& motion) : motion_(motion) {
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
        return add({Opcode::kMove, static_cast<std::uint16_t>(step.pose), step.time_us}, step.line);
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

void write_pose(ImageWriter& writer, const PoseSource& pose) {
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < pose.angles.size(); ++i) mask |= pose.angles[i] ? 1u << i : 0u;
  writer.u32(mask);
  for (const auto& angle : pose.angles) writer.quantity(angle.value_or(fixed::Angle()));
}

// Returns the source line of an error that the firmware's validator found.
int line_of(const motion::MotionVerdict& verdict, const MotionSource& motion, const StepWriter& steps) {
  const bool is_pose = verdict.status == motion::MotionStatus::kBadPose ||
                       verdict.status == motion::MotionStatus::kBeyondLimits;
  return is_pose ? motion.poses[verdict.index].line : steps.line(verdict.index);
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
  const StepWriter steps(motion);
  ImageWriter writer;
  writer.u32(robot.model.id);
  write_name(writer, motion.name);
  writer.u16(static_cast<std::uint16_t>(robot.model.joint_count));
  writer.u16(static_cast<std::uint16_t>(motion.poses.size()));
  writer.u16(static_cast<std::uint16_t>(steps.steps().size()));
  for (const PoseSource& pose : motion.poses) write_pose(writer, pose);
  for (const motion::Step& step : steps.steps()) {
    writer.u16(static_cast<std::uint16_t>(step.opcode));
    writer.u16(step.operand);
    writer.u32(step.time_us);
  }
  std::vector<std::byte> image = writer.finish(motion::kMotionMagic, motion::kMotionVersion);
  motion::Motion opened;
  const motion::MotionVerdict verdict = motion::Motion::open(image, robot.model, opened);
  if (!verdict.ok()) {
    throw InputError(motion.file, line_of(verdict, motion, steps), describe(verdict.status),
                     "a motion that the firmware accepts");
  }
  return image;
}

std::vector<std::byte> compile_motion(const std::filesystem::path& file, const NamedModel& robot,
                                      std::span<const sim::Override> overrides) {
  return compile_motion(parse_motion(file, robot, overrides), robot);
}

}  // namespace koboshi::simulation
