#include "view/capture/run_recording.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "base/yaml/yaml_tree.h"
#include "bus/dictionary/network.h"
#include "sim_board/world/options.h"
#include "view/capture/scene.h"

namespace koboshi::view {
namespace {

enum RecordKind : std::uint32_t { kSample, kEvent, kPush, kFrame };

// Time until an event's text is final: a group of emergency messages goes on for fractions of a second.
constexpr std::uint64_t kSettled_us = 1'000'000;

// A record as bytes in the words of a ring.
class Packer {
 public:
  explicit Packer(std::span<std::uint64_t> words) : bytes_(std::as_writable_bytes(words)) {}

  template <typename Value>
  void put(const Value& value) {
    put_bytes(std::as_bytes(std::span(&value, 1)));
  }
  void put_bytes(std::span<const std::byte> bytes) {
    std::ranges::copy(bytes, bytes_.begin());
    bytes_ = bytes_.subspan(bytes.size());
  }

 private:
  std::span<std::byte> bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::span<const std::byte> bytes) : bytes_(bytes) {}
  explicit Unpacker(std::span<const std::uint64_t> words) : Unpacker(std::as_bytes(words)) {}

  template <typename Value>
  Value take() {
    Value value;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_ = bytes_.subspan(sizeof value);
    return value;
  }
  std::string take_text() {
    const auto size = take<std::uint32_t>();
    std::string text(reinterpret_cast<const char*>(bytes_.data()), size);
    bytes_ = bytes_.subspan(size);
    return text;
  }

 private:
  std::span<const std::byte> bytes_;
};

constexpr std::size_t words_for(std::size_t bytes) { return (bytes + 7) / 8; }

// Fixed-size parts of the records.
using PackedVector = std::array<float, 3>;
struct PackedPose {
  PackedVector p_WL_m;
  std::array<float, 4> q_WL;  // x, y, z, w
};
struct PackedContact {
  std::int32_t link;
  std::int32_t other_link;
  PackedVector p_W_m;
  PackedVector f_W_N;
};
struct PackedSampleHead {
  std::uint64_t time_us;
  std::uint32_t links;
  std::uint32_t contacts;
  std::uint64_t values;
};

PackedVector packed(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

PackedPose packed(const Eigen::Isometry3d& pose) {
  const Eigen::Quaternionf q = Eigen::Quaterniond(pose.linear()).cast<float>();
  return {packed(Eigen::Vector3d(pose.translation())), {q.x(), q.y(), q.z(), q.w()}};
}

std::vector<Signal> signals_of(const sim_board::RobotDescription& robot) {
  std::vector<Signal> signals;
  for (const simulation::TraceColumn& column : simulation::RunRecorder::columns(robot)) {
    Signal signal{.name = column.name, .unit = column.unit};
    for (const canopen::ValueName& name : column.names)
      signal.names.emplace_back(name.value, std::string(name.name));
    signals.push_back(std::move(signal));
  }
  return signals;
}

// The names that plots and layers of a run know.
constexpr const char* kBasePlace[] = {"true_base_x", "true_base_y", "true_base_z"};

std::vector<Signal> signals_of_board(const sim_board::RobotDescription& robot) {
  std::vector<Signal> signals;
  for (const char* name : kBasePlace) signals.push_back({.name = name, .unit = "m"});
  for (const auto& joint : robot.joints) signals.push_back({.name = joint.name + "_true", .unit = "rad"});
  return signals;
}

Recording head_of(const simulation::Scenario& scenario, const sim_board::RobotDescription& robot,
                  const sim_board::SimBoard& board) {
  Recording head;
  head.title = scenario.file.stem().string();
  if (scenario.document.kind == YamlNode::Kind::kMap) head.scenario = yaml_text(scenario.document);
  head.seed = scenario.seed;
  head.stepper = sim_board::name_of(scenario.physics.stepper);
  head.version = KOBOSHI_VERSION;
  for (bus::NetworkNode& node : bus::network_nodes(robot))
    head.nodes.push_back({node.node_id, std::move(node.name)});
  head.scene = make_scene(robot, board.ground(), board.free_bodies());
  return head;
}

bool same(const simulation::RunEvent& a, const simulation::RunEvent& b) {
  return a.time_us == b.time_us && a.kind == b.kind && a.text == b.text;
}

}  // namespace

Recording recording_head(const simulation::Simulation& simulation) {
  Recording head = head_of(simulation.scenario(), simulation.robot(), simulation.board());
  head.signals = signals_of(simulation.robot());
  return head;
}

Recording recording_head(const simulation::BoardWithoutController& board) {
  Recording head = head_of(board.scenario(), board.robot(), board.board());
  head.signals = signals_of_board(board.robot());
  return head;
}

RunRecording::RunRecording(const std::filesystem::path& file, const simulation::Simulation& simulation,
                           const Options& options)
    : RunRecording(
          file, recording_head(simulation), simulation.board(), simulation.robot(),
          [&simulation]() -> const std::vector<simulation::Push>& { return simulation.pushes(); }, options) {}

RunRecording::RunRecording(const simulation::BoardWithoutController& board, RecordingListener& listener)
    : RunRecording(
          {}, recording_head(board), board.board(), board.robot(),
          [&board]() -> const std::vector<simulation::Push>& { return board.pushes(); },
          Options{.when_full = simulation::WhenFull::kDrop, .listener = &listener}) {}

RunRecording::RunRecording(const std::filesystem::path& file, const Recording& head,
                           const sim_board::SimBoard& board, const sim_board::RobotDescription& robot,
                           std::function<const std::vector<simulation::Push>&()> pushes,
                           const Options& options)
    : mesh_faults_(head.scene.mesh_faults),
      board_(board),
      robot_(robot),
      pushes_(std::move(pushes)),
      period_us_(options.period_us),
      listener_(options.listener),
      writer_(simulation::BackgroundWriter::kDefaultRingWords, options.when_full,
              [this](const simulation::Ring::Record& record) { write(record); }) {
  if (!file.empty()) file_.emplace(file, head);
  values_.assign(head.signals.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
    const auto signal = std::ranges::find(head.signals, robot.joints[joint].name + "_true", &Signal::name);
    if (signal != head.signals.end())
      true_joints_.push_back(
          {static_cast<int>(joint), static_cast<std::size_t>(signal - head.signals.begin())});
  }
}

void RunRecording::on_bus_frame(const hal::CanFrame& frame, std::uint64_t /*start_us*/,
                                std::uint64_t end_us) {
  const auto words = writer_.claim(kFrame, 1 + words_for(sizeof frame));
  if (words.empty()) return;
  Packer packer(words);
  packer.put(end_us);
  packer.put(frame);
  writer_.publish();
}

void RunRecording::record(const simulation::RunRecorder& recorder) {
  const std::uint64_t now_us = board_.now_us();
  if (now_us % period_us_ != 0) return;
  writer_.check();
  if (now_us % sim_board::SimBoard::kTick_us == 0) {
    record_pushes(now_us);
    if (now_us >= kSettled_us) record_events(now_us - kSettled_us, recorder.events().so_far());
    std::ranges::transform(recorder.row(), values_.begin(), [](const simulation::TraceValue& value) {
      return static_cast<float>(value.number());
    });
  } else {
    record_true_joints();
  }
  record_sample(now_us);
}

void RunRecording::record() {
  const std::uint64_t now_us = board_.now_us();
  if (now_us % period_us_ != 0) return;
  record_pushes(now_us);
  const Eigen::Vector3d p_WB_W = board_.world().body(0).X_WL.translation();
  std::ranges::transform(p_WB_W, values_.begin(), [](double x) { return static_cast<float>(x); });
  record_true_joints();
  record_sample(now_us);
}

void RunRecording::record_true_joints() {
  for (const TrueJoint& joint : true_joints_)
    values_[joint.signal] = static_cast<float>(board_.world().joint(joint.joint).position_rad);
}

void RunRecording::record_sample(std::uint64_t now_us) {
  const sim_board::World& world = board_.world();
  const std::span<const sim_board::FreeBodyState> bodies = world.free_bodies();
  const std::size_t links = robot_.links.size() + bodies.size();
  const std::span<const sim_board::Contact> contacts = world.contacts();
  const std::size_t bytes = sizeof(PackedSampleHead) + links * sizeof(PackedPose) +
                            contacts.size() * sizeof(PackedContact) + values_.size() * sizeof(float);
  const auto words = writer_.claim(kSample, words_for(bytes));
  if (words.empty()) return;
  Packer packer(words);
  packer.put(PackedSampleHead{now_us, static_cast<std::uint32_t>(links),
                              static_cast<std::uint32_t>(contacts.size()), values_.size()});
  for (std::size_t link = 0; link < robot_.links.size(); ++link)
    packer.put(packed(world.body(static_cast<int>(link)).X_WL));
  for (const sim_board::FreeBodyState& body : bodies) packer.put(packed(body.X_WF));
  for (const sim_board::Contact& contact : contacts)
    packer.put(PackedContact{contact.link, contact.other_link, packed(contact.p_W), packed(contact.f_W)});
  packer.put_bytes(std::as_bytes(std::span(values_)));
  writer_.publish();
  if (listener_ != nullptr) writer_.hurry();  // a page shows it now, not when a batch is full
}

void RunRecording::record_events(std::uint64_t until_us, std::span<const simulation::RunEvent> events) {
  for (; next_event_ < events.size() && events[next_event_].time_us <= until_us; ++next_event_) {
    const simulation::RunEvent& event = events[next_event_];
    const std::size_t bytes =
        sizeof(std::uint64_t) + 2 * sizeof(std::uint32_t) + event.kind.size() + event.text.size();
    const auto words = writer_.claim(kEvent, words_for(bytes));
    if (words.empty()) continue;
    Packer packer(words);
    packer.put(event.time_us);
    for (const std::string& text : {event.kind, event.text}) {
      packer.put(static_cast<std::uint32_t>(text.size()));
      packer.put_bytes(std::as_bytes(std::span(text)));
    }
    writer_.publish();
    recorded_.push_back({event.time_us, event.kind, event.text});
  }
}

void RunRecording::record_pushes(std::uint64_t now_us) {
  const auto& pushes = pushes_();
  for (; next_push_ < pushes.size() && pushes[next_push_].at_us <= now_us; ++next_push_) {
    const simulation::Push& push = pushes[next_push_];
    const int link = robot_.find_link(push.link.text).value_or(0);
    const Eigen::Vector3d p_L_m = push.p_L_m.value_or(robot_.links[static_cast<std::size_t>(link)].p_LCom_L);
    const auto words = writer_.claim(kPush, words_for(2 * sizeof(std::uint64_t) + 8 * sizeof(double)));
    if (words.empty()) continue;
    Packer packer(words);
    packer.put(push.at_us);
    packer.put(push.at_us + push.duration_us);
    packer.put(std::int64_t{link});
    for (const double value : p_L_m) packer.put(value);
    for (const double value : push.force_W_N) packer.put(value);
    writer_.publish();
  }
}

void RunRecording::write(const simulation::Ring::Record& record) {
  Unpacker words(record.words);
  switch (static_cast<RecordKind>(record.kind)) {
    case kSample:
      return write_sample(std::as_bytes(record.words));
    case kEvent: {
      Event event{.time_us = words.take<std::uint64_t>()};
      event.kind = words.take_text();
      event.text = words.take_text();
      return add(event);
    }
    case kPush: {
      Push push{.start_us = words.take<std::uint64_t>()};
      push.end_us = words.take<std::uint64_t>();
      push.link = static_cast<int>(words.take<std::int64_t>());
      for (double& value : push.p_L_m) value = words.take<double>();
      for (double& value : push.f_W_N) value = words.take<double>();
      if (file_) file_->add_push(push);
      if (listener_ != nullptr) listener_->add_push(push);
      return;
    }
    case kFrame: {
      Frame frame{.end_us = words.take<std::uint64_t>()};
      frame.frame = words.take<hal::CanFrame>();
      if (file_) file_->add_frame(frame);
      if (listener_ != nullptr) listener_->add_frame(frame);
      return;
    }
  }
}

void RunRecording::write_sample(std::span<const std::byte> bytes) {
  Unpacker words(bytes);
  const auto head = words.take<PackedSampleHead>();
  links_.resize(head.links);
  for (Pose& pose : links_) {
    const auto packed = words.take<PackedPose>();
    pose = {Eigen::Vector3f(packed.p_WL_m.data()), Eigen::Quaternionf(packed.q_WL.data())};
  }
  contacts_.resize(head.contacts);
  for (ContactForce& contact : contacts_) {
    const auto packed = words.take<PackedContact>();
    contact = {packed.link, packed.other_link, Eigen::Vector3f(packed.p_W_m.data()),
               Eigen::Vector3f(packed.f_W_N.data())};
  }
  sample_values_.resize(head.values);
  for (float& value : sample_values_) value = words.take<float>();
  if (file_) file_->add_sample(head.time_us, links_, contacts_, sample_values_);
  if (listener_ != nullptr && head.time_us % sim_board::SimBoard::kTick_us == 0)
    listener_->add_sample(head.time_us, links_, contacts_, sample_values_);
}

void RunRecording::add(const Event& event) {
  if (file_) file_->add_event(event);
  if (listener_ != nullptr) listener_->add_event(event);
}

// The end of a run changes events that are not settled, and adds the verdict.
void RunRecording::close(std::span<const simulation::RunEvent> events) {
  writer_.close();
  for (const simulation::RunEvent& event : events) {
    const auto is_same = [&](const simulation::RunEvent& other) { return same(event, other); };
    if (std::ranges::none_of(recorded_, is_same)) add({event.time_us, event.kind, event.text});
  }
  if (file_) file_->close();
}

}  // namespace koboshi::view
