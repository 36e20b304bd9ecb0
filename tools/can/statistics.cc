#include "tools/can/statistics.h"

#include <fmt/core.h>

#include <algorithm>

#include "firmware/canopen/frame.h"
#include "sim_board/can/frame_bits.h"
#include "tools/can/describe.h"

namespace koboshi::tools {
namespace {

constexpr double kBitsPerSecond = 1e6;

constexpr const char* kKindNames[] = {"NMT", "SYNC", "EMCY", "TIME", "PDO", "SDO", "heartbeat", ""};

const char* name_of(FrameKind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

}  // namespace

void BusStatistics::add(const TimedFrame& timed) {
  const std::uint16_t identifier = timed.frame.identifier;
  const auto bits = static_cast<std::uint64_t>(sim::frame_bits(timed.frame) + sim::kIntermissionBits);
  if (frames_++ == 0) first_us_ = timed.time_us;
  last_us_ = timed.time_us;
  bits_ += bits;
  IdentifierStatistics& one = identifiers_[identifier];
  if (one.frames == 0) {
    one.first_us = timed.time_us;
  } else {
    one.shortest_us = std::min(one.shortest_us, timed.time_us - one.last_us);
    one.longest_us = std::max(one.longest_us, timed.time_us - one.last_us);
  }
  one.last_us = timed.time_us;
  one.bits += bits;
  ++one.frames;
  if (identifier == canopen::kSyncCobId) {
    sync_us_ = timed.time_us;
  } else if (sync_us_) {
    one.earliest_after_sync_us = std::min(one.earliest_after_sync_us, timed.time_us - *sync_us_);
    one.latest_after_sync_us = std::max(one.latest_after_sync_us, timed.time_us - *sync_us_);
  }
}

double BusStatistics::load() const {
  return duration_s() > 0.0 ? static_cast<double>(bits_) / kBitsPerSecond / duration_s() : 0.0;
}

std::string statistics_table(const BusStatistics& statistics) {
  std::string text = fmt::format("{} frames in {:.3f} s, {:.0f} frames/s, load {:.1f} %\n\n",
                                 statistics.frames(), statistics.duration_s(),
                                 statistics.duration_s() > 0.0
                                     ? static_cast<double>(statistics.frames()) / statistics.duration_s()
                                     : 0.0,
                                 100.0 * statistics.load());
  text += fmt::format("{:>4} {:<10}{:>9}{:>12}{:>12}{:>12}{:>22}\n", "id", "kind", "frames", "period ms",
                      "shortest", "longest", "after SYNC ms");
  for (const auto& [identifier, one] : statistics.identifiers()) {
    text += fmt::format("{:>4X} {:<10}{:>9}", identifier, name_of(kind_of({.identifier = identifier})),
                        one.frames);
    if (one.frames > 1) {
      text += fmt::format("{:>12.3f}{:>12.3f}{:>12.3f}", 1e-3 * one.mean_period_us(),
                          1e-3 * static_cast<double>(one.shortest_us),
                          1e-3 * static_cast<double>(one.longest_us));
    } else {
      text += fmt::format("{:>36}", "");
    }
    if (one.earliest_after_sync_us != UINT64_MAX) {
      text += fmt::format("{:>11.3f} to {:.3f}", 1e-3 * static_cast<double>(one.earliest_after_sync_us),
                          1e-3 * static_cast<double>(one.latest_after_sync_us));
    }
    text += '\n';
  }
  return text;
}

}  // namespace koboshi::tools
