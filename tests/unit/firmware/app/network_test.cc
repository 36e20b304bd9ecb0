// The controller as a node of a network with a second NMT master.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/support/controller_bench.h"
#include "tests/support/sdo_pc.h"

namespace koboshi::app {
namespace {

using canopen::AbortCode;
using canopen::NmtCommand;
using canopen::NmtState;
using test::ControllerBench;
using test::SdoPc;

constexpr canopen::ObjectAddress kNmtStartup{kNmtStartupObject, 0};
constexpr canopen::ObjectAddress kStoredParameter{0x2100, 1};
constexpr std::uint8_t kAll = 0;
constexpr std::uint16_t kHeartbeatOfController = 0x701;
constexpr std::uint16_t kSync = 0x080;

hal::CanFrame nmt(NmtCommand command, std::uint8_t node_id) {
  return canopen::encode(canopen::NmtMessage{.command = command, .node_id = node_id});
}

class ControllerNetwork : public testing::Test {
 protected:
  void order(NmtCommand command, std::uint8_t node_id = drive::kControllerNodeId) {
    const hal::CanFrame frame = nmt(command, node_id);
    if (node_id != drive::kControllerNodeId) bench.tell_drives(frame);
    bench.board.can.deliver(frame);
    bench.run_ms(1);
  }
  // Brings the controller into this state, if it can be reached without physics.
  bool lead_to(State state) {
    switch (state) {
      case State::kBoot:
        bench.restart();
        bench.run_ms(100);
        break;
      case State::kLimp:
        return bench.run_until(State::kLimp);
      case State::kFault:
        if (!bench.run_until_standing()) return false;
        bench.board.can.deliver(bench.drives[6].emergency(0x2310));
        return bench.run_until(State::kFault, 20);
      default:
        if (bench.now().state != State::kStanding && !bench.run_until_ready_to_walk()) return false;
        if (state == State::kMotion) bench.command(Command::kPlay, 1);
        if (state == State::kWalking) bench.command(Command::kWalk);
        if (state == State::kEmergencyStop) bench.command(Command::kEmergencyStop);
    }
    return bench.now().state == state;
  }
  long sent(std::uint16_t identifier) const {
    return std::ranges::count_if(bench.sent, [&](const auto& s) { return s.frame.identifier == identifier; });
  }
  // Returns the NMT commands that the controller sent, in order.
  std::vector<hal::CanFrame> orders() const {
    std::vector<hal::CanFrame> frames;
    for (const auto& [time_us, frame] : bench.sent) {
      if (frame.identifier == canopen::kNmtCobId) frames.push_back(frame);
    }
    return frames;
  }
  std::vector<hal::CanFrame> to_each_drive(NmtCommand command) const {
    std::vector<hal::CanFrame> frames;
    for (const auto& joint : std::span(bench.model().joints).first(bench.model().joint_count))
      frames.push_back(nmt(command, joint.drive.node_id));
    return frames;
  }

  ControllerBench bench;
  SdoPc pc{bench};
};

constexpr State kStatesToReset[] = {State::kBoot,    State::kLimp,  State::kStanding,     State::kMotion,
                                    State::kWalking, State::kFault, State::kEmergencyStop};

// CiA 301, 7.3.2.2: in every state and in each millisecond of the cycle.
TEST_F(ControllerNetwork, AnNmtResetActsAsPowerOn) {
  for (const State state : kStatesToReset) {
    for (int phase_ms = 0; phase_ms < 10; ++phase_ms) {
      const NmtCommand reset = phase_ms % 2 == 0 ? NmtCommand::kResetNode : NmtCommand::kResetCommunication;
      SCOPED_TRACE(testing::Message()
                   << "state " << int(state) << ", command " << int(reset) << ", " << phase_ms);
      ASSERT_TRUE(lead_to(state));
      bench.run_ms(1 + (phase_ms + 10 - static_cast<int>(bench.now_us() / 1'000 % 10)) % 10);
      bench.sent.clear();
      order(reset);
      ASSERT_EQ(bench.now().state, State::kBoot);
      EXPECT_FALSE(bench.board.drive_enable.enabled());
      EXPECT_EQ(bench.sent.front().frame, (hal::CanFrame{.identifier = kHeartbeatOfController, .size = 1}));
      ASSERT_TRUE(bench.run_until(State::kLimp, 700));
      EXPECT_GT(sent(kSync), 50);
      EXPECT_EQ(bench.now().drive_fault, drive::DriveFault::kNone);
    }
    EXPECT_TRUE(bench.run_until_standing());  // the controller accepts commands
    bench.restart();
  }
}

TEST_F(ControllerNetwork, AnNmtResetOfAllNodesActsAsPowerOn) {
  for (const NmtCommand reset : {NmtCommand::kResetNode, NmtCommand::kResetCommunication}) {
    ASSERT_TRUE(bench.run_until_standing());
    order(reset, kAll);
    EXPECT_EQ(bench.now().state, State::kBoot);
    ASSERT_TRUE(bench.run_until(State::kLimp, 700));
  }
}

TEST_F(ControllerNetwork, AResetOfTheNodeLoadsSavedParametersInAStandingRobot) {
  ASSERT_TRUE(bench.run_until_standing());
  ASSERT_EQ(pc.write(kStoredParameter, 6'500, 2), AbortCode::kNone);
  order(NmtCommand::kResetCommunication);
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 6'500);
  order(NmtCommand::kResetNode);
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 6'000);
}

TEST_F(ControllerNetwork, AResetOfTheNodeClearsCommands) {
  ASSERT_TRUE(lead_to(State::kFault));
  ASSERT_EQ(pc.write({kVelocityObject, 1}, 50, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write({kRequestObject, 2}, 7, 2), AbortCode::kNone);
  ASSERT_EQ(bench.now().faults, 1);
  order(NmtCommand::kResetNode);
  EXPECT_EQ(bench.now().faults, 0);
  EXPECT_EQ(bench.values().request.argument, 0);
  EXPECT_EQ(bench.values().velocity.forward_mm_per_s, 0);
}

TEST_F(ControllerNetwork, AResetOfTheNodeClearsTheInputsOfMotions) {
  ASSERT_TRUE(lead_to(State::kLimp));
  ASSERT_EQ(pc.write({kMotionInputObject, 1}, 123, 2), AbortCode::kNone);
  order(NmtCommand::kResetCommunication);
  EXPECT_EQ(bench.values().motion.inputs[0], 123);
  order(NmtCommand::kResetNode);
  EXPECT_EQ(bench.values().motion.inputs[0], 0);
}

// --- A second master

TEST_F(ControllerNetwork, ToleratesSingleFramesOfAnotherMaster) {
  ASSERT_TRUE(lead_to(State::kStanding));
  const hal::CanFrame sync{.identifier = kSync, .size = 0};
  // A frame in every third cycle, as somebody sends them by hand.
  for (int i = 0; i < 40; ++i) {
    bench.board.can.deliver(sync);
    bench.run_ms(30);
  }
  EXPECT_EQ(bench.now().state, State::kStanding);
  // In four cycles in a row, and then no more.
  for (int i = 0; i < 4; ++i) {
    bench.board.can.deliver(sync);
    bench.run_ms(10);
  }
  bench.run_ms(100);
  EXPECT_EQ(bench.now().state, State::kStanding);
}

TEST_F(ControllerNetwork, GivesWayToASecondMaster) {
  ASSERT_TRUE(lead_to(State::kStanding));
  int cycles = 0;
  for (; cycles < 10 && bench.now().state == State::kStanding; ++cycles) {
    bench.board.can.deliver({.identifier = kSync, .size = 0});
    bench.run_ms(10);
  }
  EXPECT_EQ(cycles, 5);
  EXPECT_EQ(bench.now().state, State::kFault);
  EXPECT_EQ(bench.now().reason, Reason::kSecondMaster);
}

// The boot after a second master listens for it again before it resets the drives.
TEST_F(ControllerNetwork, ListensAgainOnceItHasGivenWay) {
  for (const bool second_master : {false, true}) {
    SCOPED_TRACE(second_master);
    ASSERT_TRUE(lead_to(State::kStanding));
    if (!second_master) bench.command(Command::kEmergencyStop);
    for (int i = 0; i < 6 && second_master; ++i) {
      bench.board.can.deliver({.identifier = kSync, .size = 0});
      bench.run_ms(10);
    }
    bench.run_ms(500);
    // A last frame does not make the controller forget what it has heard.
    if (second_master) bench.board.can.deliver({.identifier = kSync, .size = 0});
    bench.run_ms(20);
    bench.sent.clear();
    bench.command(Command::kReset);
    EXPECT_EQ(bench.now().state, State::kBoot);
    bench.run_ms(20);
    EXPECT_EQ(orders().empty(), second_master);
    bench.run_ms(30);
    EXPECT_FALSE(orders().empty());
    ASSERT_TRUE(bench.run_until(State::kLimp));
  }
}

// The network belongs to the other one: a controller that hears it while it listens sends nothing until its
// next boot.
TEST_F(ControllerNetwork, IsSilentWhereItHearsASecondMasterBeforeItBegins) {
  bench.restart();
  bench.run_ms(10);
  bench.board.can.deliver({.identifier = kSync, .size = 0});
  bench.run_ms(20);
  EXPECT_EQ(bench.now().state, State::kFault);
  EXPECT_EQ(bench.now().reason, Reason::kSecondMaster);
  EXPECT_TRUE(orders().empty());
  bench.sent.clear();
  bench.run_ms(1'000);
  EXPECT_TRUE(bench.sent.empty());
  bench.command(Command::kReset);
  ASSERT_TRUE(bench.run_until(State::kLimp));
  EXPECT_GT(sent(kSync), 10);
}

// --- Object 0x1F80

TEST_F(ControllerNetwork, StartupObjectDescribesASelfStartingMaster) {
  EXPECT_EQ(pc.read(kNmtStartup), kNmtMaster);
  for (const std::int32_t value : {0, 2, 0x11, 0x21, 0x41, 0x101})
    EXPECT_EQ(pc.write(kNmtStartup, value, 4), AbortCode::kInvalidValue) << value;
  for (const std::int32_t value : {1, 3, 5, 9, 15}) {
    EXPECT_EQ(pc.write(kNmtStartup, value, 4), AbortCode::kNone) << value;
    EXPECT_EQ(pc.read(kNmtStartup), static_cast<std::uint32_t>(value));
  }
}

TEST_F(ControllerNetwork, WithoutSelfStartItWaitsForAnotherMaster) {
  ASSERT_TRUE(bench.run_until(State::kLimp));
  ASSERT_EQ(pc.write(kNmtStartup, kNmtMaster | kNoSelfStart, 4), AbortCode::kNone);
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  bench.board.storage.lose_power();
  bench.restart();
  bench.sent.clear();
  bench.run_ms(2'000);
  EXPECT_EQ(bench.now().state, State::kBoot);
  EXPECT_EQ(bench.last_sent(kHeartbeatOfController)->data[0],
            static_cast<std::uint8_t>(NmtState::kPreOperational));
  EXPECT_EQ(sent(kSync), 0);
  EXPECT_EQ(orders(), to_each_drive(NmtCommand::kResetNode));  // the drives are configured and wait as well
  EXPECT_EQ(bench.drives[19].object(0x6060, 0), 8u);
  bench.command(Command::kEnable);  // the drives receive no PDO
  EXPECT_EQ(bench.now().refusal, Reason::kNone);

  order(NmtCommand::kStart);
  ASSERT_TRUE(bench.run_until(State::kLimp, 50));
  EXPECT_TRUE(bench.run_until_standing());
  order(NmtCommand::kResetCommunication);
  bench.run_ms(2'000);
  EXPECT_EQ(bench.now().state, State::kBoot);
}

TEST_F(ControllerNetwork, StartupThatIsNotSavedIsForgottenAtAReset) {
  for (const NmtCommand reset : {NmtCommand::kResetNode, NmtCommand::kResetCommunication}) {
    ASSERT_TRUE(bench.run_until(State::kLimp));
    ASSERT_EQ(pc.write(kNmtStartup, kNmtMaster | kNoSelfStart, 4), AbortCode::kNone);
    order(reset);
    EXPECT_EQ(pc.read(kNmtStartup), kNmtMaster);
    EXPECT_TRUE(bench.run_until(State::kLimp, 700));
  }
}

TEST_F(ControllerNetwork, MayStartAllNodesByOneMessage) {
  ASSERT_EQ(pc.write(kNmtStartup, kNmtMaster | kStartsTogether, 4), AbortCode::kNone);
  ASSERT_TRUE(bench.run_until(State::kLimp));
  auto expected = to_each_drive(NmtCommand::kResetNode);
  expected.push_back(nmt(NmtCommand::kStart, kAll));
  EXPECT_EQ(orders(), expected);
}

TEST_F(ControllerNetwork, MayLeaveTheStartOfTheDrivesToAnotherMaster) {
  ASSERT_EQ(pc.write(kNmtStartup, kNmtMaster | kNoSlaveStart, 4), AbortCode::kNone);
  bench.run_ms(2'000);
  EXPECT_EQ(bench.now().state, State::kBoot);
  EXPECT_EQ(orders(), to_each_drive(NmtCommand::kResetNode));
  bench.tell_drives(nmt(NmtCommand::kStart, 16));
  bench.run_ms(100);
  EXPECT_EQ(bench.now().state, State::kBoot);  // those of the other drives
  bench.tell_drives(nmt(NmtCommand::kStart, kAll));
  ASSERT_TRUE(bench.run_until(State::kLimp, 50));
  EXPECT_TRUE(bench.run_until_standing());
}

// --- Another master stops the controller

TEST_F(ControllerNetwork, EntersAFaultWhenItLeavesOperationalInAnyState) {
  for (const NmtCommand command : {NmtCommand::kStop, NmtCommand::kEnterPreOperational}) {
    for (const State state : {State::kLimp, State::kStanding, State::kMotion, State::kWalking}) {
      SCOPED_TRACE(testing::Message() << "state " << int(state) << ", command " << int(command));
      bench.restart();
      ASSERT_TRUE(lead_to(state));
      order(command);
      ASSERT_TRUE(bench.run_until(State::kFault, 10));
      EXPECT_EQ(bench.now().reason, Reason::kNotOperational);
      EXPECT_EQ(bench.now().drive_fault, drive::DriveFault::kNone);
      bench.run_ms(310);
      EXPECT_FALSE(bench.board.drive_enable.enabled());

      order(NmtCommand::kStart);
      bench.run_ms(100);
      EXPECT_EQ(bench.now().state, State::kFault);  // an NMT start does not move the robot
      EXPECT_EQ(bench.last_sent(0x181)->data[0], static_cast<std::uint8_t>(State::kFault));
      bench.command(Command::kReset);
      ASSERT_TRUE(bench.run_until_standing());
    }
  }
}

TEST_F(ControllerNetwork, StaysInAnEmergencyStopForAnyCommandOfTheMaster) {
  ASSERT_TRUE(lead_to(State::kEmergencyStop));
  for (const NmtCommand command : {NmtCommand::kStop, NmtCommand::kEnterPreOperational, NmtCommand::kStart}) {
    order(command);
    bench.run_ms(100);
    EXPECT_EQ(bench.now().state, State::kEmergencyStop);
    EXPECT_FALSE(bench.board.drive_enable.enabled());
  }
  bench.command(Command::kReset);
  EXPECT_TRUE(bench.run_until_standing());
}

// A reset by SDO does not override the other master.
TEST_F(ControllerNetwork, BootsInPreOperationalAndWaitsForTheStart) {
  ASSERT_TRUE(lead_to(State::kLimp));
  order(NmtCommand::kEnterPreOperational);
  ASSERT_TRUE(bench.run_until(State::kFault, 10));
  ASSERT_EQ(pc.write({kRequestObject, 1}, static_cast<int>(Command::kReset), 1), AbortCode::kNone);
  bench.run_ms(2'000);
  EXPECT_EQ(bench.now().state, State::kBoot);
  order(NmtCommand::kStart);
  EXPECT_TRUE(bench.run_until(State::kLimp, 50));
}

TEST_F(ControllerNetwork, AnInterruptedBootIsAFault) {
  bench.run_ms(300);
  order(NmtCommand::kStop);
  EXPECT_TRUE(bench.run_until(State::kFault, 10));
  EXPECT_EQ(bench.now().reason, Reason::kNotOperational);
}

// --- Frames of foreign nodes

TEST_F(ControllerNetwork, AddressesItsOwnDrivesOnly) {
  ASSERT_TRUE(lead_to(State::kEmergencyStop));
  bench.sent.clear();
  bench.command(Command::kReset);
  ASSERT_TRUE(bench.run_until(State::kLimp));
  auto expected = to_each_drive(NmtCommand::kResetNode);
  std::ranges::copy(to_each_drive(NmtCommand::kStart), std::back_inserter(expected));
  EXPECT_EQ(orders(), expected);
}

TEST_F(ControllerNetwork, ResetsSensorsThatAreNodesAndStartsEachThatHasBooted) {
  static constexpr std::array<std::uint8_t, 2> kSensors{36, 37};
  bench.board.sensor_nodes = kSensors;
  bench.restart();
  bench.sent.clear();
  bench.run_ms(30);  // the controller listens for another master
  EXPECT_TRUE(orders().empty());
  bench.run_ms(10);
  EXPECT_THAT(orders(),
              testing::IsSupersetOf({nmt(NmtCommand::kResetNode, 36), nmt(NmtCommand::kResetNode, 37)}));
  bench.sent.clear();
  bench.board.can.deliver({.identifier = canopen::kHeartbeatBase + 37, .size = 1});
  bench.board.can.deliver({.identifier = canopen::kHeartbeatBase + 38, .size = 1});  // of a foreign node
  bench.run_ms(10);
  EXPECT_EQ(orders(), std::vector{nmt(NmtCommand::kStart, 37)});
}

// With room for only a few frames per millisecond, the commands to all nodes are still sent.
TEST_F(ControllerNetwork, BootsWithASmallTransmitFifo) {
  for (int i = 0; i < 2'000 && bench.now().state == State::kBoot; ++i) {
    bench.board.can.limit_transmit(6);
    bench.run_ms(1);
  }
  EXPECT_EQ(bench.now().state, State::kLimp);
}

}  // namespace
}  // namespace koboshi::app
