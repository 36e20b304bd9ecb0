#include "tools/diff/log_diff.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace koboshi::tools {
namespace {

// Returns `first` and the frames after it.
std::vector<sim_board::LoggedFrame> take(std::optional<sim_board::LoggedFrame> first,
                                         sim_board::CandumpReader& reader) {
  std::vector<sim_board::LoggedFrame> frames;
  for (; first && frames.size() < kFramesAfter; first = reader.next()) frames.push_back(*first);
  return frames;
}

}  // namespace

std::uint64_t LogDifference::time_us() const {
  std::uint64_t earliest_us = std::numeric_limits<std::uint64_t>::max();
  if (!a.empty()) earliest_us = a.front().time_us;
  if (!b.empty()) earliest_us = std::min(earliest_us, b.front().time_us);
  return earliest_us;
}

std::optional<LogDifference> compare_logs(const std::filesystem::path& file_a,
                                          const std::filesystem::path& file_b) {
  sim_board::CandumpReader reader_a(file_a);
  sim_board::CandumpReader reader_b(file_b);
  std::vector<sim_board::LoggedFrame> before;
  for (std::size_t line = 1;; ++line) {
    const auto a = reader_a.next();
    const auto b = reader_b.next();
    if (a != b) return LogDifference{line, before, take(a, reader_a), take(b, reader_b)};
    if (!a) return std::nullopt;
    if (before.size() == kFramesBefore) before.erase(before.begin());
    before.push_back(*a);
  }
}

}  // namespace koboshi::tools
