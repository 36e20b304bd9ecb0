#include "simulation/scenario/reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/simulation/scenario/scenario_text.h"

// Every number of a scenario is accepted at both ends of its range and refused beyond them: existing
// scenarios stay valid, and the page of the format stays true.
namespace koboshi::simulation {
namespace {

using scenario_text::kShort;
using scenario_text::refusal;
using ::testing::HasSubstr;

// A line of a scenario with @ in place of the number.
struct Range {
  std::string line;
  std::string below;  // empty: no end
  std::string lowest;
  std::string highest;
  std::string above;
};

std::string with_number(const Range& range, const std::string& number) {
  const std::size_t place = range.line.find('@');
  return kShort + range.line.substr(0, place) + number + range.line.substr(place + 1) + "\n";
}

void expect_ranges(const std::vector<Range>& ranges) {
  for (const Range& range : ranges) {
    SCOPED_TRACE(range.line);
    for (const std::string& end : {range.lowest, range.highest}) {
      if (end.empty()) continue;
      EXPECT_EQ(refusal(with_number(range, end)), "");
    }
    for (const std::string& beyond : {range.below, range.above}) {
      if (beyond.empty()) continue;
      EXPECT_THAT(refusal(with_number(range, beyond)), HasSubstr(" = " + beyond + ", expected "));
    }
  }
}

std::string command(const std::string& text) { return "commands: [{at_s: 1, " + text + "}]"; }
std::string push(const std::string& text) { return "pushes: [{link: trunk, " + text + "}]"; }
std::string fault(const std::string& text) { return "faults: [{" + text + "}]"; }
std::string shape(const std::string& text) { return "ground: {shapes: [{" + text + "}]}"; }
std::string pair(const std::string& text) { return "materials: [{between: [ice, tin], " + text + "}]"; }
std::string body(const std::string& text) { return "bodies: [{name: ball, mass_kg: 1, " + text + "}]"; }

TEST(ScenarioRanges, OfCommands) {
  expect_ranges({
      {"commands: [{at_s: @, stop: true}]", "-0.1", "0", "86400", "86400.1"},
      {command("walk: {forward_m_per_s: @}"), "-2.01", "-2", "2", "2.01"},
      {command("walk: {left_m_per_s: @}"), "-2.01", "-2", "2", "2.01"},
      {command("walk: {turn_rad_per_s: @}"), "-6.01", "-6", "6", "6.01"},
      {command("stream: {joints_deg: {left_knee: @}}"), "-180.1", "-180", "179.9", "180"},
  });
}

TEST(ScenarioRanges, OfPushes) {
  const std::string force = "force_N: [0, 0, 1]";
  expect_ranges({
      {push("duration_s: 1, " + force + ", at_s: @"), "-0.1", "0", "86400", "86400.1"},
      {push("at_s: 1, " + force + ", duration_s: @"), "0.0000009", "0.000001", "3600", "3600.1"},
      {push("at_s: 1, duration_s: 1, force_N: [@, 0, 0]"), "-10000.1", "-10000", "10000", "10000.1"},
      {push("at_s: 1, duration_s: 1, force_N: [0, 0, @]"), "-10000.1", "-10000", "10000", "10000.1"},
      {push("at_s: 1, duration_s: 1, " + force + ", at_m: [@, 0, 0]"), "-10.1", "-10", "10", "10.1"},
      {push("at_s: 1, duration_s: 1, " + force + ", at_m: [0, 0, @]"), "-10.1", "-10", "10", "10.1"},
  });
}

TEST(ScenarioRanges, OfFaults) {
  expect_ranges({
      {fault("kind: imu_stop, at_s: @"), "-0.1", "0", "86400", "86400.1"},
      {fault("kind: imu_stop, at_s: 1, duration_s: @"), "0.0000009", "0.000001", "86400", "86400.1"},
      {fault("kind: supply_drop, at_s: 1, supply_V: @"), "-0.1", "0", "1000", "1000.1"},
      {fault("kind: battery_discharge, at_s: 1, open_circuit_V: @"), "-0.1", "0", "1000", "1000.1"},
      {fault("kind: battery_discharge, at_s: 1, open_circuit_V: 5, over_s: @"), "-0.1", "0", "86400",
       "86400.1"},
      {fault("kind: frames_lost, at_s: 1, identifier: @"), "-1", "0", "0x7FF", "0x800"},
      {fault("kind: frames_lost, at_s: 1, identifier: [0, @]"), "-1", "0", "2047", "2048"},
      {fault("kind: frames_lost, at_s: 1, share: @"), "-0.01", "0", "1", "1.01"},
      {fault("kind: frames_lost, at_s: 1, count: @"), "0", "1", "1000000000", "1000000001"},
      {fault("kind: frames_delayed, at_s: 1, delay_ms: @"), "0.0009", "0.001", "10000", "10000.1"},
      {fault("kind: babbling_node, at_s: 1, identifier: @"), "-1", "0", "0x7FF", "0x800"},
      {fault("kind: babbling_node, at_s: 1, identifier: 0, size: @"), "-1", "0", "8", "9"},
      {fault("kind: babbling_node, at_s: 1, identifier: 0, data: [@]"), "-1", "0", "255", "256"},
      {fault("kind: babbling_node, at_s: 1, identifier: 0, rate_per_s: @"), "0.9", "1", "20000", "20000.1"},
  });
  EXPECT_EQ(
      refusal(kShort + fault("kind: babbling_node, at_s: 1, identifier: 0, data: [1, 2, 3, 4, 5, 6, 7, 8]")),
      "");
}

TEST(ScenarioRanges, OfTheGround) {
  const std::string place = "position_m: [0, 0], ";
  const std::string rough = "height_field: {" + place + "size_m: [1, 1], ";
  expect_ranges({
      {"ground: {friction: @}", "-0.1", "0", "10", "10.1"},
      {"ground: {friction: [1, @]}", "-0.1", "0", "10", "10.1"},
      {"ground: {friction: 1, friction_direction_deg: @}", "-360.1", "-360", "360", "360.1"},
      {"ground: {damping_N_s_per_m: 1, stiffness_N_per_m: @}", "99.9", "100", "100000000", "100000001"},
      {"ground: {stiffness_N_per_m: 100, damping_N_s_per_m: @}", "-0.1", "0", "1000000", "1000001"},
      {"ground: {bounce: @}", "-0.1", "0", "1", "1.1"},
      {"ground: {bounce: 1, bounce_threshold_m_per_s: @}", "-0.1", "0", "10", "10.1"},
      {"ground: {slip_m_per_N_s: @}", "-0.1", "0", "10", "10.1"},
      {"ground: {tilt_deg: [@, 0]}", "-45.1", "-45", "45", "45.1"},
      {"ground: {tilt_deg: [0, @]}", "-45.1", "-45", "45", "45.1"},
      {shape("patch: {radius_m: 1, position_m: [@, 0]}"), "-100.1", "-100", "100", "100.1"},
      {shape("patch: {radius_m: 1, position_m: [0, @]}"), "-100.1", "-100", "100", "100.1"},
      {shape("patch: {radius_m: 1, position_m: [0, 0], yaw_deg: @}"), "-360.1", "-360", "360", "360.1"},
      {shape("patch: {" + place + "radius_m: @}"), "0.0009", "0.001", "100", "100.1"},
      {shape("patch: {" + place + "size_m: [1, @]}"), "0.0009", "0.001", "100", "100.1"},
      {shape("box: {" + place + "size_m: [1, 1, @]}"), "0.0009", "0.001", "100", "100.1"},
      {shape("box: {" + place + "size_m: [1, 1, 1], bottom_m: @}"), "-10.1", "-10", "10", "10.1"},
      {shape("box: {" + place + "size_m: [1, 1, 1], tilt_deg: [@, 0]}"), "-360.1", "-360", "360", "360.1"},
      {shape("box: {" + place + "size_m: [1, 1, 1], tilt_deg: [0, @]}"), "-360.1", "-360", "360", "360.1"},
      {shape("ramp: {" + place + "width_m: 1, angle_deg: 1, length_m: @}"), "0.0009", "0.001", "100",
       "100.1"},
      {shape("ramp: {" + place + "length_m: 1, angle_deg: 1, width_m: @}"), "0.0009", "0.001", "100",
       "100.1"},
      {shape("ramp: {" + place + "length_m: 1, width_m: 1, angle_deg: @}"), "0.09", "0.1", "45", "45.1"},
      {shape("steps: {" + place + "rise_m: 1, run_m: 1, width_m: 1, count: @}"), "0", "1", "200", "201"},
      {shape("steps: {" + place + "count: 1, run_m: 1, width_m: 1, rise_m: @}"), "0.00009", "0.0001", "10",
       "10.1"},
      {shape("steps: {" + place + "count: 1, rise_m: 1, width_m: 1, run_m: @}"), "0.0009", "0.001", "100",
       "100.1"},
      {shape("steps: {" + place + "count: 1, rise_m: 1, run_m: 1, width_m: @}"), "0.0009", "0.001", "100",
       "100.1"},
      {shape(rough + "wavelength_m: 1, height_m: @}"), "0.00009", "0.0001", "10", "10.1"},
      {shape(rough + "height_m: 1, wavelength_m: @}"), "0.0009", "0.001", "100", "100.1"},
      {shape(rough + "height_m: 1, wavelength_m: 1, spacing_m: @}"), "0.0001", "0.1", "1", "1.1"},
      {shape(rough + "height_m: 1, wavelength_m: 1, seed: @}"), "-1", "0", "", ""},
  });
}

TEST(ScenarioRanges, OfMaterialsAndFreeBodies) {
  const std::string ball = "diameter_m: 1, ";
  const std::string place = "position_m: [0, 0], ";
  expect_ranges({
      {pair("friction: @"), "-0.1", "0", "10", "10.1"},
      {pair("bounce: @"), "-0.1", "0", "1", "1.1"},
      {pair("bounce_threshold_m_per_s: @"), "-0.1", "0", "10", "10.1"},
      {pair("slip_m_per_N_s: @"), "-0.1", "0", "10", "10.1"},
      {pair("damping_N_s_per_m: 1, stiffness_N_per_m: @"), "99.9", "100", "100000000", "100000001"},
      {pair("stiffness_N_per_m: 100, damping_N_s_per_m: @"), "-0.1", "0", "1000000", "1000001"},
      {"bodies: [{name: ball, " + place + ball + "mass_kg: @}]", "0.0009", "0.001", "100", "100.1"},
      {body(place + "diameter_m: @"), "0.0049", "0.005", "10", "10.1"},
      {body(place + "size_m: [1, 1, @]"), "0.0049", "0.005", "10", "10.1"},
      {body(place + ball + "friction: @"), "-0.1", "0", "10", "10.1"},
      {body(place + ball + "rolling_friction: @"), "-0.1", "0", "1", "1.1"},
      {body(place + ball + "bounce: @"), "-0.1", "0", "1", "1.1"},
      {body(place + ball + "contact_time_ms: @"), "0.9", "1", "50", "50.1"},
      {body(ball + "position_m: [0, @]"), "-100.1", "-100", "100", "100.1"},
      {body(place + ball + "yaw_deg: @"), "-360.1", "-360", "360", "360.1"},
      {body(place + ball + "height_m: @"), "-10.1", "-10", "100", "100.1"},
      {body(place + ball + "velocity_m_per_s: [0, 0, @]"), "-50.1", "-50", "50", "50.1"},
  });
}

TEST(ScenarioRanges, OfTheRun) {
  expect_ranges({
      {"seed: @", "-1", "0", "", ""},
      {"noise: @", "-0.1", "0", "100", "100.1"},
      {"world: {name: rough, seed: @}", "-1", "0", "", ""},
      {"controller: {computing_time_us: @}", "-1", "0", "9000", "9001"},
      {"controller: {computing_time_us: 0, tick_jitter_us: @}", "-1", "0", "9000", "9001"},
      {"physics: {step_ms: @}", "0.009", "0.01", "1", "1.1"},
      {"initial: {height_m: @}", "-0.1", "0", "10", "10.1"},
      {"initial: {drop_m: @}", "-0.1", "0", "10", "10.1"},
      {"initial: {held_until_s: @}", "-0.1", "0", "86400", "86400.1"},
      {"initial: {attitude_deg: {roll: @}}", "-360.1", "-360", "360", "360.1"},
      {"initial: {attitude_deg: {pitch: @}}", "-360.1", "-360", "360", "360.1"},
      {"initial: {attitude_deg: {yaw: @}}", "-360.1", "-360", "360", "360.1"},
      {"initial: {joints_deg: {left_knee: @}}", "-360.1", "-360", "360", "360.1"},
  });
  const std::string before = "version: 1\nrobot: robots/box/robot.sdf\nduration_s: ";
  EXPECT_EQ(refusal(before + "0.01\n"), "");
  EXPECT_EQ(refusal(before + "86400\n"), "");
  EXPECT_THAT(refusal(before + "0.009\n"), HasSubstr("duration_s = 0.009, expected "));
  EXPECT_THAT(refusal(before + "86400.1\n"), HasSubstr("duration_s = 86400.1, expected "));
}

}  // namespace
}  // namespace koboshi::simulation
