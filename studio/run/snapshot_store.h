#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "simulation/assembly/snapshot.h"

namespace koboshi::studio {

// The snapshots of a run at equal intervals. When their memory exceeds the budget, every second one is
// dropped and the interval doubles, so that any moment of the run stays within reach: the way from a snapshot
// to a moment is one interval at most.
class SnapshotStore {
 public:
  static constexpr std::uint64_t kFirstInterval_us = 1'000'000;
  static constexpr std::size_t kDefaultBudget_bytes = std::size_t{256} << 20;

  explicit SnapshotStore(std::size_t budget_bytes = kDefaultBudget_bytes) : budget_bytes_(budget_bytes) {}

  // Whether a snapshot is due at this time.
  bool due(std::uint64_t now_us) const {
    return now_us % interval_us_ == 0 && (snapshots_.empty() || now_us > snapshots_.back().time_us());
  }
  // Snapshots come in order of time; the first one is never dropped.
  void add(simulation::Snapshot snapshot);
  // The last snapshot at or before this time; the first one for earlier times. The store may not be empty.
  const simulation::Snapshot& before(std::uint64_t time_us) const;
  // Drops all snapshots after this time except the first one.
  void truncate_after(std::uint64_t time_us);

  std::size_t count() const { return snapshots_.size(); }
  std::size_t size_bytes() const { return size_bytes_; }
  std::uint64_t interval_us() const { return interval_us_; }

 private:
  void thin();

  std::size_t budget_bytes_;
  std::uint64_t interval_us_ = kFirstInterval_us;
  std::size_t size_bytes_ = 0;
  std::vector<simulation::Snapshot> snapshots_;
};

}  // namespace koboshi::studio
