#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "view/recording/recording.h"

namespace koboshi::view {

// Topics of a recording (docs/reference/recording.md).
inline constexpr const char* kSceneTopic = "/scene";          // foxglove.SceneUpdate: what viewers draw
inline constexpr const char* kModelTopic = "/model";          // koboshi.Scene: the whole scene
inline constexpr const char* kPosesTopic = "/tf";             // foxglove.FrameTransforms
inline constexpr const char* kTraceTopic = "/trace";          // koboshi.Trace
inline constexpr const char* kContactsTopic = "/contacts";    // koboshi.Contacts
inline constexpr const char* kEventsTopic = "/events";        // foxglove.Log
inline constexpr const char* kPushesTopic = "/push";          // koboshi.Push
inline constexpr const char* kFramesTopic = "/can";           // koboshi.CanFrames
inline constexpr const char* kWorldFrame = "world";           // parent of all links on /tf
inline constexpr const char* kRecordingMetadata = "koboshi";  // metadata of the run

// Writes a recording step by step. Records are to be added in order of time, give or take a second, and go
// into blocks of a simulated second. The same calls give the same bytes. All functions throw WriteError.
class RecordingFile {
 public:
  // `head` is a recording without its samples, events, pushes and frames.
  RecordingFile(const std::filesystem::path& file, const Recording& head);
  ~RecordingFile();
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;

  // `values` may be empty: between two ticks, the poses alone are known.
  void add_sample(std::uint64_t time_us, std::span<const Pose> links, std::span<const ContactForce> contacts,
                  std::span<const float> values);
  void add_event(const Event& event);
  void add_push(const Push& push);
  // Frames are gathered into one message for ten milliseconds.
  void add_frame(const Frame& frame);

  // Completes the file; nothing may be added afterwards.
  void close();

 private:
  class Messages;
  const std::unique_ptr<Messages> messages_;
};

// Writes a whole recording.
void write_recording(const std::filesystem::path& file, const Recording& recording);

}  // namespace koboshi::view
