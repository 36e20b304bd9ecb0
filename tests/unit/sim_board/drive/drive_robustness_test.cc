#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim_board/drive/drive_dictionary.h"
#include "tests/support/allocations.h"
#include "tests/support/random_frames.h"
#include "tests/unit/sim_board/drive/drive_bench.h"

namespace koboshi::sim_board {
namespace {

using test::Random;

constexpr double kStop_rad = 2.6;  // where the shaft of a servo of this kind meets its case

// Half of the frames lead the drive through its states; the others are noise, SDO, and either with an error.
class RandomFrames {
 public:
  RandomFrames(std::uint8_t node, std::uint64_t seed) : node_(node), random_(seed) {}

  hal::CanFrame next() {
    switch (random_.below(8)) {
      case 0:
        return test::noise_frame(random_);
      case 1:
        return test::mutated(proper(), random_);
      case 2:
        return test::mutated(sdo(), random_);
      case 3:
        return sdo();
      default:
        return proper();
    }
  }
  Random& random() { return random_; }

 private:
  hal::CanFrame sdo() {
    // Both channels: the controller's and the PC's.
    const std::uint16_t base =
        random_.below(3) == 0 ? kPcSdoRanges[0].request_base : canopen::kSdoRequestBase;
    return test::sdo_request(identifier(base), description_.rows, random_);
  }
  hal::CanFrame proper() {
    static constexpr std::uint16_t kWords[] = {cia402::kControlShutdown,
                                               cia402::kControlSwitchOn,
                                               cia402::kControlEnableOperation,
                                               cia402::kControlEnableOperation,
                                               cia402::kControlEnableOperation | 0x10,  // a new set-point
                                               cia402::kControlQuickStop,
                                               cia402::kControlDisableVoltage,
                                               cia402::kFaultReset};
    hal::CanFrame frame{.identifier = identifier(canopen::kRpdo1Base), .size = 2};
    canopen::store_u16(&frame.data[0], random_.one_of(kWords));
    canopen::store_u32(&frame.data[2], random_.next());
    switch (random_.below(16)) {
      case 0: {
        static constexpr canopen::NmtCommand kOthers[] = {
            canopen::NmtCommand::kStop, canopen::NmtCommand::kEnterPreOperational,
            canopen::NmtCommand::kResetNode, canopen::NmtCommand::kResetCommunication};
        const bool other = random_.below(64) == 0;
        return canopen::encode(
            canopen::NmtMessage{other ? random_.one_of(kOthers) : canopen::NmtCommand::kStart, node_});
      }
      case 1:
        return canopen::encode(canopen::Heartbeat{1, canopen::NmtState::kOperational});
      case 2:
      case 3:
      case 4:
        return {.identifier = canopen::kSyncCobId};
      case 5:
        return write({cia402::kModeOfOperation, 0}, random_.below(2) == 0 ? 1 : 8, 1);
      case 6:
      case 7:
        return write({cia402::kTargetPosition, 0}, random_.next(), 4);
      case 8:
        frame.size = 6;
        return frame;
      default:
        return frame;
    }
  }
  hal::CanFrame write(ObjectAddress address, std::uint32_t value, std::size_t size) {
    return {.identifier = identifier(canopen::kSdoRequestBase),
            .size = 8,
            .data = canopen::sdo::message(
                canopen::sdo::expedited(canopen::sdo::kInitiateDownloadRequest, size), address, value)};
  }
  std::uint16_t identifier(std::uint16_t base) const { return static_cast<std::uint16_t>(base + node_); }

  std::uint8_t node_;
  Random random_;
  canopen::NodeDescription description_ = drive_node_description({.node_id = node_});
};

// A servo with everything that a servo can have.
JointDescription complete_joint() {
  JointDescription joint;
  joint.name = "knee";
  joint.servo.current_limit_A = 1.2;
  joint.servo.winding = {.thermal_resistance_K_per_W = 10.0, .heat_capacity_J_per_K = 5.0};
  joint.servo.voltmeter = {.noise = 0.02, .highest = 12.0, .resolution = 0.1};
  joint.servo.thermometer = {.noise = 0.5, .highest = 125.0, .resolution = 1.0};
  joint.encoder.noise_counts = 0.5;
  return joint;
}

// Who says all this; it listens to nothing.
class Fuzzer final : public BusNode {
  void on_frame(const hal::CanFrame&, std::uint64_t) override {}
};

class DriveRobustness : public DriveTest {
 protected:
  DriveRobustness() : DriveTest(complete_joint()), handle_(bus.attach(fuzzer_, AcceptanceFilter(), 8)) {
    heard.reserve(64);
  }

  // As much as the bus takes.
  void say_more(RandomFrames& frames) {
    if (bus.status(handle_).state == hal::CanErrorState::kBusOff) bus.recover(handle_);
    while (bus.transmit_space(handle_, hal::kProcessFifo) > 0)
      static_cast<void>(bus.queue(handle_, frames.next(), now_us));
    heard.clear();
  }
  std::uint64_t sent() const { return bus.counters(handle_).sent; }

  // A free shaft between two stops: what the servo does to it in a millisecond. The motor's damping and the
  // dry friction are taken implicitly, as in the physics, so that they only ever slow it down.
  void move_shaft() {
    constexpr double kStep_s = 0.001;
    const double inertia = torque.rotor_inertia_kg_m2 + kStep_s * torque.damping_Nm_s;
    double momentum = torque.rotor_inertia_kg_m2 * shaft.speed_rad_per_s + kStep_s * torque.drive_Nm;
    const double friction = kStep_s * torque.friction_Nm;
    momentum = std::copysign(std::max(std::abs(momentum) - friction, 0.0), momentum);
    shaft.speed_rad_per_s = momentum / inertia;
    shaft.position_rad += kStep_s * shaft.speed_rad_per_s;
    if (std::abs(shaft.position_rad) < kStop_rad) return;
    shaft.position_rad = std::copysign(kStop_rad, shaft.position_rad);
    shaft.speed_rad_per_s = 0.0;
  }
  bool may_move() const {
    return line && (drive->state() == State::kOperationEnabled || drive->state() == State::kQuickStopActive ||
                    drive->state() == State::kFaultReactionActive);
  }

  bool line = true;

 private:
  Fuzzer fuzzer_;
  NodeHandle handle_;
};

// Whatever is on the bus: no crash, nothing from the heap, and a shaft that is not enabled never speeds up.
TEST_F(DriveRobustness, SurvivesRandomFrames) {
  const std::uint64_t frames = test::frames_to_survive();
  constexpr std::uint64_t kSeed = 20081128;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  RandomFrames random_frames(kNode, kSeed);
  Random& random = random_frames.random();
  std::array<std::uint64_t, 8> visits{};  // milliseconds in each state
  std::uint64_t moved_ms = 0;
  say_more(random_frames);
  run_ms(1);  // the first advance builds the table of receivers
  const long before = test::allocations();
  while (sent() < frames) {
    if (random.below(1'000) == 0) drive->set_enable_line(line = random.below(4) != 0);
    say_more(random_frames);
    run_ms(1);
    const double speed = std::abs(shaft.speed_rad_per_s);
    move_shaft();
    ++visits[static_cast<std::size_t>(drive->state())];
    if (std::abs(shaft.speed_rad_per_s) > speed) ++moved_ms;
    if (may_move()) continue;
    ASSERT_EQ(torque.drive_Nm, 0.0) << "at " << now_us << " us";
    ASSERT_FALSE(is_driven()) << "at " << now_us << " us";
    ASSERT_LE(std::abs(shaft.speed_rad_per_s), speed) << "at " << now_us << " us";
  }
  EXPECT_EQ(test::allocations(), before);
  // It was everywhere, and it moved.
  for (const State state :
       {State::kSwitchOnDisabled, State::kReadyToSwitchOn, State::kSwitchedOn, State::kOperationEnabled,
        State::kQuickStopActive, State::kFaultReactionActive, State::kFault})
    EXPECT_GT(visits[static_cast<std::size_t>(state)], 0u) << static_cast<int>(state);
  EXPECT_GT(moved_ms, frames / 1'000);
}

}  // namespace
}  // namespace koboshi::sim_board
