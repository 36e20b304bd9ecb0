#include "view/recording/recording_index.h"

#include <google/protobuf/stubs/logging.h>

#include <algorithm>

#include "base/text/error.h"
#include "view/recording/recording_file.h"

namespace koboshi::view {

RecordingIndex::RecordingIndex(const std::filesystem::path& run)
    : messages_(recording_file(run)), listener_(messages_.listener()), mcap_(recording_file(run), listener_) {
  const google::protobuf::LogSilencer silencer;  // RecordingMessages reports what is wrong
  if (mcap_.chunks().empty())
    throw InputError(recording_file(run), 0, "an end within the first block",
                     "a recording with the shapes of robot and ground");
  mcap_.read(0);
  for (const auto& [id, channel] : mcap_.channels())
    if (channel.topic == kTraceTopic) messages_.take_signals(channel);
  messages_.check_head();
  head_ = messages_.head();
  head_.complete = mcap_.complete();
}

std::uint64_t RecordingIndex::end_us() const {
  return std::ranges::max(mcap_.chunks(), {}, &McapChunk::end_us).end_us;
}

// An event is written a second after its time, so blocks overlap; their ends are the times of samples and
// frames.
std::size_t RecordingIndex::block_at(std::uint64_t time_us) const {
  const auto first = mcap_.chunks().begin() + 1;
  const auto found = std::ranges::lower_bound(first, mcap_.chunks().end(), time_us, {}, &McapChunk::end_us);
  return std::min(static_cast<std::size_t>(found - first), blocks() - 1);
}

Recording RecordingIndex::read(std::size_t block) { return read(block, RecordingMessages::Parts::kAll); }

Recording RecordingIndex::read_overview(std::size_t block) {
  return read(block, RecordingMessages::Parts::kOverview);
}

Recording RecordingIndex::read(std::size_t block, RecordingMessages::Parts parts) {
  const google::protobuf::LogSilencer silencer;
  messages_.select(parts);
  mcap_.read(block + 1);
  return messages_.finish();
}

}  // namespace koboshi::view
