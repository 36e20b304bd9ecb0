#pragma once

#include <cstdint>

#include "firmware/behaviour/behaviour.h"
#include "firmware/canopen/node.h"
#include "firmware/drive/drive_group.h"
#include "hal/port/can.h"

namespace koboshi::app {

// Watches over the controller's place on the bus: its NMT state, the CAN controller's errors, and whether
// another master speaks there.
class NetworkWatch {
 public:
  // How long the controller listens for another master before it resets the network: three cycles of one.
  static constexpr std::uint64_t kListen_us = 30'000;
  // Cycles in which a second master was heard count two, the others take one off: so many are no accident.
  static constexpr std::uint8_t kMaxImpostors = 10;
  // How long a boot may last before each time-out of its own.
  static constexpr std::uint64_t kBusTimeout_us = 200'000;
  static constexpr std::uint32_t kSensorStart_us = 500'000;  // until sensors speak first

  // All must outlive the watch.
  NetworkWatch(hal::CanPort& can, canopen::Node& node, const drive::DriveGroup& drives)
      : can_(can), node_(node), drives_(drives) {}

  // A boot begins. When it is to reset the drives: after a power-on, or when another master was there, not
  // before it has listened for one.
  std::uint64_t begin_boot(std::uint64_t now_us);
  // The node has become operational in a boot: its time-outs count from here.
  void on_operational(std::uint64_t now_us) { started_us_ = now_us; }
  // Another node has sent what only the controller may. True: it listens still, and has to give way.
  [[nodiscard]] bool on_impostor();

  // How the drives are started now, as object 0x1F80 asks (CiA 302-2); and whether the controller starts the
  // nodes of sensors then.
  drive::Starting starting(std::uint32_t nmt_startup) const;
  static constexpr bool starts_nodes(drive::Starting starting) {
    return starting == drive::Starting::kEach || starting == drive::Starting::kTogether;
  }

  // Once a control cycle. `boots`: the behaviour is in a boot. Starts the recovery from bus-off.
  behaviour::NetworkStatus update(bool boots, std::uint64_t now_us);

  // What the CAN controller said of itself in the last cycle.
  const hal::CanStatus& can_status() const { return can_status_; }
  bool operational() const { return node_.state() == canopen::NmtState::kOperational; }

 private:
  behaviour::Reason watch_bus(std::uint64_t now_us);
  bool watch_impostors();

  hal::CanPort& can_;
  canopen::Node& node_;
  const drive::DriveGroup& drives_;
  hal::CanStatus can_status_;
  std::uint64_t started_us_ = 0;  // of the boot, or when the node became operational in it
  bool listens_ = true;           // at the next boot: there may be another master
  bool impostor_heard_ = false;   // in this cycle
  std::uint8_t impostors_ = 0;
};

}  // namespace koboshi::app
