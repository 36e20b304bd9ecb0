#pragma once

#include <cstdint>

#include "firmware/behaviour/behaviour.h"
#include "firmware/canopen/node/node.h"
#include "firmware/drive/drive_group.h"
#include "hal/port/can.h"

namespace koboshi::app {

// Monitors the network: the controller's own NMT state, the errors of the CAN controller, and whether there
// is another NMT master (CiA 302-2).
class NetworkWatch {
 public:
  // How long the controller listens for another master before it resets the network: three of its cycles.
  static constexpr std::uint64_t kListen_us = 30'000;
  // Threshold for a second master: each cycle in which one is heard adds two, every other cycle subtracts one
  // (a leaky bucket). A few frames that a person sends by hand stay below.
  static constexpr std::uint8_t kMaxImpostors = 10;
  // Time-outs of a boot, from its start: until another node acknowledges frames, and until the first samples
  // of the sensors.
  static constexpr std::uint64_t kBusTimeout_us = 200'000;
  static constexpr std::uint32_t kSensorStart_us = 500'000;

  // All must outlive the watch.
  NetworkWatch(hal::CanPort& can, canopen::Node& node, const drive::DriveGroup& drives)
      : can_(can), node_(node), drives_(drives) {}

  // To be called when a boot begins. Returns when to reset the drives: at once; or after kListen_us, at
  // power-on and after another master was heard.
  std::uint64_t begin_boot(std::uint64_t now_us);
  // To be called when the node enters operational in a boot: restarts its time-outs.
  void on_operational(std::uint64_t now_us) { started_us_ = now_us; }
  // To be called when another node sends a frame that only the controller may send. True while the controller
  // still listens: it then must give way.
  [[nodiscard]] bool on_impostor();

  // How the drives are started now, as object 0x1F80 asks (CiA 302-2); and whether the controller starts the
  // nodes of sensors then.
  drive::Starting starting(std::uint32_t nmt_startup) const;
  static constexpr bool starts_nodes(drive::Starting starting) {
    return starting == drive::Starting::kEach || starting == drive::Starting::kTogether;
  }

  // To be called once a control cycle. `boots`: the behaviour is in a boot. Starts the recovery from bus-off.
  behaviour::NetworkStatus update(bool boots, std::uint64_t now_us);

  // The state of the CAN controller in the last cycle.
  const hal::CanStatus& can_status() const { return can_status_; }
  bool operational() const { return node_.state() == canopen::NmtState::kOperational; }

 private:
  behaviour::Reason watch_bus(std::uint64_t now_us);
  bool watch_impostors();

  hal::CanPort& can_;
  canopen::Node& node_;
  const drive::DriveGroup& drives_;
  hal::CanStatus can_status_;
  std::uint64_t started_us_ = 0;  // when the boot began, or the node entered operational in it
  bool listens_ = true;           // the next boot listens for another master
  bool impostor_heard_ = false;   // in this cycle
  std::uint8_t impostors_ = 0;    // counts up to kMaxImpostors
};

}  // namespace koboshi::app
