#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "view/recording/mcap_index.h"
#include "view/recording/recording.h"
#include "view/recording/recording_messages.h"

namespace koboshi::view {

// A recording on the disk of which parts are read as they are needed, in blocks of about a second: opening it
// takes as long for an hour as for a minute, and no more memory than its index and its shapes. Functions
// throw InputError. Not for several threads: each opens the file for itself.
class RecordingIndex {
 public:
  // Opens a run's folder, or its file run.mcap. Reads the index, the metadata and the first block, which has
  // the shapes.
  explicit RecordingIndex(const std::filesystem::path& run);
  RecordingIndex(const RecordingIndex&) = delete;
  RecordingIndex& operator=(const RecordingIndex&) = delete;

  // The recording without samples, events, pushes and frames.
  const Recording& head() const { return head_; }
  // The last moment of the run, us.
  std::uint64_t end_us() const;
  // Blocks with messages of the run, in order of time.
  std::size_t blocks() const { return mcap_.chunks().size() - 1; }
  // The block that holds the first sample at or after a time; the last one for later times. There must be a
  // block.
  std::size_t block_at(std::uint64_t time_us) const;

  // Returns the samples, events, pushes and frames of a block.
  Recording read(std::size_t block);
  // Returns the samples of a block with time and values only, its events and its pushes: a third of the work.
  Recording read_overview(std::size_t block);

  const McapIndex& mcap() const { return mcap_; }

 private:
  Recording read(std::size_t block, RecordingMessages::Parts parts);

  RecordingMessages messages_;
  const McapListener listener_;
  McapIndex mcap_;
  Recording head_;
};

}  // namespace koboshi::view
