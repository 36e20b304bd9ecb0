#include "bus/can/statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "base/table/table.h"
#include "base/text/text.h"
#include "bus/can/describe.h"
#include "firmware/canopen/frame.h"
#include "sim_board/can/frame_bits.h"

namespace koboshi::bus {
namespace {

constexpr const char* kKindNames[] = {"NMT", "SYNC", "EMCY", "TIME", "PDO", "SDO", "heartbeat", "LSS", ""};

template <typename Time>
std::string ms_text(Time time_us) {
  return fmt::format("{:.3f}", 1e-3 * static_cast<double>(time_us));
}

const char* name_of(FrameKind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

}  // namespace

void BusStatistics::add(const TimedFrame& timed) {
  const int length = std::visit([](const auto& frame) { return sim_board::frame_bits(frame); }, timed.frame);
  const auto bits = static_cast<std::uint64_t>(length > 0 ? length + sim_board::kIntermissionBits : 0);
  if (frames_++ == 0) {
    first_us_ = timed.time_us;
  } else {
    bits_ += bits;
  }
  last_us_ = timed.time_us;
  foreign_.add(timed.frame);
  if (timed.standard() == nullptr || timed.standard()->remote) return;
  const std::uint16_t identifier = timed.standard()->identifier;
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

double BusStatistics::load(double bits_per_s) const {
  return duration_s() > 0.0 ? static_cast<double>(bits_) / bits_per_s / duration_s() : 0.0;
}

std::string statistics_table(const BusStatistics& statistics, double bits_per_s) {
  const double load = statistics.load(bits_per_s);
  const double frames = static_cast<double>(statistics.frames());
  std::string text = fmt::format(
      "{} in {:.3f} s, {:.0f} frames/s, load {}\n", count_text(statistics.frames(), "frame"),
      statistics.duration_s(), statistics.duration_s() > 0.0 ? frames / statistics.duration_s() : 0.0,
      load <= 1.0 ? fmt::format("{:.1f} %", 100.0 * load)
                  : fmt::format("above 100 %: the times are closer than the frames are long at {:g} kbit/s",
                                1e-3 * bits_per_s));
  if (!statistics.foreign().empty()) text += fmt::format("not decoded: {}\n", statistics.foreign().text());
  text += '\n';
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

}  // namespace koboshi::bus
