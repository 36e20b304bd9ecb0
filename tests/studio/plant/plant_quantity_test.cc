#include "studio/plant/plant_quantity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "sim_board/description/edit/field_value.h"
#include "sim_board/description/edit/robot_text.h"
#include "studio/plant/plant_document.h"

namespace koboshi::studio {
namespace {

const XmlDocument& robot() {
  static const XmlDocument document(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  return document;
}

std::vector<PlantQuantity> quantities(const std::string& element, const XmlDocument& plant = robot()) {
  return plant_quantities(robot(), plant, element);
}

PlantQuantity named(const std::vector<PlantQuantity>& all, const std::string& name) {
  const auto found = std::ranges::find(all, name, &PlantQuantity::name);
  EXPECT_NE(found, all.end()) << name;
  return found == all.end() ? all.front() : *found;
}

TEST(PlantQuantity, IsInUnitsOfPeopleWithARangeAroundTheModel) {
  const auto shank = quantities("left_shank");
  const PlantQuantity mass = named(shank, "left_shank.mass");
  EXPECT_EQ(mass.name(), shank.front().name());  // what is asked for first
  EXPECT_EQ(mass.unit, "g");
  EXPECT_EQ(mass.group, "inertial");
  EXPECT_DOUBLE_EQ(mass.model, 50.0);
  EXPECT_DOUBLE_EQ(mass.plant, 50.0);
  EXPECT_FALSE(mass.differs());
  EXPECT_DOUBLE_EQ(mass.slider_low, 5.0);
  EXPECT_DOUBLE_EQ(mass.slider_high, 150.0);
  EXPECT_DOUBLE_EQ(mass.high, 1e6);  // of the table of keys
  EXPECT_EQ(mass.decimals, 1);
  const PlantQuantity com = named(shank, "left_shank.com z");
  EXPECT_EQ(com.label, "centre of mass z");
  EXPECT_EQ(com.unit, "mm");
  EXPECT_DOUBLE_EQ(com.model, -33.0);
  EXPECT_LT(com.slider_low, -50.0);
  EXPECT_GT(com.slider_high, -15.0);
  const PlantQuantity backlash = named(quantities("krs_2552"), "krs_2552.backlash_rad");
  EXPECT_EQ(backlash.unit, "deg");
  EXPECT_EQ(backlash.label, "backlash");
  EXPECT_EQ(named(quantities("krs_2552"), "krs_2552.torque_constant_Nm_per_A").label, "torque constant");
  EXPECT_EQ(backlash.slider_low, 0.0);
}

TEST(PlantQuantity, LeavesOutTheLookAndTheIdentityOfADrive) {
  std::set<std::string> names;
  for (const auto& element : plant_elements(robot()))
    for (const PlantQuantity& quantity : quantities(element.name)) {
      EXPECT_TRUE(names.insert(quantity.name()).second) << quantity.name();
      EXPECT_EQ(quantity.name().find("visual"), std::string::npos) << quantity.name();
    }
  for (const char* one : {"left_foot.friction", "left_knee.position x", "left_knee.zero_rad",
                          "left_knee.bits", "left_knee.gear", "krs_2552.resistance_ohm",
                          "krs_2552.coulomb_friction_Nm", "left_shank.ixx", "left_shank.size z"})
    EXPECT_TRUE(names.contains(one)) << one;
  for (const char* one : {"left_knee.node_id", "left_knee.servo_id", "head.helmet.scale x"})
    EXPECT_FALSE(names.contains(one)) << one;
}

// The table of keys is the only one: the reader takes what every slider gives, at both ends and at rest.
TEST(PlantQuantity, GivesValuesThatTheReaderTakes) {
  int count = 0;
  for (const auto& element : plant_elements(robot())) {
    for (const PlantQuantity& quantity : quantities(element.name)) {
      EXPECT_LE(quantity.slider_low, quantity.model) << quantity.name();
      EXPECT_GE(quantity.slider_high, quantity.model) << quantity.name();
      EXPECT_LT(quantity.slider_low, quantity.slider_high) << quantity.name();
      for (const double value : {quantity.slider_low, quantity.model, quantity.slider_high}) {
        const std::string typed = typed_value(quantity, robot(), value);
        std::string text;
        ASSERT_NO_THROW(text = sim_board::file_text(robot(), quantity.field, typed))
            << quantity.name() << " = " << typed;
        if (value != quantity.model) continue;
        EXPECT_TRUE(same_value(text, quantity.field.value.value_or(quantity.field.fallback())))
            << quantity.name() << " = " << typed;
      }
      ++count;
    }
  }
  EXPECT_GT(count, 1000);
}

TEST(PlantQuantity, KeepsTheDigitsOfTheOtherComponents) {
  XmlDocument fine = robot();
  sim_board::edit_settings(fine, {{"left_shank.com", "0.00012345678 0 -0.033"}}, sim_board::Sides::kOne);
  const auto shank = plant_quantities(fine, fine, "left_shank");
  EXPECT_EQ(typed_value(named(shank, "left_shank.com z"), fine, -30.0), "0.00012345678 0 -0.03");
  EXPECT_EQ(typed_value(named(quantities("left_shank"), "left_shank.com x"), robot(), 1.5), "1.5 0 -33 mm");
}

TEST(PlantQuantity, ShowsThePlantBesideTheModel) {
  XmlDocument plant = robot();
  sim_board::edit_settings(plant, {{"left_shank.mass", "180 g"}, {"left_knee.gear", "1.1"}},
                           sim_board::Sides::kOne);
  const PlantQuantity mass = named(quantities("left_shank", plant), "left_shank.mass");
  EXPECT_TRUE(mass.differs());
  EXPECT_DOUBLE_EQ(mass.plant, 180.0);
  EXPECT_DOUBLE_EQ(mass.slider_high, 180.0);
  const PlantQuantity gear = named(quantities("left_knee", plant), "left_knee.gear");
  EXPECT_DOUBLE_EQ(gear.model, 1.0);  // the default: the file lacks it
  EXPECT_DOUBLE_EQ(gear.plant, 1.1);
  EXPECT_TRUE(quantities("nothing").empty());
}

}  // namespace
}  // namespace koboshi::studio
