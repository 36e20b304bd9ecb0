#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bus/can/sdo_blocks.h"
#include "view/recording/recording.h"

namespace koboshi::view {

// The records of a moment as bytes for the page (live.js decodes them). Numbers are little-endian, times in
// microseconds:
//
//   u32 x 8        size of the batch in bytes, a multiple of 8; size of the JSON text; samples, contacts,
//                  frames, links, signals; 0
//   f64            time of each sample
//   24 bytes each  frames: f64 end; u16 identifier; u8 size, remote, kind (tools::FrameKind), node; u16
//                  number of its text in the JSON, or 65535; 8 bytes of data
//   f32 x 7        pose of each link of each sample: position, quaternion x, y, z, w
//   f32            signals of each sample; NaN: no value
//   u32            number of contacts of each sample
//   f32 x 8        contacts: link, other link, position, force
//   JSON           {"events", "pushes", "texts", "lost"}, those that there are; spaces fill it up
struct Batch {
  std::string bytes{};
  std::string marks{};  // its events and pushes only, as a batch of their own; empty without any
  std::uint64_t samples = 0;
  std::uint64_t frames = 0;
};

// A batch that tells how many samples and frames this page has missed.
[[nodiscard]] std::string lost_batch(std::uint64_t samples, std::uint64_t frames);

// Collects records into a batch.
class BatchMaker {
 public:
  BatchMaker(std::size_t links, std::size_t signals) : links_(links), signals_(signals) {}

  void add_sample(std::uint64_t time_us, std::span<const Pose> links, std::span<const ContactForce> contacts,
                  std::span<const float> values);
  void add_event(const Event& event);
  void add_push(const Push& push);
  void add_frame(const Frame& frame);

  bool empty() const { return times_us_.empty() && frames_ == 0 && events_.empty() && pushes_.empty(); }
  // Returns the batch and begins the next one.
  [[nodiscard]] Batch take();

 private:
  std::size_t links_;
  std::size_t signals_;
  std::vector<double> times_us_;
  std::vector<float> poses_;
  std::vector<float> values_;
  std::vector<std::uint32_t> contact_counts_;
  std::vector<float> contacts_;
  std::string frame_bytes_;
  std::uint64_t frames_ = 0;
  std::vector<std::string> texts_;
  bus::SdoBlocks blocks_;  // also across batches
  std::vector<Event> events_;
  std::vector<Push> pushes_;
};

}  // namespace koboshi::view
