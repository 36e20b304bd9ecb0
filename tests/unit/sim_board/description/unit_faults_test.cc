#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/xml/xml_draft.h"
#include "sim_board/description/robot_faults.h"
#include "sim_board/description/schema/sdf_schema.h"
#include "tests/unit/sim_board/description/full_robot.h"
#include "tests/unit/sim_board/description/small_robot.h"

// Numbers that a robot in other units would have: the limit of each is accepted, and the next number is not.
namespace koboshi::sim_board {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;

// Returns the ranges that the checks of units name for numbers of the robot outside of them.
std::vector<std::string> expected_in(const std::string& text) {
  const XmlDraft draft("FILE", text, sdf_rule());
  std::vector<std::string> expected;
  for (const RobotFault& fault : find_robot_faults(draft.root().child("model"), ".", {}))
    if (fault.kind == RobotFaultKind::kUnit) expected.push_back(fault.expected);
  return expected;
}

// The small robot with a box on its base, too. Its links measure 0.106 m and 0.173 m: the limit of lengths
// is 0.8385 m, three times their sum.
std::string boxed() {
  const std::size_t begin = kSmallRobot.find("<surface>");
  const std::string end = "</surface>";
  const std::string surface = kSmallRobot.substr(begin, kSmallRobot.find(end) + end.size() - begin);
  const std::string text = with("<pose>1 2 3 0 0 0</pose>", "<pose>0.1 0.2 0.3 0 0 0</pose>");
  const std::string before = "<ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia>\n      </inertial>";
  return replaced(text, before,
                  before +
                      "<collision name=\"block\"><geometry><box><size>0.1 0.1 0.1</size></box></geometry>" +
                      surface + "</collision>");
}

struct Limit {
  std::string before;  // a piece of the robot's text, with the number in the place of @ afterwards
  std::string after;
  std::string last;
  std::string beyond;
  std::string expected;
};

void expect_limits(const std::string& robot, const std::vector<Limit>& limits) {
  const auto given = [&](const Limit& limit, const std::string& number) {
    return replaced(robot, limit.before, replaced(limit.after, "@", number));
  };
  for (const Limit& limit : limits) {
    SCOPED_TRACE(limit.after);
    EXPECT_THAT(expected_in(given(limit, limit.last)), IsEmpty());
    EXPECT_THAT(expected_in(given(limit, limit.beyond)), ElementsAre(StartsWith(limit.expected)));
  }
}

TEST(UnitFaults, AreNotInASoundRobot) {
  EXPECT_THAT(expected_in(kSmallRobot), IsEmpty());
  EXPECT_THAT(expected_in(boxed()), IsEmpty());
  EXPECT_THAT(expected_in(kFullRobot), IsEmpty());
}

// 2 pi in six places is more than a turn by its rounding.
TEST(UnitFaults, AreAnglesBeyondATurn) {
  const std::string turn = "at most 6.28 rad (a turn)";
  expect_limits(kSmallRobot, {{"<pose relative_to=\"base\">0 0 0.1 0 0 1.5707963267948966",
                               "<pose relative_to=\"base\">0 0 0.1 0 0 @", "6.283186", "6.2833", turn},
                              {"<pose>1 2 3 0 0 0", "<pose>1 2 3 @ 0 0", "-6.283186", "-6.2833", turn},
                              {"<pose>0 0 0.05 0 0 0</pose>\n        <mass>",
                               "<pose>0 0 0.05 0 @ 0</pose>\n        <mass>", "6.283186", "6.2833", turn},
                              {"<pose>0 0 0.05 0 0 0</pose>\n        <geometry>",
                               "<pose>0 0 0.05 @ 0 0</pose>\n        <geometry>", "6.283186", "6.2833", turn},
                              {"<lower>-1</lower>", "<lower>@</lower>", "-6.283186", "-6.2833", turn},
                              {"<upper>2</upper>", "<upper>@</upper>", "6.283186", "6.2833", turn}});
}

TEST(UnitFaults, AreSpeedsAndNumbersOfAServoBeyondItsOwn) {
  expect_limits(kSmallRobot,
                {{"<velocity>7<", "<velocity>@<", "60", "60.1", "at most 60 rad/s (a fast servo)"},
                 {"<supply_V>7.5<", "<supply_V>@<", "120", "120.1", "at most 120 V (a low voltage)"},
                 {"<full_voltage_error_rad>0.1<", "<full_voltage_error_rad>@<", "1.5707", "1.5709",
                  "at most 1.57 rad (a quarter of a turn)"},
                 {"<coulomb_friction_Nm>0.02<", "<coulomb_friction_Nm>@<", "1.5", "1.501",
                  "at most 1.5 N m (its stall torque)"},
                 {"<rotor_inertia_kg_m2>0.001<", "<rotor_inertia_kg_m2>@<", "0.2", "0.201",
                  "at most 0.2 kg m^2 (a motor that takes a second to its speed)"},
                 {"<link name=\"hand\">",
                  "<koboshi:battery open_circuit_V=\"@\" internal_resistance_ohm=\"0\"/><link name=\"hand\">",
                  "120", "120.1", "at most 120 V (a low voltage)"}});
}

TEST(UnitFaults, AreBiasesBeyondThoseOfCheapSensors) {
  expect_limits(kFullRobot,
                {{"<bias>0.1<", "<bias>@<", "1.75", "1.76",
                  "at most 1.75 rad/s (five times that of a cheap gyroscope)"},
                 {"<bias>0.2<", "<bias>@<", "4.9", "4.91", "at most 4.9 m/s^2 (half of gravity)"}});
}

TEST(UnitFaults, AreMassesAndLengthsBeyondTheBoxes) {
  const std::string length = "at most 0.839 m (three times the length of all links)";
  const std::string inertia = "at most 0.0703 kg m^2 (its mass at three times the length of all links)";
  expect_limits(
      boxed(), {{"<mass>0.1<", "<mass>@<", "1.355", "1.356", "at most 1.36 kg (osmium in its boxes)"},
                {"<mass>0.2<", "<mass>@<", "22.59", "22.6", "at most 22.6 kg (osmium in its boxes)"},
                {"<pose>0.1 0.2 0.3 0 0 0", "<pose>0.1 0.2 @ 0 0 0", "0.8385", "0.8386", length},
                {"<pose>0 0 0.05 0 0 0</pose>\n        <mass>", "<pose>@ 0 0.05 0 0 0</pose>\n        <mass>",
                 "-0.8385", "-0.8386", length},
                {"<ixx>2e-4<", "<ixx>@<", "0.0703", "0.0704", inertia},
                {"<iyy>3e-4<", "<iyy>@<", "0.0703", "0.0704", inertia},
                {"<izz>4e-4<", "<izz>@<", "0.0703", "0.0704", inertia}});
}

}  // namespace
}  // namespace koboshi::sim_board
