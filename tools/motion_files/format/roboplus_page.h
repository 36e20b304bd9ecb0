#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tools/motion_files/format/foreign_motion.h"

namespace koboshi::tools {

// A page of ROBOTIS motions (e-Manual, "RoboPlus Motion"; the structures of DARwIn-OP's Action module): up to
// seven steps of 31 servo positions. The text format and the binary one have the same contents.
struct RoboplusStep {
  static constexpr std::uint16_t kNotUsed = 0x4000;
  static constexpr std::uint16_t kTorqueOff = 0x2000;

  std::vector<std::uint16_t> positions{};  // by servo id, from 0
  double pause_s = 0.0;
  double time = 0.0;  // s, or with a schedule by speed a speed of 720/256 degrees/s
};

struct RoboplusPage {
  int number = 0;  // from 1
  std::string name{};
  int repeat = 1;
  int speed = 32;  // 32 is the speed of the file's times
  bool by_speed = false;
  int next = 0;  // page that follows; 0: none
  std::vector<RoboplusStep> steps{};
};

// Whether these bytes are a file of 256 binary pages, or its beginning: whole pages of 512 bytes, one of
// which has a right checksum, or whose contents are all plausible.
[[nodiscard]] bool is_roboplus_pages(std::string_view bytes);

// One motion for each page that is not empty: its steps, then those of the pages that follow it.
[[nodiscard]] std::vector<ForeignMotion> motions_of(MotionFormat format,
                                                    const std::vector<RoboplusPage>& pages,
                                                    const std::vector<ForeignNote>& notes);

}  // namespace koboshi::tools
