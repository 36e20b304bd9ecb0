#include "studio/run/bus_monitor.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>

#include "bus/can/describe.h"
#include "bus/can/sdo_transfer.h"
#include "bus/can/source.h"
#include "bus/dictionary/object_names.h"
#include "firmware/canopen/frame.h"
#include "sim_board/can/candump_line.h"
#include "sim_board/description/load.h"
#include "simulation/scenario/operator_pc.h"
#include "tools/motion_view/placement.h"
#include "view/capture/scene.h"

namespace koboshi::studio {
namespace {

constexpr std::uint16_t kSyncIdentifier = 0x080;
constexpr std::uint64_t kWait_us = 1000;
// The robot's process or this one may pause for longer than the 100 ms that a simulation allows.
constexpr std::uint64_t kSdoTimeout_us = bus::SdoTransfer::kTimeout_us;
// Without SYNC, as after a stop of the controller, samples come at this interval.
constexpr std::uint64_t kLongestSample_us = 100'000;
constexpr const char* kPosition = "position_actual_value";

// The index of each message's first signal, if all are in one list.
std::map<std::uint16_t, std::size_t> first_signals_of(const bus::Network& network) {
  std::map<std::uint16_t, std::size_t> first;
  std::size_t next = 0;
  for (const bus::Message& message : network.messages) {
    first[message.identifier] = next;
    next += message.signals.size();
  }
  return first;
}

// The signals of all messages, under "message.signal".
std::vector<view::Signal> signals_of(const bus::Network& network) {
  std::vector<view::Signal> signals;
  for (const bus::Message& message : network.messages) {
    for (const bus::Signal& signal : message.signals) {
      view::Signal& shown = signals.emplace_back();
      shown.name = message.name + "." + signal.name;
      shown.unit = signal.unit;
      for (const canopen::ValueName& value : signal.values)
        shown.names.emplace_back(value.value, std::string(value.name));
    }
  }
  return signals;
}

view::Recording make_head(const sim_board::RobotDescription& robot, const bus::Network& network,
                          const std::string& place) {
  view::Recording head;
  head.title = place;
  head.complete = false;
  head.scene = view::make_scene(robot, sim_board::GroundDescription());
  for (const bus::NetworkNode& node : network.nodes)
    if (node.node_id != 0) head.nodes.push_back({node.node_id, node.name});
  head.signals = signals_of(network);
  return head;
}

}  // namespace

// Placement refers to the robot and has a state of its own.
struct BusMonitor::Placer {
  explicit Placer(const sim_board::RobotDescription& robot) : placement(robot) {}
  tools::Placement placement;
};

BusMonitor::BusMonitor(std::unique_ptr<sim_board::Transport> transport,
                       const std::filesystem::path& robot_file)
    : robot_(sim_board::load_robot(robot_file)),
      network_(bus::make_network(robot_)),
      transport_(std::move(transport)),
      place_(transport_->place()),
      first_signals_(first_signals_of(network_)),
      head_(make_head(robot_, network_, place_)),
      placer_(std::make_unique<Placer>(robot_)),
      sink_(*this),
      access_(sink_, kSdoTimeout_us),
      values_(head_.signals.size(), std::numeric_limits<float>::quiet_NaN()),
      angles_rad_(robot_.joints.size(), 0.0) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

BusMonitor::~BusMonitor() {
  thread_.request_stop();
  thread_.join();
}

bool BusMonitor::give(const Input& input) {
  if (!std::holds_alternative<simulation::Command>(input) &&
      !std::holds_alternative<simulation::ObjectRequest>(input))
    return false;
  const std::scoped_lock lock(mutex_);
  given_.push_back(input);
  return true;
}

std::shared_ptr<SdoLoan> BusMonitor::borrow_sdo() {
  const std::scoped_lock lock(mutex_);
  if (auto lent = loan_.lock()) return lent;
  auto loan = std::make_shared<SdoLoan>();
  loan_ = loan;
  return loan;
}

// Grants a loan that was asked for, once the access under way has ended. Returns whether it is granted.
bool BusMonitor::lends_sdo() {
  std::shared_ptr<SdoLoan> loan;
  {
    const std::scoped_lock lock(mutex_);
    loan = loan_.lock();
  }
  if (!loan || access_.busy()) return false;
  loan->grant();
  return true;
}

std::string BusMonitor::error() const {
  const std::scoped_lock lock(mutex_);
  return error_;
}

void BusMonitor::run(const std::stop_token& stop) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto now_us = [&] {
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start).count());
  };
  std::uint64_t sampled_us = 0;
  try {
    transport_->watch_foreign([&](const sim_board::ForeignFrame& frame) { take_foreign(frame, now_us()); });
    while (!stop.stop_requested()) {
      now_us_ = now_us();
      obey();
      if (walk_us_ && now_us_ - *walk_us_ > kWalkTimeout_us) end_walk();
      arm_deadline();
      if (!lends_sdo()) access_.process(now_us());
      take_answers(now_us());
      bool sync = false;
      while (const auto frame = transport_->receive()) {
        // The SYNC ends a cycle: the values are those that came before it.
        if (frame->identifier == kSyncIdentifier && !frame->remote) {
          sync = true;
          add_sample(sampled_us = now_us());
        }
        take_frame(*frame, now_us());
      }
      if (!sync && now_us() - sampled_us >= kLongestSample_us) add_sample(sampled_us = now_us());
      transport_->flush();
      bus::wait_for_frames(*transport_, kWait_us);
    }
    end_walk();
    restore_deadline();
    transport_->flush();
  } catch (const std::exception& error) {
    const std::scoped_lock lock(mutex_);
    error_ = error.what();
  }
}

void BusMonitor::obey() {
  std::vector<Input> given;
  {
    const std::scoped_lock lock(mutex_);
    given = std::exchange(given_, {});
  }
  for (Input& input : given) {
    if (auto* request = std::get_if<simulation::ObjectRequest>(&input)) access_.request(std::move(*request));
    if (const auto* command = std::get_if<simulation::Command>(&input)) obey(*command);
  }
}

// A walk waits for the deadline; its last velocity counts.
void BusMonitor::obey(const simulation::Command& command) {
  awaiting_walk_.reset();
  walk_us_.reset();
  if (command.kind != simulation::Command::Kind::kWalk) {
    deadline_.disarm();
    return send(command);
  }
  walk_us_ = now_us_;
  awaiting_walk_ = command;
  deadline_.arm();
}

void BusMonitor::arm_deadline() {
  if (auto request = deadline_.due(now_us_)) access_.request_first(std::move(*request));
  if (!awaiting_walk_ || !deadline_.permits_walk()) return;
  send(*awaiting_walk_);
  awaiting_walk_.reset();
}

void BusMonitor::take_answers(std::uint64_t now_us) {
  std::vector<simulation::ObjectAnswer> answers = access_.take_answers();
  std::erase_if(answers,
                [&](const simulation::ObjectAnswer& answer) { return deadline_.take(answer, now_us); });
  deadline_state_ = deadline_.state();
  if (!answers.empty()) inbox_.add_answers(std::move(answers));
}

// A bus does not return what this program sends, so it is recorded here.
bool BusMonitor::send(const hal::CanFrame& frame) {
  if (!transport_->send(frame, 0)) return false;
  inbox_.add_frame({.end_us = now_us_, .frame = frame});
  take_values(frame);
  return true;
}

void BusMonitor::send(const simulation::Command& command) {
  for (const hal::CanFrame& frame : simulation::command_frames(command)) {
    bus::send_surely(*transport_, frame);
    inbox_.add_frame({.end_us = now_us_, .frame = frame});
    take_values(frame);
  }
}

// A walk that still waits for the deadline has not begun.
void BusMonitor::end_walk() {
  deadline_.disarm();
  const bool walks = std::exchange(walk_us_, std::nullopt) && !std::exchange(awaiting_walk_, std::nullopt);
  if (!walks) return;
  simulation::Command stop;
  stop.kind = simulation::Command::Kind::kStop;
  send(stop);
}

// At the end, nobody waits for the robot's answer. A transfer that is under way ends with this request.
void BusMonitor::restore_deadline() {
  const auto request = deadline_.restoring();
  if (!request) return;
  simulation::ObjectAccess last(sink_);
  last.request(*request);
  last.process(now_us_);
}

void BusMonitor::take_frame(const hal::CanFrame& frame, std::uint64_t now_us) {
  inbox_.add_frame({.end_us = now_us, .frame = frame});
  static_cast<void>(access_.on_frame(frame, now_us));
  take_values(frame);
  take_event(frame, now_us);
}

void BusMonitor::take_values(const hal::CanFrame& frame) {
  const auto first = first_signals_.find(frame.identifier);
  if (first == first_signals_.end() || frame.remote) return;
  const bus::Message& message = *network_.find(frame.identifier);
  const auto joint = std::ranges::find(robot_.joints, message.sender, &sim_board::JointDescription::name);
  for (const bus::Reading& reading : bus::decode(network_, frame)) {
    values_[first->second + static_cast<std::size_t>(reading.signal - message.signals.data())] =
        static_cast<float>(reading.value);
    if (joint == robot_.joints.end() || reading.signal->name != kPosition) continue;
    const double shaft_rad = std::numbers::pi / 180.0 * reading.value;
    angles_rad_[static_cast<std::size_t>(joint - robot_.joints.begin())] =
        joint->drive.sign * (shaft_rad - joint->drive.zero_rad);
  }
}

void BusMonitor::take_event(const hal::CanFrame& frame, std::uint64_t now_us) {
  const bus::FrameKind kind = bus::kind_of(frame);
  if (frame.remote) return;  // node guarding asks; the answer is the event
  if (kind == bus::FrameKind::kHeartbeat) {
    const auto node = static_cast<std::uint8_t>(bus::node_of(frame));
    const std::uint8_t state = frame.data[0] & 0x7F;
    const auto [known, first] = nmt_states_.try_emplace(node, state);
    if (!first && std::exchange(known->second, state) == state) return;
  } else if (kind != bus::FrameKind::kNmt && kind != bus::FrameKind::kEmergency) {
    return;
  }
  const int id = bus::node_of(frame);
  const auto node =
      std::ranges::find(network_.nodes, id, [](const bus::NetworkNode& one) { return int{one.node_id}; });
  const std::string name = id != 0 && node != network_.nodes.end() ? node->name + ": " : std::string();
  events_.push_back({now_us, "can", name + bus::describe(frame)});
  inbox_.set_events(events_);
}

// Only the first frame of each kind is an event: others may fill the bus.
void BusMonitor::take_foreign(const sim_board::ForeignFrame& frame, std::uint64_t now_us) {
  if (std::exchange(foreign_seen_.at(static_cast<std::size_t>(frame.kind)), true)) return;
  events_.push_back({now_us, "can",
                     "not decoded: " + sim_board::frame_notation(frame) + ", " + bus::describe(frame) +
                         "; further ones are skipped"});
  inbox_.set_events(events_);
}

void BusMonitor::add_sample(std::uint64_t now_us) {
  placer_->placement.place(angles_rad_);
  const std::vector<view::Pose> links = placer_->placement.links();
  inbox_.add_sample(now_us, links, {}, values_);
}

}  // namespace koboshi::studio
