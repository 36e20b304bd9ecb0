#include <algorithm>
#include <array>

#include "tests/unit/sim_board/drive/drive_bench.h"

// A drive keeps its parameters (CiA 301, 0x1010 and 0x1011) and its node id (CiA 305) without power.
namespace koboshi::sim_board {
namespace {

constexpr std::uint32_t kSave = 0x6576'6173;
constexpr std::uint32_t kLoad = 0x6461'6F6C;
constexpr int kStoring_ms = 200;

class StoringDriveTest : public DriveTest {
 protected:
  void cycle_power() {
    drive->power_off();
    run_ms(5);
    heard.clear();
    drive->power_on(now_us);
    run_ms(60);
  }
  void save() {
    write({0x1010, 1}, kSave, 4);
    run_ms(kStoring_ms);
  }
  void lss(const std::array<std::uint8_t, 8>& data) {
    heard.clear();
    say({.identifier = 0x7E5, .size = 8, .data = data});
    run_ms(2);
  }
  bool heard_of(std::uint16_t identifier) const {
    return std::ranges::any_of(heard,
                               [=](const hal::CanFrame& frame) { return frame.identifier == identifier; });
  }
};

TEST_F(StoringDriveTest, KeepsParametersAcrossAPowerCycle) {
  write({0x605A, 0}, 6, 2);
  write({0x607D, 1}, 0xFFFF'FF00, 4);
  write({0x6081, 0}, 77'777, 4);
  write({0x1017, 0}, 250, 2);
  save();
  cycle_power();
  EXPECT_EQ(drive->values().quick_stop_option, 6);
  EXPECT_EQ(drive->values().position_limit[0], -256);
  EXPECT_EQ(drive->values().profile_velocity, 77'777u);
  run_ms(600);
  EXPECT_EQ(std::ranges::count(heard, 0x700 + kNode, &hal::CanFrame::identifier), 1 + 2);
}

TEST_F(StoringDriveTest, AnswersASaveOnceComplete) {
  heard.clear();
  write({0x1010, 1}, kSave, 4);
  EXPECT_FALSE(heard_of(0x580 + kNode));
  run_ms(kStoring_ms);
  ASSERT_TRUE(heard_of(0x580 + kNode));
  EXPECT_EQ(heard.back().data[0], 0x60);
}

TEST_F(StoringDriveTest, RestoresDefaultsAtTheNextReset) {
  const std::uint32_t factory = drive->values().profile_velocity;
  write({0x6081, 0}, 77'777, 4);
  save();
  write({0x1011, 1}, kLoad, 4);
  run_ms(kStoring_ms);
  EXPECT_EQ(drive->values().profile_velocity, 77'777u);
  say({.identifier = 0x000, .size = 2, .data = {0x81, kNode}});
  run_ms(5);
  EXPECT_EQ(drive->values().profile_velocity, factory);
}

TEST_F(StoringDriveTest, KeepsTheOldValuesAtAPowerFailure) {
  write({0x6081, 0}, 77'777, 4);
  save();
  for (const int cut_ms : {1, 10, 25, 30, 35}) {
    write({0x6081, 0}, 88'888, 4);
    write({0x1010, 1}, kSave, 4);
    run_ms(cut_ms);
    cycle_power();
    EXPECT_EQ(drive->values().profile_velocity, 77'777u) << cut_ms;
  }
}

TEST_F(StoringDriveTest, SendsAHeartbeatEachSecondAfterAReset) {
  heard.clear();
  run_ms(3'000);
  EXPECT_EQ(std::ranges::count(heard, 0x700 + kNode, &hal::CanFrame::identifier), 3);
}

TEST_F(StoringDriveTest, ReportsTheTimeOfDay) {
  EXPECT_EQ(drive->values().time_days, 0);
  // 12:34:56.789 on 2 January 1984.
  say({.identifier = 0x100, .size = 6, .data = {0x95, 0x2C, 0xB3, 0x02, 0x01, 0x00}});
  run_ms(102);
  EXPECT_EQ(drive->values().time_days, 1);
  EXPECT_NEAR(drive->values().time_ms, 45'296'789 + 101, 1);
}

TEST_F(StoringDriveTest, KeepsANodeIdStoredByLss) {
  lss({0x04, 1});
  lss({0x11, 40});
  lss({0x17});
  EXPECT_FALSE(heard_of(0x7E4));
  run_ms(kStoring_ms);
  EXPECT_TRUE(heard_of(0x7E4));
  lss({0x04, 0});
  EXPECT_FALSE(heard_of(0x728));
  cycle_power();
  EXPECT_TRUE(heard_of(0x728));
  EXPECT_FALSE(heard_of(0x700 + kNode));
}

TEST_F(StoringDriveTest, KeepsItsNodeIdAcrossARestore) {
  lss({0x04, 1});
  lss({0x11, 40});
  lss({0x17});
  run_ms(kStoring_ms);
  write({0x1011, 1}, kLoad, 4);
  run_ms(kStoring_ms);
  cycle_power();
  EXPECT_TRUE(heard_of(0x728));
}

TEST_F(StoringDriveTest, DiscardsANodeIdThatWasNotStored) {
  lss({0x04, 1});
  lss({0x11, 40});
  lss({0x04, 0});
  cycle_power();
  EXPECT_TRUE(heard_of(0x700 + kNode));
}

TEST_F(StoringDriveTest, WaitsInLssWithoutANodeId) {
  lss({0x04, 1});
  lss({0x11, 0xFF});
  lss({0x17});
  run_ms(kStoring_ms);
  cycle_power();
  run_ms(1'100);
  EXPECT_TRUE(heard.empty());
  lss({0x4C});
  ASSERT_TRUE(heard_of(0x7E4));
  EXPECT_EQ(heard.back().data[0], 0x50);
  lss({0x04, 1});
  lss({0x11, 21});
  lss({0x04, 0});
  EXPECT_TRUE(heard_of(0x715));
}

}  // namespace
}  // namespace koboshi::sim_board
