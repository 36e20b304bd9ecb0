#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/emergency.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/heartbeat.h"
#include "firmware/canopen/sdo/client.h"
#include "firmware/drive/configuration.h"
#include "firmware/drive/fault.h"
#include "firmware/drive/setting.h"
#include "firmware/drive/signals.h"
#include "firmware/drive/status.h"
#include "firmware/fixed/contract.h"
#include "firmware/fixed/debounce.h"
#include "firmware/fixed/literals.h"
#include "firmware/robot/model.h"

namespace koboshi::drive {

// The state to which the drives are led by controlwords, one transition of CiA 402 in each cycle.
enum class Goal : std::uint8_t {
  kTorqueOff,  // switch on disabled
  kEnabled,    // operation enabled; all drives make the last transition in the same cycle
  kQuickStop,  // stop on the drive's own ramp, then torque off
};

// How the drives are started once all of them are configured (CiA 302-2, object 0x1F80).
enum class Starting : std::uint8_t {
  kLater,     // not yet: the controller is not operational
  kEach,      // by an NMT message to each
  kTogether,  // by one NMT message to all nodes
  kByOthers,  // by another NMT master: the group waits until all answer
};

// The highest gain of a position loop that is written, in 0.001 of the drive's own.
inline constexpr std::uint16_t kMaxPositionGain_permille = 2000;

// Boots all servo drives of the robot, leads them to a goal and supervises them. The owner passes on what it
// receives from them. In each cycle it calls `observe`, decides, sets goal and targets, calls `command` and
// sends `signals`, so that a decision takes effect in the same cycle.
class DriveGroup {  // Large: one array per quantity of all drives
 public:
  // From the reset to the last boot-up message. Set by hand (2026-11-21): the simulated drives take 50 ms;
  // the margin is for firmware that starts more slowly.
  static constexpr std::uint64_t kBootTimeout_us = 1'000'000;
  // From the goal to operation enabled. Set by hand (2026-11-21): three transitions of CiA 402 take three
  // cycles, 30 ms; the margin is for drives that take longer for a transition.
  static constexpr std::uint64_t kEnableTimeout_us = 500'000;
  // Between the supply readings of two drives. Set by hand (2026-11-22): a battery discharges in minutes, and
  // four readings a second load the bus by 0.1 %.
  static constexpr std::uint64_t kSupplyPeriod_us = 250'000;
  // How far outside its limits a joint may be when it is enabled, for backlash and offset of a robot that
  // leans on its stops. The first target draws the joint back to its limit. Set by hand (2026-11-21): some
  // three times the backlash of kit servos, 0.01 rad.
  static constexpr auto kEncoderMargin = fixed::literals::operator""_deg(2.0L);
  // Consecutive cycles without an answer, after which a drive is lost. Set by hand (2026-11-21): as many as a
  // drive tolerates without SYNC, so that both ends lose each other after 50 ms.
  static constexpr std::uint16_t kMissedAnswers = 5;

  // The references must outlive the group. It sends to `sink` as NMT master and SDO client.
  DriveGroup(const robot::RobotModel& model, canopen::FrameSink& sink, DriveSignals& signals);

  // Resets the drives at this time, each by a message of its own, which takes them out of any fault, and
  // boots them; forgets every fault. Messages from before a drive's boot-up message are ignored.
  void boot(std::uint64_t reset_us = 0);
  // Sends nothing to the drives until the next boot.
  void give_up() { phase_ = Phase::kFailed; }
  void set_goal(Goal goal, std::uint64_t now_us);

  void on_frame(const hal::CanFrame& frame) {
    client_.on_frame(frame);
    torque_limits_.on_frame(frame);
    position_gains_.on_frame(frame);
  }
  void on_heartbeat(const canopen::HeartbeatEvent& event);
  // Keeps the error code. Communication warnings are ignored: lost frames show as missing answers, and a
  // drive that has stopped reports it in its statusword.
  void on_emergency(const canopen::Emergency& emergency);
  // Notes that statusword and position of the joint's drive were received. Answers from before a boot are
  // ignored.
  void on_answer(std::size_t joint) { answered_ |= std::uint32_t{phase_ >= Phase::kStarting} << joint; }
  // Proceeds with the boot and its time-outs. Call it at 1 kHz.
  void process(std::uint64_t now_us, Starting starting = Starting::kEach);
  // Evaluates the answers of the last cycle.
  void observe(std::uint64_t now_us);
  // Writes the controlwords of the next cycle.
  void command();

  // Sets a joint's target, which the caller has clamped to the joint's limits.
  void set_target(std::size_t joint, fixed::Angle angle) {
    KOBOSHI_ASSERT(joint < model_.joint_count);
    signals_.target_position[joint] = robot::drive_position(model_.joints[joint].drive, angle);
  }
  // Sets the torque limit of a joint's drive, 0 to Setting::kOwn_permille of its rated torque. It is written
  // by SDO once booted; a boot returns it to the full torque.
  void set_torque_limit(std::size_t joint, std::uint16_t limit_permille) {
    torque_limits_.set(joint, limit_permille);
  }
  // Sets the gain of a drive's position loop, up to kMaxPositionGain_permille of its own. Written and reset
  // likewise.
  void set_position_gain(std::size_t joint, std::uint16_t gain_permille) {
    position_gains_.set(joint, gain_permille);
  }
  // Return the joints whose drives have refused torque limits or gains since the last boot; bit i: joint i.
  std::uint32_t without_torque_limit() const { return torque_limits_.refused(); }
  std::uint32_t without_position_gain() const { return position_gains_.refused(); }
  // Returns the last reported angle of a joint. Valid once booted; before, the angle at the position 0, which
  // `boot` sets.
  fixed::Angle angle(std::size_t joint) const;
  // Returns the last reported status of all drives.
  DriveStatus status() const;
  EnableConditions enable_conditions() const;
  // Returns whether the last statusword of every drive shows this state.
  bool all_in(canopen::cia402::State state) const;
  // Returns whether the last statusword of no drive shows a state with torque.
  bool all_limp() const;

  // Returns whether a boot has begun and no reset has been sent yet.
  bool resetting() const { return phase_ == Phase::kResetting; }
  // Return whether every drive is configured and started, and whether each has also answered a SYNC.
  bool configured() const { return phase_ == Phase::kBooted; }
  bool booted() const { return phase_ == Phase::kBooted && (all_joints() & ~has_answered_) == 0; }
  // Returns whether some drive answered in the last cycle: the bus works in both directions.
  bool answering() const { return answering_; }
  // Returns whether the goal kEnabled was reached: all drives in operation enabled, following their targets.
  bool enabled() const { return enabled_; }
  // The first fault since the last boot.
  const JointFault& fault() const { return fault_; }

 private:
  enum class Phase : std::uint8_t { kIdle, kResetting, kWaiting, kConfiguring, kStarting, kBooted, kFailed };

  canopen::cia402::State state(std::size_t joint) const {
    return canopen::cia402::state_of(signals_.statusword[joint]);
  }
  std::uint32_t all_joints() const { return (1u << model_.joint_count) - 1; }
  std::uint16_t controlword(std::size_t joint, bool last_step) const;
  bool within_limits(std::size_t joint) const;
  bool switched_on(std::size_t joint) const;
  bool all_switched_on() const;
  bool send(canopen::NmtCommand command, std::uint8_t node_id);
  bool send_to_each(canopen::NmtCommand command);
  void on_boot_up(std::size_t joint);
  void start(Starting starting);
  bool find(std::uint8_t node_id, std::size_t& joint) const;
  void report(DriveFault fault, std::size_t joint, std::uint16_t error_code = 0);
  void await_boot_ups(std::uint64_t now_us);
  void configure(std::uint64_t now_us);
  void read_supply(std::uint64_t now_us);
  void watch_answers();
  void count_missed();
  void watch_states(std::uint64_t now_us);

  const robot::RobotModel& model_;
  canopen::FrameSink& sink_;
  DriveSignals& signals_;
  canopen::SdoClient client_;
  Configuration configuration_;
  Setting torque_limits_;
  Setting position_gains_;
  Phase phase_ = Phase::kIdle;
  Goal goal_ = Goal::kTorqueOff;
  std::uint64_t reset_us_ = 0;
  std::uint64_t boot_deadline_us_ = 0;
  std::uint64_t enable_deadline_us_ = 0;
  std::size_t addressed_ = 0;   // joints whose drives were sent the reset, or the start
  std::size_t configured_ = 0;  // joints that are done
  static_assert(robot::kMaxJoints < 32);
  std::uint32_t present_ = 0;       // bit i: the boot-up message of joint i's drive has come
  std::uint32_t repeated_ = 0;      // bit i: it has come twice
  std::uint32_t has_answered_ = 0;  // bit i: joint i's drive has answered a SYNC
  std::uint32_t answered_ = 0;      // the same, in the last cycle
  bool answering_ = false;
  std::array<fixed::Debounce, robot::kMaxJoints> missed_{};  // cycles since its last answer
  bool commanded_enabled_ = false;  // the controlwords are those of the goal kEnabled, reached
  bool enabled_ = false;            // the goal kEnabled was reached
  JointFault fault_;
  std::array<std::uint32_t, robot::kMaxJoints> supply_mV_{};
  std::optional<std::uint32_t> reported_supply_mV_;  // since the last cycle
  std::optional<std::uint32_t> new_supply_mV_;       // in the last cycle
  std::uint32_t lowest_supply_mV_ = 0;               // of supply_mV_
  std::uint64_t supply_due_us_ = 0;
  std::size_t supplied_ = 0;  // the joint whose drive was asked last
  std::array<std::uint16_t, robot::kMaxJoints>
      error_code_{};  // the last emergency of each drive that still applies
};

}  // namespace koboshi::drive
