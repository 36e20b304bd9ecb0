#include "studio/run/snapshot_store.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

namespace koboshi::studio {

void SnapshotStore::add(simulation::Snapshot snapshot) {
  assert(snapshots_.empty() || snapshot.time_us() > snapshots_.back().time_us());
  size_bytes_ += snapshot.size_bytes();
  snapshots_.push_back(std::move(snapshot));
  // Two snapshots always fit: without them, there would be nothing to drop.
  while (size_bytes_ > budget_bytes_ && snapshots_.size() > 2) thin();
}

void SnapshotStore::thin() {
  interval_us_ *= 2;
  const auto dropped = std::remove_if(
      std::next(snapshots_.begin()), snapshots_.end(),
      [this](const simulation::Snapshot& snapshot) { return snapshot.time_us() % interval_us_ != 0; });
  snapshots_.erase(dropped, snapshots_.end());
  size_bytes_ = 0;
  for (const simulation::Snapshot& snapshot : snapshots_) size_bytes_ += snapshot.size_bytes();
}

const simulation::Snapshot& SnapshotStore::before(std::uint64_t time_us) const {
  assert(!snapshots_.empty());
  const auto after = std::ranges::upper_bound(snapshots_, time_us, {}, &simulation::Snapshot::time_us);
  return after == snapshots_.begin() ? snapshots_.front() : *std::prev(after);
}

void SnapshotStore::truncate_after(std::uint64_t time_us) {
  while (snapshots_.size() > 1 && snapshots_.back().time_us() > time_us) {
    size_bytes_ -= snapshots_.back().size_bytes();
    snapshots_.pop_back();
  }
}

}  // namespace koboshi::studio
