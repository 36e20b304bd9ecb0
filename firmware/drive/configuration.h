#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/canopen/sdo/client.h"
#include "firmware/drive/fault.h"
#include "firmware/robot/model.h"

namespace koboshi::drive {

inline constexpr std::uint8_t kControllerNodeId = 1;
// Heartbeats, set by hand (2026-11-21; docs/design/timing.md, "Time-outs"). The controller's, and how
// long drives wait for one: three beats, so that a drive stops 10 ms after it would by the loss of SYNC.
inline constexpr std::uint16_t kControllerHeartbeat_ms = 20;
inline constexpr std::uint16_t kControllerHeartbeatLost_ms = 60;
// The heartbeats of drives, and the silence tolerated of them. Missing answers to SYNC show a lost drive
// within 50 ms, so heartbeats may be rare: those of 20 drives load the bus by 1.1 %. Two may be lost on a bad
// bus; 50 ms are margin for a third that waits for its turn.
inline constexpr std::uint16_t kDriveHeartbeat_ms = 100;
inline constexpr std::uint16_t kDriveHeartbeatLost_ms = 350;
// The event timer of a drive's RPDO, one cycle longer than its SYNC time-out: if both are lost, the loss of
// SYNC is reported first.
inline constexpr std::uint16_t kTargetsLost_ms = 60;

// Configures one drive at a time over SDO: checks its identity (0x1018), maps its PDOs by the sequence of CiA
// 301 (7.5.2.36), sets heartbeats, cycle (0x1006, 0x60C2), position limits and mode, and reads its supply
// voltage. A request without answer is repeated, kAttempts times in all.
class Configuration {
 public:
  // Set by hand (2026-11-21): two frames of one request may be lost on a bad bus.
  static constexpr int kAttempts = 3;

  enum class State : std::uint8_t { kIdle, kBusy, kDone, kFailed };

  explicit Configuration(canopen::SdoClient& client) : client_(client) {}

  // Starts the configuration of this joint's drive. The joint must outlive it.
  void begin(const robot::Joint& joint);
  // Proceeds as far as possible without waiting. Call it each millisecond.
  void process(std::uint64_t now_us);

  State state() const { return state_; }
  // The reason in the state kFailed; kNone in all others.
  DriveFault fault() const { return fault_; }
  // The drive's supply in mV (0x6079), in the state kDone; before, that of the drive configured last, or 0.
  std::uint32_t supply_mV() const { return supply_mV_; }

 private:
  struct Step;
  static const Step kSteps[];
  std::uint32_t value_of(const Step& step) const;
  bool begin_step(std::uint64_t now_us);
  void finish_step();
  void fail(DriveFault fault);

  canopen::SdoClient& client_;
  const robot::Joint* joint_ = nullptr;
  State state_ = State::kIdle;
  DriveFault fault_ = DriveFault::kNone;
  std::size_t number_ = 0;
  int attempt_ = 0;
  bool requested_ = false;
  std::uint32_t supply_mV_ = 0;
};

}  // namespace koboshi::drive
