#pragma once

#include <cstdint>

#include "firmware/app/network_watch.h"
#include "firmware/app/sensor_nodes.h"
#include "firmware/behaviour/behaviour.h"
#include "firmware/canopen/node/node.h"
#include "firmware/drive/drive_group.h"
#include "hal/port/safety.h"

namespace koboshi::app {

// Executes the orders of a Decision: the drive-enable line, boots, the drives' goal, and emergency messages.
// Each order is executed once, when the decision first contains it. The joint targets are not its business.
class DecisionExecutor {
 public:
  // All must outlive the executor. `drives_exist`: the robot model is valid, so that there are drives to
  // boot.
  DecisionExecutor(hal::DriveEnablePort& drive_enable, canopen::Node& node, NetworkWatch& network,
                   drive::DriveGroup& drives, SensorNodes& sensor_nodes, bool drives_exist)
      : drive_enable_(drive_enable),
        node_(node),
        network_(network),
        drives_(drives),
        sensor_nodes_(sensor_nodes),
        drives_exist_(drives_exist) {}

  // To be called after everything that may change the decision, a request included.
  void execute(const behaviour::Decision& decision, std::uint64_t now_us);

 private:
  // The orders that have been executed.
  struct Executed {
    std::uint16_t boots = 0;
    std::uint16_t goals = 0;
    bool fault = false;
    bool low_battery = false;
  };

  void boot(std::uint64_t now_us);
  void report(const behaviour::FaultReport& fault);

  hal::DriveEnablePort& drive_enable_;
  canopen::Node& node_;
  NetworkWatch& network_;
  drive::DriveGroup& drives_;
  SensorNodes& sensor_nodes_;
  const bool drives_exist_;
  Executed executed_;
};

}  // namespace koboshi::app
