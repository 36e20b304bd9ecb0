#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "tests/unit/base/scratch_file.h"
#include "tests/unit/sim_board/description/small_robot.h"

namespace koboshi::sim_board {
namespace {

using testing::MatchesRegex;

// The file of the default robot, its meshes where they are.
std::string default_robot_text() {
  const auto folder = std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi";
  std::ostringstream text;
  text << std::ifstream(folder / "robot.sdf").rdbuf();
  std::string changed = text.str();
  for (auto place = changed.find("meshes/"); place != std::string::npos;
       place = changed.find("meshes/", place + 1)) {
    const std::string absolute = (folder / "meshes/").string();
    changed.replace(place, 7, absolute);
    place += absolute.size();
  }
  return changed;
}

std::string sensor_complaint(const std::string& from, const std::string& to) {
  std::string text = default_robot_text();
  return complaint(text.replace(text.find(from), from.size(), to));
}

TEST(LoadSensor, RefusesSensorsItCannotSimulate) {
  EXPECT_EQ(sensor_complaint("koboshi", "koboshi"), "nothing");
  EXPECT_THAT(sensor_complaint("type=\"imu\"", "type=\"sonar\""),
              MatchesRegex("FILE:[0-9]+: found type = sonar, expected imu"));
  EXPECT_THAT(
      sensor_complaint("child_to_parent", "parent_to_child"),
      MatchesRegex("FILE:[0-9]+: found <measure_direction> = parent_to_child, expected child_to_parent"));
  EXPECT_THAT(sensor_complaint("<frame>sensor", "<frame>parent"),
              MatchesRegex("FILE:[0-9]+: found <frame> = parent, expected sensor"));
  EXPECT_THAT(sensor_complaint("\"right_ankle\"", "\"left_ankle\""),
              MatchesRegex("FILE:[0-9]+: found a second sensor left_ankle, expected one"));
  EXPECT_THAT(sensor_complaint("<range>17.4533", "<range>174.533"),
              MatchesRegex(
                  "FILE:[0-9]+: found <koboshi:gyro> of range 174.533 .*, expected counts that fit 16 bits"));
}

// Replaces both ankle sensors of the default robot.
RobotDescription with_ankles(const std::string& type, const std::string& keys) {
  std::string text = default_robot_text();
  for (const std::string side : {"left", "right"}) {
    const std::size_t begin = text.find("<sensor name=\"" + side + "_ankle\"");
    text.replace(
        begin, text.find("</sensor>", begin) - begin,
        "<sensor name=\"" + side + "_ankle\" type=\"" + type + "\"><update_rate>200</update_rate>" + keys);
  }
  const ScratchFile scratch("sdf", text);
  return load_robot(scratch.path());
}

std::string type_complaint(const std::string& type, const std::string& keys) {
  try {
    with_ankles(type, keys);
  } catch (const InputError& error) {
    return error.found() + ", expected " + error.expected();
  }
  return "nothing";
}

const std::string kCell = "<koboshi:cell>0.03 0.01</koboshi:cell>";
const std::string kCellForce =
    "<koboshi:cell_force><noise_density>0.001</noise_density><bias>0.05</bias><bandwidth_Hz>98</bandwidth_Hz>"
    "<range>30</range><resolution>0.01</resolution><delay_s>0.001</delay_s></koboshi:cell_force>";
const std::string kSwitchForce = "<koboshi:closing_force_N>1.5</koboshi:closing_force_N>";

TEST(LoadSensor, ReadsEachKindOfFoot) {
  const RobotDescription cells =
      with_ankles("koboshi:pressure_cells",
                  kCell + kCell + "<koboshi:cell>-0.02 -0.01</koboshi:cell>" + kCell + kCellForce);
  EXPECT_EQ(cells.ankle_kind(), hal::AnkleKind::kPressureCells);
  EXPECT_EQ(cells.left_ankle->cells_S_m[2], Eigen::Vector2d(-0.02, -0.01));
  EXPECT_EQ(cells.right_ankle->force.range, 30.0);
  EXPECT_NEAR(cells.right_ankle->height_above_sole_m, 0.04, 1e-9);
  const RobotDescription switches = with_ankles("koboshi:contact_switch", kSwitchForce);
  EXPECT_EQ(switches.ankle_kind(), hal::AnkleKind::kContactSwitch);
  EXPECT_EQ(switches.left_ankle->closing_force_N, 1.5);
  EXPECT_EQ(switches.left_ankle->force.sample_period_s, 0.005);
}

TEST(LoadSensor, RefusesKeysOfAnotherKindOfFoot) {
  const std::string cells = kCell + kCell + kCell + kCell;
  EXPECT_EQ(type_complaint("koboshi:pressure_cells", cells + kCellForce), "nothing");
  EXPECT_EQ(type_complaint("koboshi:pressure_cells", kCell + kCellForce),
            "1 times <koboshi:cell> in a sensor of type koboshi:pressure_cells, expected 4");
  EXPECT_EQ(type_complaint("koboshi:pressure_cells", cells),
            "0 times <koboshi:cell_force> in a sensor of type koboshi:pressure_cells, expected 1");
  EXPECT_EQ(type_complaint("koboshi:contact_switch", cells + kSwitchForce),
            "4 times <koboshi:cell> in a sensor of type koboshi:contact_switch, expected none");
  EXPECT_EQ(type_complaint("force_torque", kSwitchForce),
            "0 times <force_torque> in a sensor of type force_torque, expected 1");
}

// Gives an optional element of a sensor a value, whether the text has it or not: in front of `place`.
void set_sensor_error(std::string& text, const std::string& place, const std::string& name,
                      const std::string& value) {
  const std::string end = "</" + name + ">";
  const auto present = text.find("<" + name + ">");
  if (present != std::string::npos) text.erase(present, text.find(end, present) + end.size() - present);
  text.insert(text.find(place), "<" + name + ">" + value + end);
}

std::string error_complaint(const std::string& place, const std::string& name, const std::string& value) {
  std::string text = default_robot_text();
  set_sensor_error(text, place, name, value);
  return complaint(text);
}

TEST(LoadSensor, ReadsTheErrorsOfSensors) {
  std::string text = default_robot_text();
  const std::string gyro = "<bandwidth_Hz>98";  // the first in the file
  set_sensor_error(text, gyro, "bias_instability", "3e-5");
  set_sensor_error(text, gyro, "random_walk", "1e-6");
  set_sensor_error(text, gyro, "scale_error", "0.04");
  set_sensor_error(text, gyro, "cross_axis", "0.05");
  set_sensor_error(text, gyro, "g_sensitivity", "2e-4");
  set_sensor_error(text, "<koboshi:gyro>", "koboshi:jitter_s", "2e-5");
  set_sensor_error(text, "<force_torque>", "koboshi:crosstalk", "0.07");
  const ScratchFile scratch("sdf", text);
  const RobotDescription robot = load_robot(scratch.path());
  EXPECT_EQ(robot.imu->gyro.bias_instability, 3e-5);
  EXPECT_EQ(robot.imu->gyro.random_walk, 1e-6);
  EXPECT_EQ(robot.imu->gyro.scale_error, 0.04);
  EXPECT_EQ(robot.imu->gyro.cross_axis, 0.05);
  EXPECT_EQ(robot.imu->g_sensitivity, 2e-4);
  EXPECT_EQ(robot.imu->gyro.jitter_s, 2e-5);
  EXPECT_EQ(robot.imu->accelerometer.jitter_s, 2e-5);
  EXPECT_EQ(robot.left_ankle->crosstalk, 0.07);
  EXPECT_EQ(robot.left_ankle->force.jitter_s, 0.0);
}

TEST(LoadSensor, NamesFieldValueAndRangeOfBadSensorErrors) {
  const std::string gyro = "<bandwidth_Hz>98";  // the first in the file
  const std::string ankle = "<force_torque>";
  for (const char* name : {"koboshi:jitter_s", "koboshi:crosstalk"}) {
    EXPECT_THAT(error_complaint(ankle, name, "-1"), MatchesRegex("FILE:[0-9]+: found <" + std::string(name) +
                                                                 "> = -1, expected a number from 0 to 0.5"));
  }
  for (const char* name : {"bias_instability", "random_walk"}) {
    EXPECT_THAT(error_complaint(gyro, name, "-1"), MatchesRegex("FILE:[0-9]+: found <" + std::string(name) +
                                                                "> = -1, expected a number of 0 or more"));
  }
  for (const char* name : {"scale_error", "cross_axis"}) {
    EXPECT_THAT(error_complaint(gyro, name, "0.6"), MatchesRegex("FILE:[0-9]+: found <" + std::string(name) +
                                                                 "> = 0.6, expected a number from 0 to 0.5"));
  }
  EXPECT_THAT(error_complaint(gyro, "g_sensitivity", "2"),
              MatchesRegex("FILE:[0-9]+: found <g_sensitivity> = 2, expected a number from 0 to 1"));
  EXPECT_THAT(error_complaint("<koboshi:gyro>", "koboshi:jitter_s", "0.0005"),
              MatchesRegex("FILE:[0-9]+: found <koboshi:jitter_s> = 5e-04, expected less than half the "
                           "sampling period, 5e-04"));
  EXPECT_THAT(error_complaint("<koboshi:gyro>", "koboshi:crosstalk", "0.01"),
              MatchesRegex("FILE:[0-9]+: found the unknown element <koboshi:crosstalk> in <sensor>.*"));
}

}  // namespace
}  // namespace koboshi::sim_board
