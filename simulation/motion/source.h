#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/fixed/units.h"
#include "firmware/motion/instructions.h"
#include "simulation/motion/diagnostic.h"

namespace koboshi::simulation {

// A parsed motion file with the places for messages. docs/reference/motion-language.md describes the
// language.

struct PoseSource {
  std::string name;
  Place place = {};
  std::vector<std::optional<fixed::Angle>> angles = {};  // by joint; empty: the joint keeps its angle
  bool is_base = false;                                  // another pose is derived from it
};

// A value that a motion can read: a variable or a sensor. The numbers are those of the image.
struct SourceId {
  std::uint8_t number = 0;  // 0: variable `index`
  std::uint8_t index = 0;   // of the variable, joint or input

  friend bool operator==(const SourceId&, const SourceId&) = default;
};

// An expression in integers, or a condition. `items` are the operands.
struct Expression {
  enum class Kind : std::uint8_t {
    kInteger,
    kSource,
    kAdd,
    kSubtract,
    kMultiply,
    kDivide,
    kRemainder,
    kMin,
    kMax,
    kEqual,  // the comparisons in the order of the image
    kNotEqual,
    kLess,
    kLessEqual,
    kGreater,
    kGreaterEqual,
    kAnd,
    kOr,
    kNot,
  };

  Kind kind = Kind::kInteger;
  Place place = {};
  std::int32_t value = 0;
  SourceId source = {};
  std::vector<Expression> items = {};

  bool is_comparison() const { return kind >= Kind::kEqual && kind <= Kind::kGreaterEqual; }
  bool is_condition() const { return kind >= Kind::kEqual; }
};

// The tests of one branch as the image has them, for the low-level steps `branch` and `await`.
struct TestBlock {
  bool any = false;                    // of the tests must hold, instead of all
  bool negated = false;                // the branch is taken if the tests do not hold
  std::vector<Expression> tests = {};  // comparisons of a source with an integer or a variable
};

// The operators of `set`, in the order of the image.
enum class SetOperator : std::uint8_t {
  kAssign,
  kAdd,
  kSubtract,
  kMultiply,
  kDivide,
  kRemainder,
  kMin,
  kMax
};

struct Assignment {
  std::uint8_t variable = 0;
  SetOperator op = SetOperator::kAssign;
  Expression value;
};

struct StiffnessSetting {
  std::uint32_t joints = 0;  // mask
  std::uint8_t percent = 0;
};

// One feedback of the attitude to a joint, in the units of the image.
struct MixSetting {
  std::uint8_t joint = 0;
  std::uint8_t source = 0;  // 0 roll rate, 1 pitch rate, 2 yaw rate, 3 roll, 4 pitch
  std::int16_t gain = 0;    // 2^-12
  std::uint16_t limit = 0;  // 2^-16 turn

  friend bool operator==(const MixSetting&, const MixSetting&) = default;
};

struct LeanSetting {
  std::int16_t pitch = 0;  // 2^-16 turn, forward
  std::int16_t roll = 0;   // to the right

  friend bool operator==(const LeanSetting&, const LeanSetting&) = default;
};

struct StepSource {
  enum class Kind {
    kMove,
    kWait,
    kAwait,
    kLoop,
    kIf,
    kLabel,
    kJump,
    kExpect,
    kSet,
    kCall,
    kReturn,
    kFail,
    kStiffness,
    kMix,
    kLean,
    kEnd
  };
  enum class LoopKind { kTimes, kUntilStopped, kWhile, kUntil };
  // Interpolations in the order of the image.
  enum class Interpolation : std::uint8_t { kLinear, kMinimumJerk, kCubic };

  Kind kind = Kind::kEnd;
  Place place = {};
  std::size_t pose = 0;         // kMove: index of a pose
  std::uint32_t time_us = 0;    // kMove, kWait, kAwait (time-out)
  std::uint32_t speed_raw = 0;  // kMove: peak speed in 2^-24 turn/s; 0: `time_us` counts
  Interpolation interpolation = Interpolation::kLinear;
  std::uint32_t pause_us = 0;  // kMove; 0: none
  LoopKind loop = LoopKind::kTimes;
  std::uint16_t times = 0;                   // kLoop; 0: until stopped
  std::vector<StepSource> body = {};         // kLoop, kIf
  std::vector<StepSource> otherwise = {};    // kIf
  std::optional<Expression> condition = {};  // kLoop, kIf, kJump, kAwait
  std::optional<TestBlock> tests = {};       // kJump, kAwait: instead of the condition
  std::string label = {};                    // kLabel, kJump, kCall; kAwait: where to go at the time-out
  bool continues = false;                    // kAwait: goes on at the time-out; else it fails without label
  motion::ExpectedAttitude attitude = {};    // kExpect
  std::vector<Assignment> assignments = {};  // kSet
  std::vector<StiffnessSetting> stiffness = {};  // kStiffness, kMove
  std::vector<MixSetting> mix = {};              // kMix (empty: none any more), kMove
  std::optional<LeanSetting> lean = {};          // kLean, kMove
};

struct RoutineSource {
  std::string name;
  Place place = {};
  std::vector<StepSource> steps = {};
};

struct VariableSource {
  std::string name;
  Place place = {};
  std::int32_t initial = 0;
};

struct MotionSource {
  std::filesystem::path file;
  int version = 1;
  std::string name;
  std::string exit = {};  // label; empty: none
  Place exit_place = {};
  std::vector<VariableSource> variables = {};
  std::vector<PoseSource> poses = {};
  std::vector<RoutineSource> routines = {};
  std::vector<StepSource> steps = {};
};

}  // namespace koboshi::simulation
