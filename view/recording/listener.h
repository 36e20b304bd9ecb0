#pragma once

#include <cstdint>
#include <span>

#include "view/recording/recording.h"

namespace koboshi::view {

// Receives the records of a run while it is recorded, in order of time, give or take a second.
class RecordingListener {
 public:
  virtual void add_sample(std::uint64_t time_us, std::span<const Pose> links,
                          std::span<const ContactForce> contacts, std::span<const float> values) = 0;
  virtual void add_event(const Event& event) = 0;
  virtual void add_push(const Push& push) = 0;
  virtual void add_frame(const Frame& frame) = 0;

 protected:
  ~RecordingListener() = default;
};

}  // namespace koboshi::view
