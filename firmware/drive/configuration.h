#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/canopen/sdo/client.h"
#include "firmware/drive/fault.h"
#include "firmware/robot/model.h"

namespace koboshi::drive {

inline constexpr std::uint8_t kControllerNodeId = 1;
inline constexpr std::uint16_t kControllerHeartbeat_ms = 20;      // what the controller produces
inline constexpr std::uint16_t kControllerHeartbeatLost_ms = 60;  // what the drives tolerate
inline constexpr std::uint16_t kDriveHeartbeat_ms = 100;
inline constexpr std::uint16_t kDriveHeartbeatLost_ms = 350;  // two may be lost on a bad bus
// A drive without targets says so a cycle after one without SYNC would: that is told first when both are
// gone.
inline constexpr std::uint16_t kTargetsLost_ms = 60;

// Writes into one drive after the other, over SDO, what it must know before it may move: it checks the
// drive's identity (0x1018), maps its PDOs by the sequence of CiA 301 (7.5.2.36), sets the heartbeats, the
// cycle (0x1006, 0x60C2), position limits and the mode, and reads its supply. A request that is not answered
// is made again, kAttempts times in all.
class Configuration {
 public:
  static constexpr int kAttempts = 3;

  enum class State : std::uint8_t { kIdle, kBusy, kDone, kFailed };

  explicit Configuration(canopen::SdoClient& client) : client_(client) {}

  // Starts over with this joint's drive, which must outlive the configuration.
  void begin(const robot::Joint& joint);
  // Goes on as far as it can without waiting.
  void process(std::uint64_t now_us);

  State state() const { return state_; }
  DriveFault fault() const { return fault_; }
  // The drive's supply in mV (0x6079), once done.
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
