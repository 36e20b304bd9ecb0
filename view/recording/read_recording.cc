#include "view/recording/read_recording.h"

#include <google/protobuf/stubs/logging.h>

#include "view/recording/mcap_reader.h"
#include "view/recording/recording_messages.h"

namespace koboshi::view {

Recording read_recording(const std::filesystem::path& run) {
  const google::protobuf::LogSilencer silencer;  // RecordingMessages reports what is wrong
  const std::filesystem::path file = recording_file(run);
  RecordingMessages messages(file);
  const bool complete = read_mcap(file, messages.listener());
  Recording parts = messages.finish();
  Recording recording = messages.head();
  recording.complete = complete;
  recording.samples = std::move(parts.samples);
  recording.events = std::move(parts.events);
  recording.pushes = std::move(parts.pushes);
  recording.frames = std::move(parts.frames);
  return recording;
}

}  // namespace koboshi::view
