#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "simulation/scenario/object_access.h"
#include "view/recording/listener.h"
#include "view/recording/recording.h"

namespace koboshi::studio {

// The moment to which a run has returned. The bus is behind the board: frames that end after bus_us come
// again.
struct Rewind {
  std::uint64_t time_us = 0;
  std::uint64_t bus_us = 0;
};

// The records of a run since the last batch.
struct Batch {
  // Set after a rewind: everything later is to be forgotten first.
  std::optional<Rewind> rewound{};
  std::vector<view::Sample> samples{};
  std::vector<view::Frame> frames{};
  // With `all_pushes` those of the whole run so far, which replace the earlier ones.
  std::vector<view::Push> pushes{};
  bool all_pushes = false;
  std::vector<simulation::ObjectAnswer> answers{};
  // All events of the run if they have changed: the text of an event can change for a second.
  std::optional<std::vector<view::Event>> events{};
};

// Appends what a batch holds to the recording that holds all earlier batches of the run.
void append(Batch&& batch, view::Recording& recording);

// Collects the records of a run for another thread. Neither side waits for the other for longer than it takes
// to append a record or to swap two lists.
class Inbox final : public view::RecordingListener {
 public:
  [[nodiscard]] Batch take();
  // Forgets all that is later, here and in the batches that were taken. Then comes a new recorder, which
  // repeats the pushes of the whole run.
  void rewind(const Rewind& to);
  void add_answers(std::vector<simulation::ObjectAnswer> answers);
  // Gives all events of the run so far, in any order.
  void set_events(std::vector<view::Event> events);
  // Returns when this many samples have been added, taken back or not.
  void wait_for_samples(std::uint64_t count);

  void add_sample(std::uint64_t time_us, std::span<const view::Pose> links,
                  std::span<const view::ContactForce> contacts, std::span<const float> values) override;
  void add_event(const view::Event& /*event*/) override {}  // set_events() gives them all
  void add_push(const view::Push& push) override;
  void add_frame(const view::Frame& frame) override;

 private:
  std::mutex mutex_;
  std::condition_variable added_;
  std::uint64_t samples_ = 0;
  Batch batch_;
};

}  // namespace koboshi::studio
