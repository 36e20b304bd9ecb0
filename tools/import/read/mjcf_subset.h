#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/import/robot/report.h"

namespace koboshi::tools {

// <joint> of <equality>: the angle of `joint` is `ratio` times that of `of`.
struct MjcfCoupling {
  std::string joint{};
  std::string of{};
  double ratio = 1.0;
  double offset_rad = 0.0;
};

// <connect> or <weld> of <equality>: a loop through both bodies.
struct MjcfLoop {
  std::string one{};
  std::string other{};
};

// The parts of an MJCF model that the import reads.
struct MjcfSubset {
  // The model with its includes in place, without elements and attributes that the import does not read:
  // lights, cameras, sensors, contacts, key frames, options of the solver. MuJoCo refuses what a newer
  // version has added, and most additions are of that kind. The range of `actuatorfrcrange` is in `user`,
  // which inherits from default classes in the same way.
  std::string text{};
  std::vector<int> lines{};                  // of the source, by line of `text`; both begin with 1
  std::map<std::string, int> joint_lines{};  // of the source, by name
  std::map<std::string, int> body_lines{};
  std::vector<MjcfCoupling> couplings{};
  std::vector<MjcfLoop> loops{};
  std::size_t tendons = 0;
};

// Makes the subset of the model in `text`, the content of `file`. Elements of no MJCF version become lines of
// `ignored`. Throws InputError for malformed XML, for an include that cannot be read, and for an element
// within a body that the import cannot leave out, such as <attach>.
[[nodiscard]] MjcfSubset mjcf_subset(const std::filesystem::path& file, const std::string& text,
                                     ImportReport& report);

}  // namespace koboshi::tools
