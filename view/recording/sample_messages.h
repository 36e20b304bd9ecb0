#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "view/recording/recording.h"

namespace koboshi::view {

// The messages of a sample in Protobuf's wire format. Objects of the generated classes take several times
// as long to fill and to serialise, which counts: there are a hundred samples a second.

// foxglove.FrameTransforms with the poses of all links in one frame.
class PoseMessages {
 public:
  PoseMessages(const std::string& parent_frame, std::span<const Link> links);

  // Appends a message with one pose per link to `data`.
  void append(std::uint64_t time_us, std::span<const Pose> links, std::string& data) const;

 private:
  std::vector<std::string> frames_;  // the fields with both frames' names, by link
};

// Appends a koboshi.Contacts to `data`.
void append_contacts(std::span<const ContactForce> contacts, std::string& data);

}  // namespace koboshi::view
