#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "sim_board/can/candump_log.h"

namespace koboshi::tools {

// The first frame in which two CAN logs differ, and what stands around it.
struct LogDifference {
  std::size_t line = 0;                  // of the first difference, from 1
  std::vector<sim::LoggedFrame> before;  // the same in both
  std::vector<sim::LoggedFrame> a;       // from the difference on; empty when the log ends there
  std::vector<sim::LoggedFrame> b;

  // When the runs part: the earlier of the two frames.
  std::uint64_t time_us() const;
};

inline constexpr std::size_t kFramesBefore = 4;
inline constexpr std::size_t kFramesAfter = 4;  // with the one that differs

// Throws sim::InputError when a file cannot be read or has a line that is no frame.
std::optional<LogDifference> compare_logs(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace koboshi::tools
