#include "studio/run/inbox.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace koboshi::studio {
namespace {

template <typename Item, typename Time>
void erase_after(std::vector<Item>& items, std::uint64_t time_us, Time time) {
  items.erase(std::ranges::upper_bound(items, time_us, {}, time), items.end());
}

template <typename Item>
void move_to_end(std::vector<Item>& from, std::vector<Item>& to) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

}  // namespace

void append(Batch&& batch, view::Recording& recording) {
  if (batch.rewound) {
    erase_after(recording.samples, batch.rewound->time_us, &view::Sample::time_us);
    erase_after(recording.frames, batch.rewound->bus_us, &view::Frame::end_us);
    erase_after(recording.events, batch.rewound->time_us, &view::Event::time_us);
  }
  if (batch.all_pushes) recording.pushes.clear();
  move_to_end(batch.samples, recording.samples);
  move_to_end(batch.frames, recording.frames);
  move_to_end(batch.pushes, recording.pushes);
  if (batch.events) recording.events = std::move(*batch.events);
}

Batch Inbox::take() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(batch_, {});
}

void Inbox::rewind(const Rewind& to) {
  const std::scoped_lock lock(mutex_);
  erase_after(batch_.samples, to.time_us, &view::Sample::time_us);
  erase_after(batch_.frames, to.bus_us, &view::Frame::end_us);
  if (batch_.events) erase_after(*batch_.events, to.time_us, &view::Event::time_us);
  batch_.pushes.clear();
  batch_.all_pushes = true;
  if (!batch_.rewound || to.time_us < batch_.rewound->time_us) batch_.rewound = to;
}

void Inbox::add_answers(std::vector<simulation::ObjectAnswer> answers) {
  const std::scoped_lock lock(mutex_);
  std::ranges::move(answers, std::back_inserter(batch_.answers));
}

void Inbox::set_events(std::vector<view::Event> events) {
  // A run reports some events later than others that happen after them.
  std::ranges::stable_sort(events, {}, &view::Event::time_us);
  const std::scoped_lock lock(mutex_);
  batch_.events = std::move(events);
}

void Inbox::add_sample(std::uint64_t time_us, std::span<const view::Pose> links,
                       std::span<const view::ContactForce> contacts, std::span<const float> values) {
  view::Sample sample{time_us,
                      {links.begin(), links.end()},
                      {contacts.begin(), contacts.end()},
                      {values.begin(), values.end()}};
  const std::scoped_lock lock(mutex_);
  batch_.samples.push_back(std::move(sample));
  ++samples_;
  added_.notify_all();
}

void Inbox::wait_for_samples(std::uint64_t count) {
  std::unique_lock lock(mutex_);
  added_.wait(lock, [&] { return samples_ >= count; });
}

void Inbox::add_push(const view::Push& push) {
  const std::scoped_lock lock(mutex_);
  batch_.pushes.push_back(push);
}

void Inbox::add_frame(const view::Frame& frame) {
  const std::scoped_lock lock(mutex_);
  batch_.frames.push_back(frame);
}

}  // namespace koboshi::studio
