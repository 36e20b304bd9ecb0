#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "bus/can/describe.h"
#include "bus/can/source.h"

namespace koboshi::bus {

// Frames, bits and periods of one identifier.
struct IdentifierStatistics {
  std::uint64_t frames = 0;
  std::uint64_t bits = 0;  // with stuff bits and intermission
  std::uint64_t first_us = 0;
  std::uint64_t last_us = 0;
  std::uint64_t shortest_us = UINT64_MAX;  // between two frames
  std::uint64_t longest_us = 0;
  // Time since the last SYNC.
  std::uint64_t earliest_after_sync_us = UINT64_MAX;
  std::uint64_t latest_after_sync_us = 0;

  double mean_period_us() const {
    return frames > 1 ? static_cast<double>(last_us - first_us) / static_cast<double>(frames - 1) : 0.0;
  }
};

// Rate, load and jitter of a bus. Foreign and remote frames count for rate and load only.
class BusStatistics {
 public:
  void add(const TimedFrame& timed);

  std::uint64_t frames() const { return frames_; }
  double duration_s() const { return 1e-6 * static_cast<double>(last_us_ - first_us_); }
  // Share of the time during which the bus was busy; 0 with fewer than two frames. Above 1 if the times
  // cannot be those of one bus at this bit rate. Frames of CAN FD, CAN XL and error frames count for nothing.
  double load(double bits_per_s = 1e6) const;
  const ForeignCount& foreign() const { return foreign_; }
  const std::map<std::uint16_t, IdentifierStatistics>& identifiers() const { return identifiers_; }

 private:
  std::map<std::uint16_t, IdentifierStatistics> identifiers_;
  std::uint64_t frames_ = 0;
  std::uint64_t bits_ = 0;  // of the frames after the first, which came before its time
  ForeignCount foreign_;
  std::uint64_t first_us_ = 0;
  std::uint64_t last_us_ = 0;
  std::optional<std::uint64_t> sync_us_;
};

// Formats a table with a line for each identifier.
std::string statistics_table(const BusStatistics& statistics, double bits_per_s = 1e6);

}  // namespace koboshi::bus
