#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/fixed/units.h"
#include "firmware/motion/instructions.h"
#include "simulation/motion_language/parse/diagnostic.h"

namespace koboshi::simulation {

// A parsed motion file with the places for messages. docs/reference/motion-language.md describes the
// language.

struct PoseSource {
  std::string name;
  Place place = {};
  std::vector<std::optional<fixed::Angle>> angles = {};  // by joint; empty: the joint keeps its angle
  bool is_base = false;                                  // another pose is derived from it
};

// An expression in integers, or a condition. `items` are its operands. Operations, comparisons and values are
// those of the image (firmware/motion/instructions.h).
struct Expression {
  enum class Kind : std::uint8_t { kInteger, kSource, kArithmetic, kComparison, kAnd, kOr, kNot };

  Kind kind = Kind::kInteger;
  Place place = {};
  std::int32_t value = 0;                                      // kInteger
  motion::SourceRef source = {};                               // kSource: a variable or a sensor
  motion::Arithmetic operation = motion::Arithmetic::kAssign;  // kArithmetic: any but kAssign
  motion::Comparison comparison = motion::Comparison::kEqual;  // kComparison
  std::vector<Expression> items = {};

  bool is_integer() const { return kind == Kind::kInteger; }
  bool is_source() const { return kind == Kind::kSource; }
  bool is_variable() const { return is_source() && source.source == motion::Source::kVariable; }
  bool is_comparison() const { return kind == Kind::kComparison; }
  bool is_condition() const { return kind >= Kind::kComparison; }
  // Whether a comparison is a test of the image: a source on the left, an integer or variable on the right.
  bool is_test() const {
    return is_comparison() && items[0].is_source() && (items[1].is_integer() || items[1].is_variable());
  }
};

// The tests of one branch in the form of the image, for the low-level steps `branch` and `await`.
struct TestBlock {
  bool any = false;                    // one of the tests must hold, instead of all
  bool negated = false;                // the branch is taken if the tests do not hold
  std::vector<Expression> tests = {};  // Expression::is_test()
};

// A change of a variable by `set`.
struct Assignment {
  std::uint8_t variable = 0;
  motion::Arithmetic operation = motion::Arithmetic::kAssign;
  Expression value;
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
    kGain,
    kMix,
    kLean,
    kEnd
  };
  enum class LoopKind { kTimes, kUntilStopped, kWhile, kUntil };

  Kind kind = Kind::kEnd;
  Place place = {};
  std::size_t pose = 0;         // kMove: index of a pose
  std::uint32_t time_us = 0;    // kMove, kWait, kAwait (time-out)
  std::uint32_t speed_raw = 0;  // kMove: peak speed in 2^-24 turn/s; 0: `time_us` counts
  bool at_least = false;        // kMove: `time_us` is the least time; each joint's speed limit may take more
  motion::Interpolation interpolation = motion::Interpolation::kLinear;  // kMove
  std::vector<motion::Window> windows = {};  // kMove: joints that turn in a part of `time_us` only
  bool zmp_path = false;                     // kMove: the ZMP goes straight to where the pose rests
  std::uint32_t pause_us = 0;                // kMove; 0: none
  LoopKind loop = LoopKind::kTimes;
  std::uint16_t times = 0;                   // kLoop; 0: until stopped
  std::vector<StepSource> body = {};         // kLoop, kIf
  std::vector<StepSource> otherwise = {};    // kIf
  std::optional<Expression> condition = {};  // kLoop, kIf, kJump, kAwait
  std::optional<TestBlock> tests = {};       // kJump, kAwait: instead of the condition
  std::string label = {};                    // kLabel, kJump, kCall; kAwait: target at the time-out
  bool continues = false;  // kAwait: continues at the time-out; otherwise it fails if there is no label
  motion::ExpectedAttitude attitude = {};            // kExpect
  std::vector<Assignment> assignments = {};          // kSet
  std::vector<motion::Stiffness> stiffness = {};     // kStiffness, kMove
  std::vector<motion::Gain> gain = {};               // kGain, kMove
  std::vector<motion::Mix> mix = {};                 // kMix (empty: removes all), kMove
  std::optional<motion::LeanDeclaration> lean = {};  // kLean, kMove
};

// The part of a move's time in which a joint turns.
[[nodiscard]] inline motion::Window window_of(const StepSource& move, std::size_t joint) {
  for (const motion::Window& window : move.windows) {
    if ((window.joints >> joint & 1u) != 0) return window;
  }
  return {};
}

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
