#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "bus/dictionary/network.h"
#include "sim_board/can/transport/transport.h"
#include "sim_board/description/description.h"
#include "simulation/scenario/object_access.h"
#include "studio/run/inbox.h"
#include "studio/run/sdo_loan.h"
#include "studio/run/session.h"
#include "studio/run/walk_deadline.h"
#include "view/recording/recording.h"

namespace koboshi::studio {

// Follows a robot on a CAN bus that runs elsewhere: `koboshi run --realtime`, `koboshi board`, or a real one.
// It records what the bus carries: all frames, each value of the known messages as a signal, the joint angles
// as poses of a robot that stands on its soles, and emergencies, NMT commands and changes of NMT states as
// events. It sends nothing unless it is told to. A thread of its own reads the bus; times are since then.
//
// It is the dead man's switch of a walk: a velocity that is not given again within kWalkTimeout_us, and the
// end of the monitor, stop the robot. For the case that this program is killed, it arms a deadline of the
// controller's own (WalkDeadline) before each walk. A walk begins once the robot has answered that.
class BusMonitor {
 public:
  // Four repetitions of HeldWalk. Less would end walks when a loaded machine pauses the window.
  static constexpr std::uint64_t kWalkTimeout_us = 400'000;

  // The robot's file gives the nodes and their messages. Throws InputError.
  BusMonitor(std::unique_ptr<sim_board::Transport> transport, const std::filesystem::path& robot_file);
  ~BusMonitor();
  BusMonitor(const BusMonitor&) = delete;
  BusMonitor& operator=(const BusMonitor&) = delete;

  // Where the bus is, for users.
  std::string place() const { return place_; }
  // A recording without its samples, events and frames.
  const view::Recording& head() const { return head_; }
  const sim_board::RobotDescription& robot() const { return robot_; }
  const bus::Network& network() const { return network_; }

  [[nodiscard]] Batch take() { return inbox_.take(); }
  // Sends commands and accesses objects. Returns false for input that only a simulation can take.
  [[nodiscard]] bool give(const Input& input);
  // Accesses wait until the loan is gone.
  [[nodiscard]] std::shared_ptr<SdoLoan> borrow_sdo();
  // Whether the robot has the deadline that ends a walk if this program is killed.
  WalkDeadline::State walk_deadline() const { return deadline_state_; }
  // The error that ended the monitor, one line; empty: it runs.
  std::string error() const;

 private:
  struct Sink final : canopen::FrameSink {
    explicit Sink(BusMonitor& of) : monitor(of) {}
    bool send(const hal::CanFrame& frame) override { return monitor.send(frame); }
    BusMonitor& monitor;
  };

  void run(const std::stop_token& stop);
  void obey();
  bool send(const hal::CanFrame& frame);
  void send(const simulation::Command& command);
  void obey(const simulation::Command& command);
  bool lends_sdo();
  void take_answers(std::uint64_t now_us);
  void arm_deadline();
  void end_walk();
  void restore_deadline();
  void take_frame(const hal::CanFrame& frame, std::uint64_t now_us);
  void take_values(const hal::CanFrame& frame);
  void take_event(const hal::CanFrame& frame, std::uint64_t now_us);
  void take_foreign(const sim_board::ForeignFrame& frame, std::uint64_t now_us);
  void add_sample(std::uint64_t now_us);

  const sim_board::RobotDescription robot_;
  const bus::Network network_;
  const std::unique_ptr<sim_board::Transport> transport_;
  const std::string place_;
  const std::map<std::uint16_t, std::size_t> first_signals_;  // of each message, by identifier
  const view::Recording head_;
  Inbox inbox_;

  // State that only the thread uses:
  struct Placer;
  std::unique_ptr<Placer> placer_;
  Sink sink_;
  simulation::ObjectAccess access_;
  std::uint64_t now_us_ = 0;
  std::vector<float> values_;
  std::vector<double> angles_rad_;
  std::map<std::uint8_t, std::uint8_t> nmt_states_;  // by node
  std::vector<view::Event> events_;
  std::array<bool, 4> foreign_seen_{};                // by the kind of the frame
  std::optional<std::uint64_t> walk_us_;              // when the velocity of a walk was given last
  std::optional<simulation::Command> awaiting_walk_;  // waits for the deadline
  WalkDeadline deadline_;
  std::atomic<WalkDeadline::State> deadline_state_ = WalkDeadline::State::kUnknown;

  mutable std::mutex mutex_;
  std::vector<Input> given_;
  std::weak_ptr<SdoLoan> loan_;
  std::string error_;

  std::jthread thread_;  // last member: it uses the others
};

}  // namespace koboshi::studio
