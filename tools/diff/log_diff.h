#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "sim_board/can/candump_log.h"

namespace koboshi::tools {

// The first difference of two CAN logs, with the frames around it.
struct LogDifference {
  std::size_t line = 0;                        // of the first difference, from 1
  std::vector<sim_board::LoggedFrame> before;  // equal in both logs
  std::vector<sim_board::LoggedFrame> a;       // from the difference on; empty if the log ends there
  std::vector<sim_board::LoggedFrame> b;

  // Time of the difference: the earlier of the two frames.
  std::uint64_t time_us() const;
};

inline constexpr std::size_t kFramesBefore = 4;
inline constexpr std::size_t kFramesAfter = 4;  // including the one that differs

// Throws InputError if a file cannot be read or a line is not a frame.
std::optional<LogDifference> compare_logs(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace koboshi::tools
