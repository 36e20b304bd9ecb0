#include "base/text/units.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text/user_units.h"

namespace koboshi {
namespace {

using testing::ElementsAre;

TEST(SplitUnits, TakesAUnitWithAndWithoutABlank) {
  for (const char* text : {"45g", "45 g", " 45\tg ", "45  g"}) {
    const auto typed = split_units(text);
    ASSERT_TRUE(typed) << text;
    EXPECT_THAT(typed->texts, ElementsAre("45")) << text;
    EXPECT_EQ(typed->unit, "g") << text;
  }
  EXPECT_EQ(split_units("-1.5e3deg/s")->texts.front(), "-1.5e3");
  EXPECT_EQ(split_units("90\u00B0")->unit, "\u00B0");
  EXPECT_EQ(split_units("5 kg m^2")->unit, "kg m^2");
  EXPECT_EQ(split_units("5")->unit, "");
}

TEST(SplitUnits, HasOneUnitForAllNumbers) {
  EXPECT_THAT(split_units("0 +.5 -65 mm")->texts, ElementsAre("0", "+.5", "-65"));
  EXPECT_THAT(split_units("1mm 2 mm 3mm")->texts, ElementsAre("1", "2", "3"));
  for (const char* text :
       {"1mm 2", "1 2mm 3mm", "1mm 2cm", "", "g", "mm 5", "1,5 kg", "1.2.3", "-", "nan", "inf", "1e999"})
    EXPECT_FALSE(split_units(text)) << text;
}

TEST(UnitFactor, ConvertsUnitsOfOneQuantity) {
  EXPECT_EQ(unit_factor("g", "kg"), 1e-3);
  EXPECT_EQ(unit_factor("deg", "rad"), kRadPerDegree);
  EXPECT_EQ(unit_factor("\u00B0", "deg"), 1.0);
  EXPECT_DOUBLE_EQ(*unit_factor("g\u00B7cm\u00B2", "kg m^2"), 1e-7);
  EXPECT_EQ(unit_factor("N m s/rad", "Nm s/rad"), 1.0);  // which the table does not have
  EXPECT_EQ(unit_factor("mm", "kg"), std::nullopt);
  EXPECT_EQ(unit_factor("lb", "kg"), std::nullopt);
  EXPECT_EQ(unit_factor("G", "kg"), std::nullopt);
}

TEST(ParseQuantity, IsInTheUnitOfTheKey) {
  EXPECT_EQ(parse_quantity("0.5", "s"), 0.5);
  EXPECT_EQ(parse_quantity("500ms", "s"), 0.5);
  EXPECT_EQ(parse_quantity("500 ms", "s"), 0.5);
  EXPECT_EQ(parse_quantity("1m", "mm"), 1000.0);
  EXPECT_EQ(parse_quantity("500 g", "s"), std::nullopt);
  EXPECT_EQ(parse_quantity("5 s", ""), std::nullopt);
  EXPECT_EQ(parse_quantity("5 6", "s"), std::nullopt);
  EXPECT_EQ(expected_unit("kg"), "the unit kg or g");
  EXPECT_EQ(expected_unit("J/K"), "the unit J/K");
  EXPECT_EQ(expected_unit(""), "no unit");
}

TEST(UnitOfKey, IsTheEndOfTheKey) {
  EXPECT_EQ(unit_of_key("duration_s"), "s");
  EXPECT_EQ(unit_of_key("ground.height_field.position_m[1]"), "m");
  EXPECT_EQ(unit_of_key("pushes[0].torque_Nm"), "Nm");
  EXPECT_EQ(unit_of_key("walk.turn_rad_per_s"), "rad/s");
  EXPECT_EQ(unit_of_key("initial.joints_deg.left_knee"), "deg");
  for (const char* key : {"", "seed", "s", "rate_per_s", "a_m.b.c", "left_knee", "trunk_x"})
    EXPECT_EQ(unit_of_key(key), "") << key;
}

}  // namespace
}  // namespace koboshi
