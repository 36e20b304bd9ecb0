#include "studio/run/recording_window.h"

#include <algorithm>

namespace koboshi::studio {

bool RecordingWindow::show(std::uint64_t time_us) {
  if (index_.blocks() == 0) return false;
  shown_ = index_.block_at(time_us);
  // Between the last sample of a block and the first of the next one, both are needed.
  const std::size_t needed = shown_ == 0 ? 0 : shown_ - 1;
  if (!blocks_.empty() && needed >= first_ && shown_ <= last()) return false;
  if (blocks_.empty() || shown_ + 1 < first_ || needed > last() + 1) {
    blocks_.clear();
    first_ = needed;
    blocks_.push_back(index_.read(needed));
  }
  while (first_ > needed) read_before();
  while (last() < shown_) read_behind();
  return true;
}

bool RecordingWindow::extend() {
  if (blocks_.empty()) return false;
  if (last() < std::min(shown_ + kBehind, index_.blocks() - 1)) {
    read_behind();
    return true;
  }
  if (first_ == 0 || shown_ + kBehind + 1 - first_ >= kMaxBlocks) return false;
  read_before();
  return true;
}

void RecordingWindow::read_before() {
  blocks_.push_front(index_.read(first_ - 1));
  --first_;
  if (blocks_.size() > kMaxBlocks) blocks_.pop_back();
}

void RecordingWindow::read_behind() {
  blocks_.push_back(index_.read(last() + 1));
  if (blocks_.size() <= kMaxBlocks) return;
  blocks_.pop_front();
  ++first_;
}

void RecordingWindow::copy_to(view::Recording& recording) const {
  recording.samples.clear();
  recording.pushes.clear();
  recording.frames.clear();
  for (const view::Recording& block : blocks_) {
    recording.samples.insert(recording.samples.end(), block.samples.begin(), block.samples.end());
    recording.pushes.insert(recording.pushes.end(), block.pushes.begin(), block.pushes.end());
    recording.frames.insert(recording.frames.end(), block.frames.begin(), block.frames.end());
  }
}

}  // namespace koboshi::studio
