#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/fixed/units.h"
#include "firmware/motion/instructions.h"

namespace koboshi::simulation {

// A parsed motion file with the line numbers for error messages. docs/reference/motion-format.md describes
// the language.

struct PoseSource {
  std::string name;
  int line = 0;
  std::vector<std::optional<fixed::Angle>> angles;  // by joint; empty: the joint keeps its angle
};

struct StepSource {
  enum class Kind { kMove, kWait, kLoop, kLabel, kJump, kExpect, kEnd };

  Kind kind = Kind::kEnd;
  int line = 0;
  std::size_t pose = 0;               // kMove: index of a pose
  std::uint32_t time_us = 0;          // kMove, kWait
  std::uint16_t times = 0;            // kLoop; 0: until stopped
  std::vector<StepSource> body;       // kLoop
  std::string label;                  // kLabel, kJump
  motion::ExpectedAttitude attitude;  // kExpect
};

struct MotionSource {
  std::filesystem::path file;
  std::string name;
  std::vector<PoseSource> poses;
  std::vector<StepSource> steps;
};

}  // namespace koboshi::simulation
