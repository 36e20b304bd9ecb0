#include "tools/can/statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

#include "firmware/canopen/frame.h"
#include "sim_board/can/frame_bits.h"
#include "tools/can/describe.h"
#include "tools/table/table.h"

namespace koboshi::tools {
namespace {

constexpr double kBitsPerSecond = 1e6;

constexpr const char* kKindNames[] = {"NMT", "SYNC", "EMCY", "TIME", "PDO", "SDO", "heartbeat", ""};

template <typename Time>
std::string ms_text(Time time_us) {
  return fmt::format("{:.3f}", 1e-3 * static_cast<double>(time_us));
}

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
  std::vector<Row> rows;
  for (const auto& [identifier, one] : statistics.identifiers()) {
    const bool repeats = one.frames > 1;
    const bool follows_sync = one.earliest_after_sync_us != UINT64_MAX;
    rows.push_back({fmt::format("{:03X} {}", identifier, name_of(kind_of({.identifier = identifier}))),
                    std::to_string(one.frames), repeats ? ms_text(one.mean_period_us()) : "",
                    repeats ? ms_text(one.shortest_us) : "", repeats ? ms_text(one.longest_us) : "",
                    follows_sync
                        ? ms_text(one.earliest_after_sync_us) + " to " + ms_text(one.latest_after_sync_us)
                        : ""});
  }
  return text + table_text({"frame", "number", "period [ms]", "shortest", "longest", "after SYNC [ms]"}, rows,
                           TableStyle::kTerminal);
}

}  // namespace koboshi::tools
