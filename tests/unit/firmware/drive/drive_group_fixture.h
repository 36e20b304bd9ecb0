#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware/drive/drive_group.h"
#include "hal/fake/can.h"
#include "hal/port/period.h"
#include "tests/support/drive_stub.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::drive {

namespace cia402 = canopen::cia402;
using canopen::HeartbeatEventKind;

// The group with a stub of each drive. SDO and NMT use a fake bus; the test passes the cyclic signals
// directly.
class DriveGroupTest : public testing::Test {
 protected:
  DriveGroupTest() {
    for (std::size_t i = 0; i < model.joint_count; ++i) drives.emplace_back(model.joints[i].drive);
  }

  void run_ms(int duration_ms) {
    for (int i = 0; i < duration_ms; ++i, now_us += 1'000) {
      group.process(now_us);
      std::vector<hal::CanFrame> answers;
      for (const hal::CanFrame& frame : can.sent()) {
        for (test::DriveStub& drive : drives) drive.on_frame(frame, answers);
      }
      can.clear_sent();
      for (const hal::CanFrame& answer : answers) hear(answer);
    }
  }
  void hear(const hal::CanFrame& frame) {
    group.on_frame(frame);
    if (const auto heartbeat = canopen::decode_heartbeat(frame)) {
      if (heartbeat->state == canopen::NmtState::kInitialising)
        tell(heartbeat->node_id, HeartbeatEventKind::kBootedUp);
    }
  }
  void tell(std::uint8_t node_id, HeartbeatEventKind kind) {
    group.on_heartbeat({.node_id = node_id, .kind = kind});
  }
  // Runs a control cycle: the drives obey and answer the last commands, then the group issues the next ones.
  void cycle() {
    for (std::size_t i = 0; i < drives.size(); ++i) {
      if (drives[i].hangs) continue;
      signals.statusword[i] = drives[i].cycle(signals.controlword[i], signals.target_position[i]);
      group.on_answer(i);
    }
    group.observe(now_us);
    group.command();
    now_us += hal::kControlPeriod_us;
  }
  void cycles(int count) {
    for (int i = 0; i < count; ++i) cycle();
  }
  void boot() {
    group.boot();
    run_ms(700);
    cycle();
    ASSERT_TRUE(group.booted());
    ASSERT_FALSE(group.fault());
  }
  void enable() {
    boot();
    group.set_goal(Goal::kEnabled, now_us);
    cycles(5);
    ASSERT_TRUE(group.all_in(cia402::State::kOperationEnabled));
  }

  robot::RobotModel model = test::make_test_robot();
  hal::FakeCan can;
  canopen::CanPortSink sink{can};
  DriveSignals signals;
  DriveGroup group{model, sink, signals};
  std::vector<test::DriveStub> drives;
  std::uint64_t now_us = 0;
};

}  // namespace koboshi::drive
