#include "simulation/motion_language/compile/decompile.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/core.h>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/motion/instructions.h"
#include "firmware/motion/motion.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/parse/parse.h"
#include "simulation/motion_language/parse/parse_settings.h"
#include "simulation/motion_language/parse/sensors.h"

namespace koboshi::simulation {
namespace {

using motion::Opcode;

constexpr std::array<std::string_view, 4> kInterpolations{"linear", "minimum_jerk", "cubic", "trapezoid"};
constexpr std::array<std::string_view, 6> kComparisonTexts{"==", "!=", "<", "<=", ">", ">="};
constexpr std::array<std::string_view, 8> kSetTexts{"", "+= ", "-= ", "*= ", "/= ", "%= ", "min= ", "max= "};
// Decimals of an angle of 14 bit: its resolution is 0.022 degrees.
constexpr double kAngleDecimals = 1e4;

// Keeps the digits that tell two neighbouring numbers apart.
double degrees_of(std::int16_t units) { return units * 360.0 / 65'536.0; }

class Decompiler {
 public:
  Decompiler(const motion::Motion& motion, const NamedModel& robot) : motion_(motion), robot_(robot) {}

  std::string text() {
    find_targets();
    text_ =
        fmt::format("version: 2\nrobot: {}\nname: {}\n", robot_.robot, quoted(std::string(motion_.name())));
    write_variables();
    if (motion_.exit_step() != motion::kNoStep) text_ += fmt::format("exit: s{}\n", motion_.exit_step());
    write_poses();
    write_routines();
    text_ += "steps:";
    write_steps(0, motion_.main_step_count(), "  ");
    return std::move(text_);
  }

 private:
  static std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char letter : text) {
      if (letter == '"' || letter == '\\') result += '\\';
      result += letter;
    }
    return result + "\"";
  }

  void find_targets() {
    if (motion_.exit_step() != motion::kNoStep) targets_.insert(motion_.exit_step());
    for (std::size_t i = 0; i < motion_.step_count(); ++i) {
      const motion::Step step = motion_.step(i);
      const bool jumps =
          step.opcode == Opcode::kJump || step.opcode == Opcode::kBranch || step.opcode == Opcode::kAwait;
      if (jumps && step.operand != motion::kNoStep) targets_.insert(step.operand);
      if (step.opcode == Opcode::kCall) routines_.insert(step.operand);
    }
  }

  void write_variables() {
    if (motion_.variable_count() == 0) return;
    text_ += "variables: {";
    for (std::size_t i = 0; i < motion_.variable_count(); ++i)
      text_ += fmt::format("{}v{}: 0", i == 0 ? "" : ", ", i);
    text_ += "}\n";
  }

  void write_poses() {
    if (motion_.pose_count() == 0) return;
    text_ += "poses:\n";
    for (std::size_t pose = 0; pose < motion_.pose_count(); ++pose) {
      text_ += fmt::format("  p{}: {{", pose);
      motion::PoseReader reader = motion_.pose_reader(pose);
      for (bool is_first = true; reader.joints() != 0; is_first = false) {
        std::size_t joint = 0;
        const fixed::Angle stored = reader.read(joint);
        const fixed::Angle angle = robot::clamp_to_limits(robot_.model.joints[joint], stored);
        const double degrees =
            std::round(fixed::to_double(angle) * kDegreesPerRad * kAngleDecimals) / kAngleDecimals;
        text_ +=
            fmt::format("{}{}: {}", is_first ? "" : ", ", robot_.joint_names[joint], number_text(degrees));
      }
      text_ += "}\n";
    }
  }

  void write_routines() {
    if (routines_.empty()) return;
    text_ += "routines:\n";
    for (auto entry = routines_.begin(); entry != routines_.end(); ++entry) {
      text_ += fmt::format("  r{}:", *entry);
      const auto next = std::next(entry);
      write_steps(*entry, next == routines_.end() ? motion_.step_count() : *next, "    ");
    }
  }

  void write_steps(std::size_t begin, std::size_t end, std::string indent) {
    text_ += "\n";
    std::size_t i = begin;
    while (i < end) {
      if (targets_.contains(i)) line(indent, fmt::format("{{label: s{}}}", i));
      const motion::Step step = motion_.step(i);
      if (step.opcode == Opcode::kLoopBegin) {
        line(indent, "loop:");
        const std::string repeats =
            step.operand == 0 ? "until: stopped" : fmt::format("times: {}", step.operand);
        text_ += fmt::format("{0}    {1}\n{0}    steps:", indent, repeats);
        indent += "      ";
        // An empty body would be no list.
        const bool is_empty = motion_.opcode(i + 1) == Opcode::kLoopEnd && !targets_.contains(i + 1);
        text_ += is_empty ? " []\n" : "\n";
      } else if (step.opcode == Opcode::kLoopEnd) {
        indent.resize(indent.size() - 6);
      } else {
        line(indent, step_text(i, step));
      }
      i += 1 + motion::attached_steps(step);
    }
  }

  void line(const std::string& indent, const std::string& step) { text_ += indent + "- " + step + "\n"; }

  std::string step_text(std::size_t index, const motion::Step& step) const {
    switch (step.opcode) {
      case Opcode::kMove:
        return move_text(index, motion::Move::of(step));
      case Opcode::kWait:
        return fmt::format("{{wait_s: {}}}", seconds(step.value));
      case Opcode::kJump:
        return fmt::format("{{jump: s{}}}", step.operand);
      case Opcode::kExpect:
        return expect_text(motion::ExpectedAttitude::of(step));
      case Opcode::kBranch:
        return fmt::format("{{branch: {{to: s{}, {}}}}}", step.operand, tests_text(index, step));
      case Opcode::kAwait:
        return fmt::format("{{await: {{{}{}, timeout_s: {}}}}}",
                           step.operand == motion::kNoStep ? "" : fmt::format("to: s{}, ", step.operand),
                           tests_text(index, step), seconds(step.value));
      case Opcode::kSet:
        return set_text(motion::Assignment::of(step));
      case Opcode::kCall:
        return fmt::format("{{call: r{}}}", step.operand);
      case Opcode::kReturn:
        return "return";
      case Opcode::kFail:
        return "fail";
      case Opcode::kMix:
        return mix_text(motion::Mix::of(step));
      case Opcode::kMixClear:
        return "{mix: none}";
      case Opcode::kStiffness:
        return share_text("stiffness", motion::Stiffness::of(step));
      case Opcode::kGain:
        return share_text("gain", motion::Gain::of(step));
      case Opcode::kLean: {
        const auto lean = motion::LeanDeclaration::of(step);
        return fmt::format("{{lean: {{pitch_deg: {}, roll_deg: {}}}}}", number_text(degrees_of(lean.pitch)),
                           number_text(degrees_of(lean.roll)));
      }
      default:
        return "end";
    }
  }

  static std::string seconds(std::uint32_t time_us) {
    return fmt::format("{}.{:06}", time_us / 1'000'000, time_us % 1'000'000);
  }

  std::string move_text(std::size_t index, const motion::Move& move) const {
    std::string text = fmt::format("{{pose: p{}, ", move.pose);
    if (move.by_speed) {
      text += "speed_deg_per_s: " + number_text(move.value * 360.0 / (1 << 24));
    } else {
      text += (move.at_least ? "at_least_s: " : "time_s: ") + seconds(move.value);
    }
    if (move.interpolation != motion::Interpolation::kLinear)
      text += fmt::format(", interpolation: {}",
                          kInterpolations.at(static_cast<std::size_t>(move.interpolation)));
    return text + during_text(index, move) + "}";
  }

  // In nanoseconds, with which a move of any length compiles to the same windows.
  std::string during_text(std::size_t index, const motion::Move& move) const {
    std::string text;
    for (std::size_t i = 1; i <= move.windows; ++i) {
      const auto window = motion::Window::of(motion_.step(index + i));
      const auto time_s = [&](std::uint16_t share) {
        return share * (move.value * 1e-6) / motion::Window::kWhole;
      };
      for (std::size_t joint = 0; joint < robot_.joint_names.size(); ++joint) {
        if ((window.joints >> joint & 1u) != 0)
          text += fmt::format("{}{}: [{:.9f}, {:.9f}]", text.empty() ? "" : ", ", robot_.joint_names[joint],
                              time_s(window.start), time_s(window.end));
      }
    }
    return text.empty() ? "" : ", during: {" + text + "}";
  }

  static std::string expect_text(const motion::ExpectedAttitude& expected) {
    return fmt::format("{{expect: {{up: [{}, {}, {}], min_cosine: {}}}}}", expected.up_B[0], expected.up_B[1],
                       expected.up_B[2], expected.min_cosine);
  }

  std::string source_text(motion::SourceRef ref) const {
    if (ref.source == motion::Source::kVariable) return fmt::format("v{}", ref.index);
    const Sensor& sensor = *find_sensor(ref.source);
    if (sensor.index == Sensor::Index::kJoint)
      return fmt::format("{}({})", sensor.name, robot_.joint_names[ref.index]);
    if (sensor.index == Sensor::Index::kInput) return fmt::format("{}({})", sensor.name, ref.index + 1);
    return std::string(sensor.name);
  }

  std::string tests_text(std::size_t index, const motion::Step& step) const {
    const auto condition = motion::Condition::of(step);
    std::string text = fmt::format("{}{}: [", condition.negated ? "not_" : "", condition.any ? "any" : "all");
    for (std::size_t i = 1; i <= condition.count; ++i) {
      const auto test = motion::Test::of(motion_.step(index + i));
      text += fmt::format("{}\"{} {} {}{}\"", i == 1 ? "" : ", ", source_text(test.left),
                          kComparisonTexts.at(static_cast<std::size_t>(test.comparison)),
                          test.with_variable ? "v" : "", test.right);
    }
    return text + "]";
  }

  std::string set_text(const motion::Assignment& assignment) const {
    const std::string right =
        assignment.from_source
            ? source_text(motion::SourceRef::of(static_cast<std::uint32_t>(assignment.right)))
            : std::to_string(assignment.right);
    return fmt::format("{{set: {{v{}: \"{}{}\"}}}}", assignment.variable,
                       kSetTexts.at(static_cast<std::size_t>(assignment.operation)), right);
  }

  std::string mix_text(const motion::Mix& mix) const {
    std::string text =
        fmt::format("{{mix: {{{}: {{{}: {}", robot_.joint_names[mix.joint],
                    kMixSources.at(static_cast<std::size_t>(mix.source)), number_text(mix.gain / 4096.0));
    if (mix.limit != 0)
      text += ", limit_deg: " + number_text(degrees_of(static_cast<std::int16_t>(mix.limit)));
    return text + "}}}";
  }

  template <typename Share>
  std::string share_text(std::string_view key, const Share& share) const {
    std::string text;
    for (std::size_t joint = 0; joint < robot_.joint_names.size(); ++joint) {
      if ((share.joints >> joint & 1u) != 0)
        text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", robot_.joint_names[joint], share.percent);
    }
    return fmt::format("{{{}: {{{}}}}}", key, text);
  }

  const motion::Motion& motion_;
  const NamedModel& robot_;
  std::set<std::size_t> targets_;
  std::set<std::size_t> routines_;
  std::string text_;
};

}  // namespace

std::string decompile_motion(std::span<const std::byte> image, const NamedModel& robot,
                             const std::string& source) {
  const std::string expected = "the image of a motion for " + robot.robot;
  if (!is_motion_image({reinterpret_cast<const char*>(image.data()), image.size()}))
    throw InputError(source, 0, describe(motion::MotionStatus::kBadMagic), expected);
  motion::Motion motion;
  const motion::MotionVerdict verdict = motion::Motion::open(image, robot.model, motion);
  if (!verdict.ok()) {
    throw InputError(source, 0, describe(verdict.status), expected);
  }
  if (const std::size_t size = motion.image_size_bytes(); size < image.size()) {
    throw InputError(source, 0, count_text(image.size() - size, "byte") + " behind the end of the image",
                     "the image alone, of " + count_text(size, "byte"));
  }
  return Decompiler(motion, robot).text();
}

}  // namespace koboshi::simulation
