#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/sdo/protocol.h"
#include "sim_board/drive/drive.h"

namespace koboshi::sim_board {

using State = canopen::cia402::State;
namespace cia402 = canopen::cia402;
using canopen::ObjectAddress;

inline constexpr std::uint8_t kNode = 20;
inline constexpr std::uint64_t kLoop_us = 1'000;
inline constexpr std::uint64_t kCycle_us = 10'000;
inline constexpr std::int32_t kDegree = 2913;  // 2^-20 turn
inline constexpr std::uint16_t kWayToOperation[] = {cia402::kControlShutdown, cia402::kControlSwitchOn,
                                                    cia402::kControlEnableOperation};

// One drive on a bus, and in place of the controller a node that a test speaks through. The shaft stands
// where the test puts it.
class DriveTest : public testing::Test, private BusNode {
 protected:
  explicit DriveTest(const JointDescription& description = {})
      : joint(description), controller_(bus.attach(*this, AcceptanceFilter::all(), 64)) {
    bus.attach(bystander_, AcceptanceFilter(), 1);
    joint.drive.node_id = kNode;
    joint.max_speed_rad_per_s = 7.48;
    drive.emplace(joint, bus);
    drive->set_enable_line(true);
    drive->power_on(0);
    run_ms(60);
  }

  void run_ms(int duration_ms) {
    for (int i = 0; i < duration_ms; ++i, now_us += kLoop_us) {
      bus.advance_to(now_us);
      if (heartbeats && now_us % 20'000 == 0) say({.identifier = 0x701, .size = 1, .data = {5}});
      if (syncs && now_us % kCycle_us == 0) {
        hal::CanFrame words{.identifier = 0x200 + kNode, .size = 6};
        canopen::store_u16(&words.data[0], controlword);
        canopen::store_u32(&words.data[2], static_cast<std::uint32_t>(target));
        say(words);
        say({.identifier = 0x080});
      }
      drive->update(shaft, now_us);
      drive->draw(shaft);
      torque = drive->torque(supply_V);
    }
  }
  void say(const hal::CanFrame& frame) { ASSERT_TRUE(bus.queue(controller_, frame, now_us)); }
  void write(ObjectAddress address, std::uint32_t value, std::size_t size) {
    hal::CanFrame frame{.identifier = 0x600 + kNode, .size = 8};
    frame.data = canopen::sdo::message(canopen::sdo::expedited(canopen::sdo::kInitiateDownloadRequest, size),
                                       address, value);
    say(frame);
    run_ms(2);
  }
  // The abort code that an SDO client sees, 0 for a write that went well.
  std::uint32_t abort_of(ObjectAddress address, std::uint32_t value, std::size_t size) {
    heard.clear();
    write(address, value, size);
    for (const hal::CanFrame& frame : heard) {
      if (frame.identifier == 0x580 + kNode && frame.data[0] == 0x80)
        return canopen::load_u32(&frame.data[4]);
    }
    return 0;
  }
  // As the controller configures it, in short, and operational.
  void configure() {
    write({0x1400, 1}, 0x8000'0000u + 0x200 + kNode, 4);
    write({0x1400, 2}, 1, 1);
    write({0x1600, 0}, 0, 1);
    write({0x1600, 1}, 0x6040'0010, 4);
    write({0x1600, 2}, 0x607A'0020, 4);
    write({0x1600, 0}, 2, 1);
    write({0x1400, 1}, 0x200 + kNode, 4);
    write({0x1016, 1}, 0x0001'003C, 4);
    write({0x1006, 0}, kCycle_us, 4);
    write({0x6060, 0}, 8, 1);
    say({.identifier = 0x000, .size = 2, .data = {1, kNode}});
    heartbeats = syncs = true;
    run_ms(25);
  }
  void enable() {
    configure();
    for (const std::uint16_t word : kWayToOperation) {
      controlword = word;
      run_ms(12);  // a SYNC, and the time that it takes
    }
    ASSERT_EQ(drive->state(), State::kOperationEnabled);
  }
  std::vector<std::uint16_t> emergencies() const {
    std::vector<std::uint16_t> codes;
    for (const hal::CanFrame& frame : heard) {
      if (const auto emergency = canopen::decode_emergency(frame)) codes.push_back(emergency->code);
    }
    return codes;
  }
  bool is_driven() const { return torque.damping_Nm_s > 0.1; }  // a driven motor brakes by its back EMF

  Bus bus;
  JointDescription joint;
  std::optional<Drive> drive;
  JointState shaft;
  ServoTorque torque;
  std::vector<hal::CanFrame> heard;
  double supply_V = joint.servo.supply_V;
  std::uint64_t now_us = 0;
  std::uint16_t controlword = 0;
  std::int32_t target = 0;
  bool heartbeats = false;
  bool syncs = false;

 private:
  // Acknowledges frames when the drive does not.
  class Bystander final : public BusNode {
    void on_frame(const hal::CanFrame&, std::uint64_t) override {}
  };

  void on_frame(const hal::CanFrame& frame, std::uint64_t) override { heard.push_back(frame); }

  Bystander bystander_;
  NodeHandle controller_;
};

}  // namespace koboshi::sim_board
