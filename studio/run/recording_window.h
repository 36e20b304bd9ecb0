#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>

#include "view/recording/recording.h"
#include "view/recording/recording_index.h"

namespace koboshi::studio {

// The part of a recording on the disk that is in memory: a few blocks of a second around a moment, at most
// kMaxBlocks of them. Functions throw InputError for damaged blocks.
class RecordingWindow {
 public:
  // 8 s, as long as a footprint is shown, and the blocks around the moment.
  static constexpr std::size_t kMaxBlocks = 11;

  explicit RecordingWindow(const std::filesystem::path& run) : index_(run) {}

  // The recording without samples, events, pushes and frames.
  const view::Recording& head() const { return index_.head(); }
  std::uint64_t end_us() const { return index_.blocks() == 0 ? 0 : index_.end_us(); }
  std::size_t block_count() const { return blocks_.size(); }
  const view::RecordingIndex& index() const { return index_; }

  // Reads the blocks that are missing for the poses at a time: at most two after a jump, one while time
  // advances. Returns whether the window has changed.
  bool show(std::uint64_t time_us);
  // Reads one more block before or behind the window, as long as it has room there: kBehind blocks behind the
  // moment of the last show(), the others before it. Returns whether it has changed.
  bool extend();
  // Copies samples, pushes and frames of the window.
  void copy_to(view::Recording& recording) const;

 private:
  static constexpr std::size_t kBehind = 1;

  std::size_t last() const { return first_ + blocks_.size() - 1; }
  void read_before();
  void read_behind();

  view::RecordingIndex index_;
  std::size_t first_ = 0;  // block of blocks_.front()
  std::size_t shown_ = 0;  // block of the last show()
  std::deque<view::Recording> blocks_;
};

}  // namespace koboshi::studio
