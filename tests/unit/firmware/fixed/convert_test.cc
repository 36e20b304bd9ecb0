#include "firmware/fixed/host/convert.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "firmware/fixed/literals.h"

namespace koboshi::fixed {
namespace {

using namespace literals;

TEST(Convert, RoundTrips) {
  for (std::int64_t raw = std::numeric_limits<std::int32_t>::min();
       raw <= std::numeric_limits<std::int32_t>::max(); raw += 65'521) {
    const auto bits = static_cast<std::int32_t>(raw);
    ASSERT_EQ(from_double<Angle>(to_double(Angle::from_raw(bits))).raw(), bits);
    ASSERT_EQ(from_double<AngularRate>(to_double(AngularRate::from_raw(bits))).raw(), bits);
    ASSERT_EQ(from_double<Length>(to_double(Length::from_raw(bits))).raw(), bits);
    ASSERT_EQ(from_double<Ratio>(to_double(Ratio::from_raw(bits))).raw(), bits);
  }
}

TEST(Convert, UsesSiUnits) {
  EXPECT_DOUBLE_EQ(to_double(90.0_deg), std::numbers::pi / 2.0);
  EXPECT_DOUBLE_EQ(to_double(-360.0_deg_per_s), -2.0 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(to_double(0.5_m), 0.5);
  EXPECT_DOUBLE_EQ(to_double(1.25_kg), 1.25);
  EXPECT_EQ(from_double<Angle>(0.5), 0.5_rad);
  EXPECT_EQ(from_double<AngularRate>(7.48), 7.48_rad_per_s);
  EXPECT_EQ(from_double<Torque>(1.373), 1.373_Nm);
}

TEST(Convert, KeepsTheSignOfAHalfTurn) {
  EXPECT_EQ(from_double<Angle>(std::numbers::pi), Angle::max());
  EXPECT_EQ(from_double<Angle>(-std::numbers::pi), Angle::min());
  EXPECT_EQ(from_double<Angle>(1.5 * std::numbers::pi), -90.0_deg);
  EXPECT_EQ(from_double<Angle>(-4.5 * std::numbers::pi), -90.0_deg);
}

TEST(Convert, SaturatesQuantitiesAndRejectsNaN) {
  EXPECT_EQ(from_double<Length>(1e9), Length::max());
  EXPECT_EQ(from_double<Length>(-1e9), Length::min());
  EXPECT_THROW(static_cast<void>(from_double<Length>(std::nan(""))), std::domain_error);
  EXPECT_THROW(static_cast<void>(from_double<Angle>(std::numeric_limits<double>::infinity())),
               std::domain_error);
}

}  // namespace
}  // namespace koboshi::fixed
