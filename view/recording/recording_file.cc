#include "view/recording/recording_file.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <variant>

#include <foxglove.pb.h>
#include <google/protobuf/descriptor.pb.h>
#include <recording.pb.h>
#include <nlohmann/json.hpp>

#include "view/recording/mcap_writer.h"
#include "view/recording/sample_messages.h"
#include "view/recording/scene_messages.h"
#include "view/recording/trace_schema.h"

namespace koboshi::view {
namespace {

namespace pb = google::protobuf;

constexpr std::uint64_t kBlock_us = 1'000'000;
constexpr std::size_t kMaxBlock_bytes = std::size_t{4} << 20;
constexpr std::uint64_t kFramesPerMessage_us = 10'000;

// Adds a file after those that it imports.
void add_file(const pb::FileDescriptor& file, std::set<std::string>& added, pb::FileDescriptorSet& set) {
  if (!added.insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) add_file(*file.dependency(i), added, set);
  file.CopyTo(set.add_file());
}

std::string descriptors(const pb::Descriptor& message) {
  pb::FileDescriptorSet set;
  std::set<std::string> added;
  add_file(*message.file(), added, set);
  return set.SerializeAsString();
}

void set_time(std::uint64_t time_us, pb::Timestamp& time) {
  time.set_seconds(static_cast<std::int64_t>(time_us / 1'000'000));
  time.set_nanos(static_cast<std::int32_t>(time_us % 1'000'000 * 1000));
}

// [[1, "controller"], ...]
std::string nodes_json(const std::vector<CanNode>& nodes) {
  auto list = nlohmann::json::array();
  for (const CanNode& node : nodes) list.push_back({node.id, node.name});
  return list.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

foxglove::Log::Level level_of(const std::string& kind) {
  if (kind == "error" || kind == "fall") return foxglove::Log::ERROR;
  if (kind == "emergency" || kind == "fault" || kind == "push") return foxglove::Log::WARNING;
  return foxglove::Log::INFO;
}

}  // namespace

class RecordingFile::Messages {
 public:
  Messages(const std::filesystem::path& file, const Recording& head)
      : mcap_(file, "koboshi " + head.version),
        pose_messages_(kWorldFrame, head.scene.links),
        signals_(head.signals) {
    mcap_.add_metadata(kRecordingMetadata, {{"title", head.title},
                                            {"scenario", head.scenario},
                                            {"seed", std::to_string(head.seed)},
                                            {"stepper", head.stepper},
                                            {"version", head.version},
                                            {"robot", head.scene.robot},
                                            {"nodes", nodes_json(head.nodes)}});
    scene_ = add_channel(kSceneTopic, *foxglove::SceneUpdate::descriptor());
    model_ = add_channel(kModelTopic, *koboshi::Scene::descriptor());
    poses_ = add_channel(kPosesTopic, *foxglove::FrameTransforms::descriptor());
    trace_ = mcap_.add_channel(kTraceTopic, mcap_.add_schema(kTraceMessage, trace_schema(signals_)),
                               {{"signals", signals_json(signals_)}});
    contacts_ = add_channel(kContactsTopic, *koboshi::Contacts::descriptor());
    events_ = add_channel(kEventsTopic, *foxglove::Log::descriptor());
    pushes_ = add_channel(kPushesTopic, *koboshi::Push::descriptor());
    frames_ = add_channel(kFramesTopic, *koboshi::CanFrames::descriptor());
    add(scene_, 0, scene_update(head.scene, kWorldFrame));
    add(model_, 0, message_of(head.scene));
    mcap_.end_block();
  }

  void add_sample(std::uint64_t time_us, std::span<const Pose> links, std::span<const ContactForce> contacts,
                  std::span<const float> values) {
    start_block(time_us);
    data_.clear();
    pose_messages_.append(time_us, links, data_);
    mcap_.add_message(poses_, time_us, data_);
    data_.clear();
    append_contacts(contacts, data_);
    mcap_.add_message(contacts_, time_us, data_);
    if (values.empty()) return;
    data_.clear();
    append_trace(signals_, values, data_);
    mcap_.add_message(trace_, time_us, data_);
  }

  void add_event(const Event& event) {
    start_block(event.time_us);
    foxglove::Log log;
    set_time(event.time_us, *log.mutable_timestamp());
    log.set_level(level_of(event.kind));
    log.set_name(event.kind);
    log.set_message(event.text);
    add(events_, event.time_us, log);
  }

  void add_push(const Push& push) {
    start_block(push.start_us);
    koboshi::Push message;
    message.set_start_us(push.start_us);
    message.set_end_us(push.end_us);
    message.set_link(push.link);
    for (const double value : push.p_L_m) message.add_point_m(value);
    for (const double value : push.f_W_N) message.add_force_n(value);
    add(pushes_, push.start_us, message);
  }

  void add_frame(const Frame& frame) {
    if (batch_.identifier_size() > 0 && frame.end_us >= batch_start_us_ + kFramesPerMessage_us) add_batch();
    if (batch_.identifier_size() == 0) batch_start_us_ = frame.end_us;
    const hal::CanFrame& can = frame.frame;
    batch_.add_offset_us(static_cast<std::uint32_t>(frame.end_us - batch_start_us_));
    batch_.add_identifier(can.identifier);
    batch_.mutable_sizes()->push_back(static_cast<char>(can.size | (can.remote ? 0x80U : 0U)));
    if (!can.remote) batch_.mutable_data()->append(reinterpret_cast<const char*>(can.data.data()), can.size);
  }

  void close() {
    add_batch();
    mcap_.close();
  }

 private:
  std::uint16_t add_channel(const char* topic, const pb::Descriptor& message) {
    const auto found = schemas_.find(message.full_name());
    const std::uint16_t schema =
        found != schemas_.end() ? found->second : mcap_.add_schema(message.full_name(), descriptors(message));
    schemas_[message.full_name()] = schema;
    return mcap_.add_channel(topic, schema);
  }

  void add(std::uint16_t channel, std::uint64_t time_us, const pb::MessageLite& message) {
    data_.clear();
    message.AppendToString(&data_);
    mcap_.add_message(channel, time_us, data_);
  }

  void add_batch() {
    if (batch_.identifier_size() == 0) return;
    add(frames_, batch_start_us_, batch_);
    batch_.Clear();
  }

  void start_block(std::uint64_t time_us) {
    if (time_us < block_start_us_ + kBlock_us && mcap_.block_bytes() < kMaxBlock_bytes) return;
    add_batch();
    mcap_.end_block();
    block_start_us_ = time_us;
  }

  McapWriter mcap_;
  const PoseMessages pose_messages_;
  const std::vector<Signal> signals_;
  std::map<std::string, std::uint16_t> schemas_;  // by message
  std::uint16_t scene_ = 0;
  std::uint16_t model_ = 0;
  std::uint16_t poses_ = 0;
  std::uint16_t trace_ = 0;
  std::uint16_t contacts_ = 0;
  std::uint16_t events_ = 0;
  std::uint16_t pushes_ = 0;
  std::uint16_t frames_ = 0;
  std::uint64_t block_start_us_ = 0;
  std::uint64_t batch_start_us_ = 0;

  // Kept from call to call for their memory.
  koboshi::CanFrames batch_;
  std::string data_;
};

RecordingFile::RecordingFile(const std::filesystem::path& file, const Recording& head)
    : messages_(std::make_unique<Messages>(file, head)) {}

RecordingFile::~RecordingFile() = default;

void RecordingFile::add_sample(std::uint64_t time_us, std::span<const Pose> links,
                               std::span<const ContactForce> contacts, std::span<const float> values) {
  messages_->add_sample(time_us, links, contacts, values);
}

void RecordingFile::add_event(const Event& event) { messages_->add_event(event); }

void RecordingFile::add_push(const Push& push) { messages_->add_push(push); }

void RecordingFile::add_frame(const Frame& frame) { messages_->add_frame(frame); }

void RecordingFile::close() { messages_->close(); }

void write_recording(const std::filesystem::path& file, const Recording& recording) {
  RecordingFile out(file, recording);
  auto event = recording.events.begin();
  auto push = recording.pushes.begin();
  auto frame = recording.frames.begin();
  const auto add_until = [&](std::uint64_t time_us) {
    for (; frame != recording.frames.end() && frame->end_us <= time_us; ++frame) out.add_frame(*frame);
    for (; push != recording.pushes.end() && push->start_us <= time_us; ++push) out.add_push(*push);
    for (; event != recording.events.end() && event->time_us <= time_us; ++event) out.add_event(*event);
  };
  for (const Sample& sample : recording.samples) {
    add_until(sample.time_us);
    out.add_sample(sample.time_us, sample.links, sample.contacts, sample.values);
  }
  add_until(std::numeric_limits<std::uint64_t>::max());
  out.close();
}

}  // namespace koboshi::view
