#include <array>
#include <cstdlib>

#include "tests/support/random_frames.h"
#include "tests/unit/sim_board/drive/turning_drive.h"

// Nothing but a target that has been given since moves a shaft after a reset, an enabling, a change of the
// mode, homing, a stop or a fault.
namespace koboshi::sim_board {
namespace {

constexpr std::int32_t kShaftPlace = 200'192;  // 69 degrees
constexpr std::int32_t kStillness = 512;       // two counts of the encoder

class StaleTarget : public TurningDrive {
 protected:
  StaleTarget() { place(kShaftPlace); }

  // Controlword alone, and SYNC: the master gives no target.
  void cycle(int count) {
    for (int i = 0; i < count; ++i) {
      say({.identifier = 0x080});
      turn_ms(10);
    }
  }
  void tell(std::uint16_t word) { write({0x6040, 0}, word, 2); }
  void start() { say({.identifier = 0x000, .size = 2, .data = {1, kNode}}); }
  void enable_without_target() {
    for (const std::uint16_t word : kWayToOperation) tell(word);
    ASSERT_EQ(drive->state(), State::kOperationEnabled);
  }
  void use_mode(std::int8_t mode) { write({0x6060, 0}, static_cast<std::uint8_t>(mode), 1); }
  void give(std::int32_t position) { write({0x607A, 0}, static_cast<std::uint32_t>(position), 4); }
};

TEST_F(StaleTarget, IsForgottenByAResetOfTheNode) {
  for (const bool given : {false, true}) {
    start();
    if (given) give(-50'000);
    reset_node();
    EXPECT_NEAR(drive->values().target_position, kShaftPlace, kStillness);
    start();
    use_mode(cia402::kCyclicSynchronousPosition);
    enable_without_target();
    cycle(50);
    EXPECT_NEAR(position(), kShaftPlace, kStillness);
    EXPECT_NEAR(drive->values().target_position, kShaftPlace, kStillness);
    EXPECT_EQ(drive->values().statusword & cia402::kInternalLimit, 0);
  }
}

TEST_F(StaleTarget, IsForgottenByAnEnabling) {
  start();
  use_mode(cia402::kCyclicSynchronousPosition);
  give(-50'000);
  enable_without_target();
  cycle(50);
  EXPECT_NEAR(position(), kShaftPlace, kStillness);
  give(kShaftPlace + 20'000);
  cycle(50);
  EXPECT_NEAR(position(), kShaftPlace + 20'000, 4'000);
}

// A controlword and the target beside it, in one PDO.
TEST_F(StaleTarget, IsNoneThatComesWithTheEnabling) {
  configure();
  target = kShaftPlace + 20'000;
  for (const std::uint16_t word : kWayToOperation) {
    controlword = word;
    turn_ms(12);
  }
  turn_ms(500);
  EXPECT_NEAR(position(), kShaftPlace + 20'000, 4'000);
}

TEST_F(StaleTarget, IsForgottenByHoming) {
  start();
  use_mode(cia402::kCyclicSynchronousPosition);
  enable_without_target();
  give(kShaftPlace);
  cycle(20);
  use_mode(cia402::kHoming);
  cycle(2);
  tell(cia402::kControlEnableOperation | cia402::kStartHoming);
  cycle(2);
  ASSERT_EQ(drive->values().position_actual, 0);
  tell(cia402::kControlEnableOperation);
  use_mode(cia402::kCyclicSynchronousPosition);
  cycle(50);
  ASSERT_EQ(drive->values().mode_display, cia402::kCyclicSynchronousPosition);
  EXPECT_NEAR(position(), kShaftPlace, kStillness);
}

TEST_F(StaleTarget, IsForgottenByAChangeOfTheMode) {
  start();
  use_mode(cia402::kProfilePosition);
  enable_without_target();
  give(-50'000);  // no set-point
  cycle(5);
  use_mode(cia402::kCyclicSynchronousPosition);
  cycle(50);
  EXPECT_NEAR(position(), kShaftPlace, kStillness);
}

TEST_F(StaleTarget, GivesNoSetPoint) {
  for (const std::uint16_t bits : std::to_array<std::uint16_t>({0, cia402::kRelative})) {
    reset_node();
    start();
    use_mode(cia402::kProfilePosition);
    enable_without_target();
    tell(cia402::kControlEnableOperation | cia402::kNewSetPoint | bits);
    EXPECT_NE(drive->values().statusword & cia402::kSetPointAcknowledge, 0);
    cycle(50);
    EXPECT_NEAR(position(), kShaftPlace, kStillness);
    tell(cia402::kControlEnableOperation);
    EXPECT_EQ(drive->values().statusword & cia402::kSetPointAcknowledge, 0);
  }
}

TEST_F(StaleTarget, MayBeUsedByRelativeSetPointsAgain) {
  start();
  use_mode(cia402::kProfilePosition);
  enable_without_target();
  give(10'000);
  for (int i = 1; i <= 3; ++i) {
    tell(cia402::kControlEnableOperation | cia402::kNewSetPoint | cia402::kRelative);
    turn_ms(1'000);
    EXPECT_NEAR(position(), kShaftPlace + 10'000 * i, 4'000);
    tell(cia402::kControlEnableOperation);
  }
}

// Any sequence of what may be between two motions, by SDO and NMT, with SYNC, and never a target.
TEST_F(StaleTarget, MovesNothingInAnySequence) {
  test::Random random(20261126);
  for (int trial = 0; trial < 20; ++trial) {
    place(kShaftPlace - 20'000 * trial);
    const std::int32_t start_position = position();
    start();
    for (int step = 0; step < 100; ++step) {
      static constexpr std::int8_t kModes[] = {0, 1, 3, 4, 6, 7, 8, 9, 10};
      static constexpr std::uint16_t kWords[] = {0x00, 0x02, 0x06, 0x07, 0x0F, 0x0F, 0x0F,
                                                 0x1F, 0x3F, 0x5F, 0x7F, 0x80, 0x10F};
      switch (random.below(12)) {
        case 0:
        case 1:
          use_mode(random.one_of(kModes));
          break;
        case 2:
          say({.identifier = 0x000, .size = 2, .data = {0x81, kNode}});
          turn_ms(10);
          start();
          break;
        case 3:
          say({.identifier = 0x000, .size = 2, .data = {0x82, kNode}});
          turn_ms(10);
          start();
          break;
        case 4:
          write({0x605A, 0}, 1 + random.below(8), 2);
          break;
        case 5:
          write({0x6007, 0}, random.below(4), 2);
          break;
        case 6:
          write({0x607C, 0}, random.next() >> 8, 4);
          break;
        case 7:  // a heartbeat, which is lost soon
          write({0x1016, 1}, random.below(2) == 0 ? 0x0001'003C : 0, 4);
          say({.identifier = 0x701, .size = 1, .data = {5}});
          break;
        case 8:
          drive->set_enable_line(random.below(4) != 0);
          break;
        default:
          tell(random.one_of(kWords));
          break;
      }
      cycle(static_cast<int>(random.below(12)));
      ASSERT_NEAR(position(), start_position, 4 * kStillness) << "trial " << trial << ", step " << step;
    }
    drive->set_enable_line(true);
    reset_node();
  }
}

}  // namespace
}  // namespace koboshi::sim_board
