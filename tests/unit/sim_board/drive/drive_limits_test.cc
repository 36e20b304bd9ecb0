#include <algorithm>
#include <cmath>

#include "tests/unit/sim_board/drive/drive_bench.h"

// The limits beyond which a drive does not obey: 0x607D, 0x6080, 0x60C5 and 0x2001.
namespace koboshi::sim_board {
namespace {

constexpr double kRpm = (1 << 20) / 60.0;

// Here the shaft is where the drive asks it to be.
class LimitedDrive : public DriveTest {
 protected:
  bool limited() const { return (drive->values().statusword & cia402::kInternalLimit) != 0; }
  std::int32_t demand() const { return drive->values().position_demand; }
  // Units/s and units/s^2 of the demand, over 10 ms, in all that has been followed since `measure`.
  void measure() {
    position_ = demand();
    speed_ = fastest_ = steepest_ = 0.0;
  }
  double fastest() const { return fastest_; }
  double steepest() const { return steepest_; }

  void follow_ms(int duration_ms) {
    for (int i = 0; i < duration_ms; ++i) {
      run_ms(1);
      shaft.position_rad = demand() * kRadPerPositionUnit;
      if (now_us % kCycle_us != 5'000) continue;
      const double speed = 100.0 * (demand() - position_);
      fastest_ = std::max(fastest_, std::abs(speed));
      steepest_ = std::max(steepest_, 100.0 * std::abs(speed - speed_));
      position_ = demand();
      speed_ = speed;
    }
  }
  void write_limits(std::int32_t lowest, std::int32_t highest) {
    write({0x607D, 1}, static_cast<std::uint32_t>(lowest), 4);
    write({0x607D, 2}, static_cast<std::uint32_t>(highest), 4);
  }
  void use_profile(std::uint32_t velocity, std::uint32_t acceleration) {
    write({0x6081, 0}, velocity, 4);
    write({0x6083, 0}, acceleration, 4);
    write({0x6084, 0}, acceleration, 4);
  }
  void enable_profile() {
    enable();
    write({0x6060, 0}, cia402::kProfilePosition, 1);
    ASSERT_EQ(drive->values().mode_display, cia402::kProfilePosition);
  }
  void give(std::int32_t position) {
    controlword = cia402::kControlEnableOperation;
    follow_ms(12);
    target = position;
    controlword |= cia402::kNewSetPoint;
    follow_ms(12);
  }

 private:
  std::int32_t position_ = 0;
  double speed_ = 0.0;
  double fastest_ = 0.0;
  double steepest_ = 0.0;
};

// --- Software position limits

TEST_F(LimitedDrive, ShowsThatACyclicTargetIsBeyondThePositionLimits) {
  configure();
  write_limits(-500, 500);
  enable();
  for (const auto& [asked, expected] : {std::pair{500, false}, {501, true}, {-500, false}, {-900, true}}) {
    target = asked;
    follow_ms(30);
    EXPECT_EQ(limited(), expected) << asked;
    EXPECT_EQ(demand(), std::clamp(asked, -500, 500));
  }
  EXPECT_NEAR(drive->values().limited_ms, 60, 2);
  controlword = cia402::kControlDisableVoltage;
  follow_ms(12);
  EXPECT_FALSE(limited());
}

TEST_F(LimitedDrive, ShowsThatASetPointIsBeyondThePositionLimits) {
  configure();
  write_limits(-500, 500);
  enable_profile();
  give(900);
  EXPECT_TRUE(limited());
  follow_ms(500);
  EXPECT_EQ(demand(), 500);
  EXPECT_TRUE(limited());
  give(400);
  EXPECT_FALSE(limited());
}

TEST_F(LimitedDrive, HoldsItsPositionWhileTheLimitsContradictEachOther) {
  enable();
  target = 1'000;
  follow_ms(30);
  write({0x607D, 2}, static_cast<std::uint32_t>(-5'000), 4);
  EXPECT_EQ(abort_of({0x607D, 1}, static_cast<std::uint32_t>(-2'000), 4), 0u);
  target = 2'000;
  follow_ms(50);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  EXPECT_EQ(demand(), 1'000);
  EXPECT_TRUE(limited());
  write({0x607D, 2}, 5'000, 4);
  follow_ms(50);
  EXPECT_EQ(demand(), 2'000);
  EXPECT_FALSE(limited());
  EXPECT_TRUE(emergencies().empty());
}

// Every way into operation enabled.
struct WayToEnable {
  const char* name;
  State from;
  bool by_sdo;
};
class RefusesToEnable : public LimitedDrive, public testing::WithParamInterface<WayToEnable> {
 protected:
  void tell(std::uint16_t word) {
    controlword = word;
    if (GetParam().by_sdo) write({0x6040, 0}, word, 2);
    run_ms(30);
  }
  void lead_to_start() {
    tell(cia402::kControlShutdown);
    if (GetParam().from == State::kReadyToSwitchOn) return;
    tell(cia402::kControlSwitchOn);
    if (GetParam().from == State::kSwitchedOn) return;
    tell(cia402::kControlEnableOperation);
    tell(cia402::kControlQuickStop);
  }
  void withdraw() {
    tell(GetParam().from == State::kQuickStopActive ? cia402::kControlQuickStop
         : GetParam().from == State::kSwitchedOn    ? cia402::kControlSwitchOn
                                                    : cia402::kControlShutdown);
  }
};

TEST_P(RefusesToEnable, WhileTheLimitsAreContradictory) {
  configure();
  write({0x605A, 0}, 6, 2);  // quick stop active stays
  if (GetParam().by_sdo) write({0x1400, 1}, 0x8000'0000u + 0x200 + kNode, 4);
  lead_to_start();
  ASSERT_EQ(drive->state(), GetParam().from);
  write_limits(500, -500);
  for (const std::size_t attempt : {1u, 2u}) {
    tell(cia402::kControlEnableOperation);
    EXPECT_EQ(drive->state(), GetParam().from);
    EXPECT_EQ(drive->values().error_code, cia402::kErrorParameter);
    ASSERT_EQ(std::ranges::count(emergencies(), cia402::kErrorParameter), attempt);
    withdraw();
    EXPECT_EQ(emergencies().back(), 0);
    EXPECT_EQ(drive->state(), GetParam().from);
  }
  tell(cia402::kControlEnableOperation);
  ASSERT_EQ(emergencies().back(), cia402::kErrorParameter);
  write_limits(-500, 500);
  EXPECT_EQ(emergencies().back(), 0);
  EXPECT_EQ(drive->values().error_code, 0);
  tell(cia402::kControlEnableOperation);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
}

INSTANTIATE_TEST_SUITE_P(Drive, RefusesToEnable,
                         testing::Values(WayToEnable{"SwitchedOn", State::kSwitchedOn, false},
                                         WayToEnable{"SwitchedOnBySdo", State::kSwitchedOn, true},
                                         WayToEnable{"Ready", State::kReadyToSwitchOn, false},
                                         WayToEnable{"ReadyBySdo", State::kReadyToSwitchOn, true},
                                         WayToEnable{"QuickStop", State::kQuickStopActive, false},
                                         WayToEnable{"QuickStopBySdo", State::kQuickStopActive, true}),
                         [](const auto& info) { return info.param.name; });

// --- Speed, acceleration and steps

TEST_F(LimitedDrive, ApproachesAJumpOfTheTargetByItsProfile) {
  use_profile(100 * kDegree, 500 * kDegree);
  enable();
  measure();
  target = 68 * kDegree;
  follow_ms(500);
  EXPECT_TRUE(limited());
  EXPECT_LT(demand(), 60 * kDegree);
  follow_ms(500);
  EXPECT_EQ(demand(), target);
  EXPECT_FALSE(limited());
  EXPECT_NEAR(fastest(), 100 * kDegree, kDegree);
  EXPECT_NEAR(steepest(), 500 * kDegree, 20 * kDegree);
  // 0.2 s up, 0.2 s down, the rest at 100 degrees/s.
  EXPECT_NEAR(drive->values().limited_ms, 880, 12);
}

TEST_F(LimitedDrive, StartsFromItsShaftAndNotFromAnOldTarget) {
  use_profile(100 * kDegree, 500 * kDegree);
  shaft.position_rad = 79 * kDegree * kRadPerPositionUnit;
  run_ms(10);
  enable();
  EXPECT_NEAR(demand(), 79 * kDegree, kDegree);
  measure();
  follow_ms(1'200);
  EXPECT_EQ(demand(), 0);
  EXPECT_LT(steepest(), 600 * kDegree);  // the first of the spans is longer than a cycle
}

TEST_F(LimitedDrive, KeepsItsMaxMotorSpeedInTheCyclicMode) {
  write({0x6080, 0}, 10, 4);
  enable();
  measure();
  for (int i = 0; i < 50; ++i) {
    target += 1'800;  // 10.3 r/min
    follow_ms(10);
  }
  EXPECT_TRUE(limited());
  EXPECT_NEAR(fastest(), 10 * kRpm, 100.0);
  follow_ms(50);
  EXPECT_EQ(demand(), target);
}

TEST_F(LimitedDrive, KeepsItsMaxAccelerationInTheCyclicModeWithoutOvershoot) {
  write({0x60C5, 0}, 300'000, 4);
  enable();
  measure();
  std::int32_t furthest = 0;
  target = 4 * kDegree;
  for (int i = 0; i < 60; ++i) {
    follow_ms(10);
    furthest = std::max(furthest, demand());
  }
  EXPECT_EQ(furthest, target);
  EXPECT_EQ(demand(), target);
  EXPECT_NEAR(steepest(), 300'000, 20'000);
  EXPECT_FALSE(limited());
}

TEST_F(LimitedDrive, KeepsItsLimitsInProfilePositionMode) {
  use_profile(200'000, 2'000'000);
  enable_profile();
  give(-20'000);
  EXPECT_FALSE(limited());
  follow_ms(500);
  write({0x6080, 0}, 5, 4);
  write({0x60C5, 0}, 400'000, 4);
  measure();
  give(20'000);
  EXPECT_TRUE(limited());
  follow_ms(1'000);
  EXPECT_EQ(demand(), 20'000);
  EXPECT_FALSE(limited());
  EXPECT_NEAR(fastest(), 5 * kRpm, 100.0);
  EXPECT_NEAR(steepest(), 400'000, 20'000);
}

}  // namespace
}  // namespace koboshi::sim_board
