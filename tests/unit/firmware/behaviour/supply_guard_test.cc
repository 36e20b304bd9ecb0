#include "firmware/behaviour/supply_guard.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "firmware/fixed/host/convert.h"
#include "tests/unit/firmware/fixed/digest.h"

namespace koboshi::behaviour {
namespace {

constexpr std::uint16_t kLow_mV = 6'300;
constexpr std::uint16_t kAbove_mV = 6'496;  // 6300 + 6300 / 32

class SupplyGuardTest : public testing::Test {
 protected:
  // Takes this reading `count` times.
  void read(std::uint32_t reading_mV, int count = 1, const std::vector<std::int16_t>& torques = {}) {
    const std::vector<robot::Joint> joints(torques.size());
    const std::vector<fixed::Angle> angles(torques.size());
    for (int i = 0; i < count; ++i) guard_.update(parameters_, reading_mV, {joints, torques, angles, angles});
  }

  PowerParameters parameters_{.supply_low_mV = kLow_mV, .stalled_drive_sag_mV = 82};
  SupplyGuard guard_;
};

TEST_F(SupplyGuardTest, ShowsNothingBeforeTheFirstReading) {
  EXPECT_EQ(guard_.open_circuit_mV(), 0);
  EXPECT_FALSE(guard_.low());
}

TEST_F(SupplyGuardTest, AddsTheSagOfStalledDrives) {
  read(7'000, 1, {1'000, -1'000, 0});
  EXPECT_EQ(guard_.load_sag_mV(), 164);
  EXPECT_EQ(guard_.open_circuit_mV(), 7'164);
  // A quarter of the current at half the torque, by the bridge.
  read(7'000, 1, {500, -500, 500, 500});
  EXPECT_EQ(guard_.load_sag_mV(), 82);
}

// Solves the circuit with doubles: a battery, its resistance, and motors that turn behind bridges without
// losses, some of them in drives that turn the other way than their joints.
TEST_F(SupplyGuardTest, FindsTheOpenCircuitVoltageOfACircuit) {
  constexpr double kResistance_ohm = 0.06;
  constexpr double kRated_V = 7.5;
  constexpr double kMotor_ohm = 5.477;
  constexpr double kConstant_V_s = 1.0027;
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  constexpr double kNoLoad_rad_per_s = kRated_V / kConstant_V_s;
  parameters_.no_load_speed = static_cast<std::int16_t>(std::lround(4096.0 * kNoLoad_rad_per_s / kTurn_rad));
  std::mt19937 random(7);
  std::uniform_int_distribution<int> torque_permille(-600, 600);
  std::uniform_real_distribution<double> speed_rad_per_s(-5.0, 5.0);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    const double open_circuit_V = 6.0 + 0.01 * trial;
    std::array<robot::Joint, 20> joints;
    std::array<std::int16_t, 20> torques{};
    std::array<fixed::Angle, 20> angles{};
    std::array<fixed::Angle, 20> last_angles{};
    double power_W = 0.0;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const double speed = speed_rad_per_s(random);  // of the shaft
      torques[i] = static_cast<std::int16_t>(torque_permille(random));
      joints[i].drive.sign = i % 3 == 0 ? -1 : 1;
      last_angles[i] = fixed::from_double<fixed::Angle>(speed_rad_per_s(random) / 2.0);
      angles[i] = last_angles[i] + fixed::from_double<fixed::Angle>(joints[i].drive.sign * 0.01 * speed);
      const double current_A = 1e-3 * torques[i] * kRated_V / kMotor_ohm;
      power_W += current_A * (current_A * kMotor_ohm + kConstant_V_s * speed);
    }
    // V = V_oc - R P / V
    const double supply_V =
        0.5 * (open_circuit_V + std::sqrt(open_circuit_V * open_circuit_V - 4.0 * kResistance_ohm * power_W));
    guard_.update(parameters_, static_cast<std::uint32_t>(std::lround(1e3 * supply_V)),
                  {joints, torques, angles, last_angles});
    // What is left out is the share by which the supply differs from the rated voltage.
    const double sag_mV = 1e3 * (open_circuit_V - supply_V);
    EXPECT_NEAR(guard_.open_circuit_mV(), 1e3 * open_circuit_V,
                2.0 + std::abs(sag_mV * (kRated_V / supply_V - 1.0)));
    // The parameter is rounded by 0.2 %, a constant of the estimate by 0.16 %, and the sag down to a
    // millivolt.
    EXPECT_NEAR(guard_.load_sag_mV(), sag_mV * supply_V / kRated_V, 1.0 + 0.004 * std::abs(sag_mV));
  }
}

TEST_F(SupplyGuardTest, SubtractsWhatBrakingMotorsGiveBack) {
  parameters_.no_load_speed = 4096;  // one turn per second
  const std::array<robot::Joint, 1> joints{};
  const std::array<std::int16_t, 1> torques{-500};
  const std::array<fixed::Angle, 1> last_angles{};
  const std::array<fixed::Angle, 1> angles{fixed::from_double<fixed::Angle>(0.02 * std::numbers::pi)};
  // t (t + w / w_0) = -0.5 (-0.5 + 1)
  guard_.update(parameters_, 7'000, {joints, torques, angles, last_angles});
  EXPECT_NEAR(guard_.load_sag_mV(), -20.5, 1.0);
  EXPECT_EQ(guard_.open_circuit_mV(), 7'000 + guard_.load_sag_mV());
}

TEST_F(SupplyGuardTest, SaturatesInsteadOfWrapping) {
  parameters_.stalled_drive_sag_mV = 0xFFFF;
  read(0xFFFF'FFFF, 1, std::vector<std::int16_t>(31, std::int16_t{-32'768}));
  EXPECT_EQ(guard_.load_sag_mV(), 0x7FFF);
  EXPECT_EQ(guard_.open_circuit_mV(), 0xFFFF);
  // The fastest motors against the strongest torque.
  parameters_.no_load_speed = 1;
  const std::vector<robot::Joint> joints(31);
  const std::vector<std::int16_t> torques(31, std::int16_t{32'767});
  const std::vector<fixed::Angle> angles(31,
                                         fixed::Angle::from_raw(std::numeric_limits<std::int32_t>::min()));
  const std::vector<fixed::Angle> last_angles(31);
  guard_.update(parameters_, 0, {joints, torques, angles, last_angles});
  EXPECT_EQ(guard_.open_circuit_mV(), guard_.load_sag_mV() < 0 ? 0 : guard_.load_sag_mV());
}

// The last bit of the sag, over loads of all kinds: the circuit's bounds leave it free.
TEST_F(SupplyGuardTest, HasTheSameBitsEverywhere) {
  test::Digest digest;
  std::mt19937 random(43);
  std::array<robot::Joint, 20> joints;
  std::array<std::int16_t, 20> torques{};
  std::array<fixed::Angle, 20> angles{};
  std::array<fixed::Angle, 20> last_angles{};
  for (int trial = 0; trial < 500; ++trial) {
    parameters_.no_load_speed = static_cast<std::int16_t>(trial % 5 == 0 ? 0 : 1 + random() % 9'000);
    parameters_.stalled_drive_sag_mV = static_cast<std::uint16_t>(random() % 400);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      joints[i].drive.sign = random() % 2 == 0 ? 1 : -1;
      torques[i] = static_cast<std::int16_t>(static_cast<int>(random() % 2'001) - 1'000);
      last_angles[i] = angles[i];
      angles[i] =
          angles[i] + fixed::Angle::from_raw(static_cast<std::int32_t>(random() % (1 << 26)) - (1 << 25));
    }
    guard_.update(parameters_, static_cast<std::uint32_t>(5'500 + random() % 1'500),
                  {joints, torques, angles, last_angles});
    digest.add(guard_.load_sag_mV());
    digest.add(guard_.open_circuit_mV());
    digest.add(guard_.low());
  }
  EXPECT_EQ(digest.value(), 0xCC03'08AE'B857'8379u);
}

TEST_F(SupplyGuardTest, IsLowAfterTwoSecondsBelowTheLimit) {
  static_assert(SupplyGuard::kReadings == 8);
  read(kLow_mV - 1, SupplyGuard::kReadings - 1);
  EXPECT_FALSE(guard_.low());
  read(kLow_mV - 1);
  EXPECT_TRUE(guard_.low());
}

TEST_F(SupplyGuardTest, DoesNotCountASagThatTheLoadExplains) {
  const std::vector<std::int16_t> six_stall(6, std::int16_t{1'000});
  read(kLow_mV - 400, 100, six_stall);  // 492 mV by the load
  EXPECT_FALSE(guard_.low());
  read(kLow_mV - 500, SupplyGuard::kReadings, six_stall);
  EXPECT_TRUE(guard_.low());
}

TEST_F(SupplyGuardTest, JudgesTheVoltageUnderLoadWithoutTheParameter) {
  parameters_.stalled_drive_sag_mV = 0;
  read(kLow_mV - 400, SupplyGuard::kReadings, std::vector<std::int16_t>(6, std::int16_t{1'000}));
  EXPECT_TRUE(guard_.low());
  EXPECT_EQ(guard_.open_circuit_mV(), kLow_mV - 400);
}

TEST_F(SupplyGuardTest, StartsAnewWithAReadingAboveTheHysteresis) {
  read(kLow_mV - 300, SupplyGuard::kReadings - 1);
  read(kAbove_mV);
  read(kLow_mV - 300, SupplyGuard::kReadings - 1);
  EXPECT_FALSE(guard_.low());
}

TEST_F(SupplyGuardTest, BalancesReadingsAroundTheLimit) {
  // As often within the hysteresis as below the limit: not low, however long.
  for (int i = 0; i < 100; ++i) {
    read(kLow_mV - 1);
    read(kAbove_mV - 1);
  }
  EXPECT_FALSE(guard_.low());
  // Three of four readings below: each four count two.
  for (int i = 0; i < 4; ++i) {
    read(kLow_mV - 1, 3);
    read(kAbove_mV - 1);
  }
  EXPECT_TRUE(guard_.low());
}

TEST_F(SupplyGuardTest, StaysLowUntilTwoSecondsAboveTheHysteresis) {
  read(kLow_mV - 1, SupplyGuard::kReadings);
  read(kAbove_mV - 1, 100);
  EXPECT_TRUE(guard_.low());
  read(kAbove_mV, SupplyGuard::kReadings - 1);
  read(kAbove_mV - 1);
  read(kAbove_mV, SupplyGuard::kReadings - 1);
  EXPECT_TRUE(guard_.low());
  read(kAbove_mV);
  EXPECT_FALSE(guard_.low());
}

TEST_F(SupplyGuardTest, IsOffWithoutALimit) {
  parameters_.supply_low_mV = 0;
  read(0, 100);
  EXPECT_FALSE(guard_.low());
}

TEST_F(SupplyGuardTest, ForgetsAllAfterAReset) {
  read(kLow_mV - 1, SupplyGuard::kReadings);
  guard_.reset();
  EXPECT_FALSE(guard_.low());
  EXPECT_EQ(guard_.open_circuit_mV(), 0);
}

}  // namespace
}  // namespace koboshi::behaviour
