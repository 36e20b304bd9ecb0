#include "view/recording/recording_messages.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <foxglove.pb.h>
#include <recording.pb.h>
#include <nlohmann/json.hpp>

#include "base/text/text.h"
#include "view/recording/recording_file.h"
#include "view/recording/scene_messages.h"
#include "view/recording/trace_schema.h"

namespace koboshi::view {
namespace {

constexpr const char* kFileName = "run.mcap";

}  // namespace

std::filesystem::path recording_file(const std::filesystem::path& run) {
  if (!std::filesystem::is_directory(run)) return run;
  if (!std::filesystem::exists(run / kFileName))
    throw InputError(run, 0, "no run.mcap", "the folder of a run that was recorded");
  return run / kFileName;
}

McapListener RecordingMessages::listener() {
  return {.on_metadata = [this](const auto& name, const auto& texts) { take_metadata(name, texts); },
          .on_message = [this](const McapChannel& channel, std::uint64_t time_us,
                               std::string_view data) { take_message(channel, time_us, data); }};
}

InputError RecordingMessages::wrong(const std::string& what) const {
  return {file_, 0, what, "a recording of koboshi run"};
}

void RecordingMessages::check_head() const {
  if (!has_metadata_) throw InputError(file_, 0, "no run of Koboshi", "a recording of koboshi run");
  if (!has_scene_)
    throw InputError(file_, 0, "an end within the first block",
                     "a recording with the shapes of robot and ground");
}

Recording RecordingMessages::finish() {
  check_head();
  if (parts_ == Parts::kAll) fill_in_values();
  std::ranges::stable_sort(recording_.events, {}, &Event::time_us);
  std::ranges::stable_sort(recording_.pushes, {}, &Push::start_us);
  return std::exchange(recording_, {});
}

void RecordingMessages::take_metadata(const std::string& name,
                                      const std::map<std::string, std::string>& texts) {
  if (name != kRecordingMetadata) return;
  has_metadata_ = true;
  const auto text = [&](const char* key) {
    const auto found = texts.find(key);
    return found == texts.end() ? std::string() : found->second;
  };
  head_.title = text("title");
  head_.scenario = text("scenario");
  head_.stepper = text("stepper");
  head_.version = text("version");
  if (texts.contains("nodes")) take_nodes(text("nodes"));
  try {
    head_.seed = std::stoull(text("seed"));
  } catch (const std::logic_error&) {
    throw wrong("seed '" + one_line(text("seed")) + "'");
  }
}

void RecordingMessages::take_nodes(const std::string& text) {
  try {
    for (const auto& [id, name] : nlohmann::json::parse(text).get<std::vector<std::pair<int, std::string>>>())
      head_.nodes.push_back({id, name});
  } catch (const nlohmann::json::exception&) {
    throw wrong("nodes that cannot be read");
  }
}

void RecordingMessages::take_message(const McapChannel& channel, std::uint64_t time_us,
                                     std::string_view data) {
  const std::string& topic = channel.topic;
  if (topic == kTraceTopic) return take_trace(channel, time_us, data);
  if (topic == kEventsTopic) return take_event(time_us, parsed<foxglove::Log>(channel, data));
  if (topic == kPushesTopic) return take_push(parsed<koboshi::Push>(channel, data));
  if (parts_ == Parts::kOverview) return;
  if (topic == kModelTopic) return take_scene(parsed<koboshi::Scene>(channel, data));
  if (topic == kPosesTopic) return take_poses(time_us, parsed<foxglove::FrameTransforms>(channel, data));
  if (topic == kContactsTopic) return take_contacts(time_us, parsed<koboshi::Contacts>(channel, data));
  if (topic == kFramesTopic) return take_frames(time_us, parsed<koboshi::CanFrames>(channel, data));
}

template <typename Message>
Message RecordingMessages::parsed(const McapChannel& channel, std::string_view data) const {
  Message message;
  if (channel.schema != Message::descriptor()->full_name())
    throw wrong(fmt::format("{} with messages {}", channel.topic, one_line(channel.schema)));
  if (!message.ParseFromArray(data.data(), static_cast<int>(data.size())))
    throw wrong(fmt::format("a message on {} that cannot be read", channel.topic));
  return message;
}

void RecordingMessages::take_scene(const koboshi::Scene& message) {
  try {
    head_.scene = scene_of(message);
  } catch (const std::invalid_argument& error) {
    throw wrong(fmt::format("a scene in which {} is wrong", error.what()));
  }
  has_scene_ = true;
}

// All messages of a sample have its time and follow each other.
Sample& RecordingMessages::sample_at(std::uint64_t time_us) {
  auto& samples = recording_.samples;
  if (!samples.empty() && samples.back().time_us == time_us) return samples.back();
  if (!samples.empty() && samples.back().time_us > time_us)
    throw wrong("samples that are not in order of time");
  return samples.emplace_back(Sample{.time_us = time_us});
}

void RecordingMessages::take_poses(std::uint64_t time_us, const foxglove::FrameTransforms& message) {
  const std::size_t links = head_.scene.links.size();
  if (static_cast<std::size_t>(message.transforms_size()) != links)
    throw wrong(fmt::format("poses of {} links, where the scene has {}", message.transforms_size(), links));
  Sample& sample = sample_at(time_us);
  for (const foxglove::FrameTransform& transform : message.transforms()) {
    const foxglove::Vector3& p = transform.translation();
    const foxglove::Quaternion& q = transform.rotation();
    Pose& pose = sample.links.emplace_back();
    pose.p_WL_m = Eigen::Vector3d(p.x(), p.y(), p.z()).cast<float>();
    pose.q_WL = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).cast<float>();
  }
}

void RecordingMessages::check_link(int link, int lowest) const {
  if (link < lowest || link >= static_cast<int>(head_.scene.links.size()))
    throw wrong(fmt::format("link {} of {}", link, head_.scene.links.size()));
}

void RecordingMessages::take_contacts(std::uint64_t time_us, const koboshi::Contacts& message) {
  Sample& sample = sample_at(time_us);
  for (const koboshi::Contact& contact : message.contacts()) {
    check_link(contact.link(), 0);
    check_link(contact.other_link(), -1);
    sample.contacts.push_back({.link = contact.link(),
                               .other_link = contact.other_link(),
                               .p_W_m = {contact.x_m(), contact.y_m(), contact.z_m()},
                               .f_W_N = {contact.force_x_n(), contact.force_y_n(), contact.force_z_n()}});
  }
}

void RecordingMessages::take_trace(const McapChannel& channel, std::uint64_t time_us, std::string_view data) {
  if (!has_signals_) take_signals(channel);
  std::vector<float> values = read_trace(head_.signals, data);
  if (values.size() != head_.signals.size()) throw wrong("a message on /trace that cannot be read");
  sample_at(time_us).values = std::move(values);
}

void RecordingMessages::take_signals(const McapChannel& channel) {
  const auto text = channel.metadata.find("signals");
  if (text == channel.metadata.end()) throw wrong("/trace without its signals");
  try {
    head_.signals = signals_of_json(text->second);
  } catch (const nlohmann::json::exception&) {
    throw wrong("/trace with signals that cannot be read");
  }
  has_signals_ = true;
}

void RecordingMessages::take_event(std::uint64_t time_us, const foxglove::Log& message) {
  recording_.events.push_back({time_us, message.name(), message.message()});
}

void RecordingMessages::take_push(const koboshi::Push& message) {
  if (message.point_m_size() != 3 || message.force_n_size() != 3)
    throw wrong("a push without point or force");
  check_link(message.link(), 0);
  recording_.pushes.push_back({.start_us = message.start_us(),
                               .end_us = message.end_us(),
                               .link = message.link(),
                               .p_L_m = {message.point_m(0), message.point_m(1), message.point_m(2)},
                               .f_W_N = {message.force_n(0), message.force_n(1), message.force_n(2)}});
}

void RecordingMessages::take_frames(std::uint64_t time_us, const koboshi::CanFrames& message) {
  const int count = message.identifier_size();
  if (message.offset_us_size() != count || static_cast<int>(message.sizes().size()) != count)
    throw wrong("frames whose lists differ in length");
  std::size_t place = 0;
  for (int i = 0; i < count; ++i) {
    const auto size = static_cast<std::uint8_t>(message.sizes()[static_cast<std::size_t>(i)]);
    Frame frame{.end_us = time_us + message.offset_us(i),
                .frame = {.identifier = static_cast<std::uint16_t>(message.identifier(i)),
                          .size = static_cast<std::uint8_t>(size & 0x7FU),
                          .remote = (size & 0x80U) != 0}};
    const std::size_t bytes = frame.frame.remote ? 0 : frame.frame.size;
    if (frame.frame.size > frame.frame.data.size() || place + bytes > message.data().size())
      throw wrong("a frame of more data than there are");
    std::copy_n(message.data().begin() + static_cast<std::ptrdiff_t>(place), bytes, frame.frame.data.begin());
    place += bytes;
    recording_.frames.push_back(frame);
  }
}

// Samples between two ticks have the values of the tick before.
void RecordingMessages::fill_in_values() {
  const std::vector<float> none(head_.signals.size(), std::numeric_limits<float>::quiet_NaN());
  const std::vector<float>* last = &none;
  for (Sample& sample : recording_.samples) {
    if (sample.links.size() != head_.scene.links.size()) throw wrong("a sample without poses");
    if (sample.values.empty()) sample.values = *last;
    last = &sample.values;
  }
}

}  // namespace koboshi::view
