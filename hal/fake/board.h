#pragma once

#include <cstdint>
#include <span>

#include "hal/fake/can.h"
#include "hal/fake/safety.h"
#include "hal/fake/sensors.h"
#include "hal/fake/storage.h"
#include "hal/port/board.h"

namespace koboshi::hal {

// A complete fake board for unit tests of controller logic: scripted, deterministic, without a clock.
//
//   FakeBoard board;
//   Subject subject(board.ports());
//   board.can.deliver({.identifier = 0x181, .size = 2, .data = {0x37, 0x16}});
//   subject.service(1'000);
//   EXPECT_EQ(board.can.sent().size(), 1);
//
struct FakeBoard {
  FakeCan can;
  FakeImu imu;
  FakeAnkles ankles;
  FakeStorage storage{128, 2048};  // as in hal/flash
  FakeWatchdog watchdog;
  FakeDriveEnable drive_enable;
  std::span<const std::uint8_t> sensor_nodes;  // empty: the sensors are wired to the controller

  // Returns the ports, valid as long as this object exists at its address.
  [[nodiscard]] Board ports() { return {can, imu, ankles, storage, watchdog, drive_enable, sensor_nodes}; }
};

}  // namespace koboshi::hal
