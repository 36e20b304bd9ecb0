#include "view/live/batch.h"

#include <array>
#include <bit>
#include <nlohmann/json.hpp>
#include <utility>

#include "bus/can/describe.h"
#include "view/replay/replay_data.h"

namespace koboshi::view {
namespace {

using nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "the page expects little-endian numbers");

constexpr std::uint16_t kNoText = 65535;
constexpr std::size_t kFrameBytes = 24;
constexpr std::size_t kContactNumbers = 8;

template <typename Number>
void put(std::string& bytes, const Number& number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

template <typename Number>
void put_all(std::string& bytes, const std::vector<Number>& numbers) {
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
}

std::string text_of(const ordered_json& json) {
  if (json.empty()) return {};
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

// A batch of these counts: samples, contacts, frames, links, signals.
std::string batch_of(const std::array<std::size_t, 5>& counts, const std::string& columns,
                     const ordered_json& json) {
  std::string text = text_of(json);
  constexpr std::size_t kHead = 8 * sizeof(std::uint32_t);
  text.resize((kHead + columns.size() + text.size() + 7) / 8 * 8 - kHead - columns.size(), ' ');
  std::string bytes;
  bytes.reserve(kHead + columns.size() + text.size());
  put(bytes, static_cast<std::uint32_t>(kHead + columns.size() + text.size()));
  put(bytes, static_cast<std::uint32_t>(text.size()));
  for (const std::size_t count : counts) put(bytes, static_cast<std::uint32_t>(count));
  put(bytes, std::uint32_t{0});
  return bytes + columns + text;
}

}  // namespace

std::string lost_batch(std::uint64_t samples, std::uint64_t frames) {
  return batch_of({}, {}, {{"lost", {{"samples", samples}, {"frames", frames}}}});
}

void BatchMaker::add_sample(std::uint64_t time_us, std::span<const Pose> links,
                            std::span<const ContactForce> contacts, std::span<const float> values) {
  times_us_.push_back(static_cast<double>(time_us));
  for (const Pose& pose : links) {
    poses_.insert(poses_.end(), pose.p_WL_m.begin(), pose.p_WL_m.end());
    poses_.insert(poses_.end(), pose.q_WL.coeffs().begin(), pose.q_WL.coeffs().end());
  }
  values_.insert(values_.end(), values.begin(), values.end());
  contact_counts_.push_back(static_cast<std::uint32_t>(contacts.size()));
  for (const ContactForce& contact : contacts) {
    contacts_.push_back(static_cast<float>(contact.link));
    contacts_.push_back(static_cast<float>(contact.other_link));
    contacts_.insert(contacts_.end(), contact.p_W_m.begin(), contact.p_W_m.end());
    contacts_.insert(contacts_.end(), contact.f_W_N.begin(), contact.f_W_N.end());
  }
}

void BatchMaker::add_event(const Event& event) { events_.push_back(event); }

void BatchMaker::add_push(const Push& push) { pushes_.push_back(push); }

void BatchMaker::add_frame(const Frame& one) {
  const hal::CanFrame& frame = one.frame;
  const bus::FrameKind kind = bus::kind_of(frame);
  const bool is_segment = blocks_.follow(frame);
  std::uint16_t text = kNoText;
  if (kind != bus::FrameKind::kPdo && texts_.size() < kNoText) {
    text = static_cast<std::uint16_t>(texts_.size());
    texts_.push_back(bus::describe(frame, {}, is_segment));
  }
  put(frame_bytes_, static_cast<double>(one.end_us));
  put(frame_bytes_, frame.identifier);
  put(frame_bytes_, frame.size);
  put(frame_bytes_, static_cast<std::uint8_t>(frame.remote));
  put(frame_bytes_, static_cast<std::uint8_t>(kind));
  put(frame_bytes_, static_cast<std::uint8_t>(bus::node_of(frame)));
  put(frame_bytes_, text);
  put(frame_bytes_, frame.data);
  ++frames_;
  static_assert(sizeof frame.data == 8 && sizeof frame.identifier == 2 && sizeof frame.size == 1);
  static_assert(sizeof(double) + 2 + 1 + 1 + 1 + 1 + sizeof text + sizeof frame.data == kFrameBytes);
}

Batch BatchMaker::take() {
  ordered_json marks;
  for (const Event& event : events_) marks["events"].push_back(event_json(event));
  for (const Push& push : pushes_) marks["pushes"].push_back(push_json(push));
  ordered_json json = marks;
  if (!texts_.empty()) json["texts"] = texts_;

  std::string columns;
  columns.reserve(8 * times_us_.size() + frame_bytes_.size() +
                  4 * (poses_.size() + values_.size() + contact_counts_.size() + contacts_.size()));
  put_all(columns, times_us_);
  columns += frame_bytes_;
  put_all(columns, poses_);
  put_all(columns, values_);
  put_all(columns, contact_counts_);
  put_all(columns, contacts_);
  Batch batch{.bytes = batch_of({times_us_.size(), contacts_.size() / kContactNumbers,
                                 static_cast<std::size_t>(frames_), links_, signals_},
                                columns, json),
              .samples = times_us_.size(),
              .frames = frames_};
  if (!marks.empty()) batch.marks = batch_of({0, 0, 0, links_, signals_}, {}, marks);
  BatchMaker next(links_, signals_);
  next.blocks_ = std::move(blocks_);
  *this = std::move(next);
  return batch;
}

}  // namespace koboshi::view
