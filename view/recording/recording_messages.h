#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "base/text/error.h"
#include "view/recording/mcap_reader.h"
#include "view/recording/recording.h"

namespace koboshi {
class CanFrames;
class Contacts;
class Push;
class Scene;
}  // namespace koboshi
namespace foxglove {
class FrameTransforms;
class Log;
}  // namespace foxglove

namespace koboshi::view {

// The file of a recording: the file itself, or run.mcap in the folder of a run. Throws InputError for a
// folder without it.
std::filesystem::path recording_file(const std::filesystem::path& run);

// Turns the messages of a recording's file into its parts. Functions throw InputError for contents that
// are no recording.
class RecordingMessages {
 public:
  // The messages that are read.
  enum class Parts {
    kAll,
    kOverview,  // samples have values only; no contacts and frames
  };

  // `file` is for messages.
  explicit RecordingMessages(std::filesystem::path file) : file_(std::move(file)) {}

  void select(Parts parts) { parts_ = parts; }
  // Passes what is read on to this object, which must outlive the listener.
  McapListener listener();
  // The signals of the channel of /trace, which are otherwise read with its first message.
  void take_signals(const McapChannel& channel);
  // Throws where metadata or scene are missing.
  void check_head() const;
  // Returns the samples, events, pushes and frames that have been taken since the last call.
  Recording finish();
  // The recording without samples, events, pushes and frames.
  const Recording& head() const { return head_; }

 private:
  void take_metadata(const std::string& name, const std::map<std::string, std::string>& texts);
  void take_message(const McapChannel& channel, std::uint64_t time_us, std::string_view data);
  InputError wrong(const std::string& what) const;
  void take_nodes(const std::string& text);
  template <typename Message>
  Message parsed(const McapChannel& channel, std::string_view data) const;
  void take_scene(const koboshi::Scene& message);
  Sample& sample_at(std::uint64_t time_us);
  void take_poses(std::uint64_t time_us, const foxglove::FrameTransforms& message);
  void check_link(int link, int lowest) const;
  void take_contacts(std::uint64_t time_us, const koboshi::Contacts& message);
  void take_trace(const McapChannel& channel, std::uint64_t time_us, std::string_view data);
  void take_event(std::uint64_t time_us, const foxglove::Log& message);
  void take_push(const koboshi::Push& message);
  void take_frames(std::uint64_t time_us, const koboshi::CanFrames& message);
  void fill_in_values();

  const std::filesystem::path file_;
  Parts parts_ = Parts::kAll;
  Recording head_;
  Recording recording_;  // samples, events, pushes and frames since the last finish()
  bool has_metadata_ = false;
  bool has_scene_ = false;
  bool has_signals_ = false;
};

}  // namespace koboshi::view
