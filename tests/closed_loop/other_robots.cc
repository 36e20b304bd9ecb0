#include "tests/closed_loop/other_robots.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace koboshi::test {
namespace {

std::string read(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// Cuts out the text from `begin` to the end of `end`.
std::string cut(std::string& text, const std::string& begin, const std::string& end) {
  const auto first = text.find(begin);
  const auto last = text.find(end, first);
  if (first == std::string::npos || last == std::string::npos)
    throw std::logic_error("the robot has no " + begin);
  const std::string part = text.substr(first, last + end.size() - first);
  text.erase(first, part.size());
  return part;
}

void replace(std::string& text, const std::string& from, const std::string& to) {
  const auto place = text.find(from);
  if (place == std::string::npos) throw std::logic_error("the robot has no " + from);
  text.replace(place, from.size(), to);
}

void insert_before(std::string& text, const std::string& place, const std::string& part) {
  replace(text, place, part + place);
}

constexpr std::array kSides{"left", "right"};

void replace_ankle_sensors(std::string& robot, const std::string& sensor) {
  for (const std::string side : kSides) {
    const std::string joint = "<joint name=\"" + side + "_ankle_roll\"";
    cut(robot, "<sensor name=\"" + side + "_ankle\"", "</sensor>");
    if (sensor.empty()) continue;
    const auto place = robot.find("</joint>", robot.find(joint));
    std::string text = sensor;
    replace(text, "SIDE", side);
    robot.insert(place, text);
  }
}

struct Part {
  std::string joint;
  std::string role;  // empty: the name
  std::string parent;
  std::string link;
  std::string pose;  // of the link and the joint's anchor, in the parent link
  std::string axis;
  double mass_kg = 0.0;
  double com_z_m = 0.0;
  int node_id = 0;
};

std::string link_text(const Part& part) {
  const double inertia = part.mass_kg * 2e-4;  // of a cube of 35 mm
  return fmt::format(
      R"(<link name="{}"><pose relative_to="{}">{}</pose>
<inertial><pose>0 0 {} 0 0 0</pose><mass>{}</mass>
<inertia><ixx>{:e}</ixx><iyy>{:e}</iyy><izz>{:e}</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>
</link>
)",
      part.link, part.parent, part.pose, part.com_z_m, part.mass_kg, inertia, inertia, inertia);
}

std::string joint_text(const Part& part, const std::string& sensor = "") {
  return fmt::format(
      R"(<joint name="{}" type="revolute"><parent>{}</parent><child>{}</child>
<axis><xyz>{}</xyz><limit><lower>-1.57</lower><upper>1.57</upper><velocity>7.48</velocity></limit></axis>
<koboshi:servo type="krs_2552"/><koboshi:encoder bits="12" noise_counts="0.1"/>
<koboshi:drive node_id="{}" serial_number="{}" sign="1" zero_rad="0"/>{}</joint>
)",
      part.joint, part.parent, part.link, part.axis, part.node_id, 255200000 + part.node_id, sensor);
}

void add(std::string& robot, const Part& part) {
  insert_before(robot, "</model>", link_text(part) + joint_text(part));
}

}  // namespace

std::string default_robot() {
  const std::string text = read(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  return std::regex_replace(text, std::regex("<visual [^]*?</visual>"), "");
}

std::string with_pressure_cells(std::string robot) {
  replace_ankle_sensors(robot, R"(<sensor name="SIDE_ankle" type="koboshi:pressure_cells">
<update_rate>500</update_rate>
<koboshi:cell>0.055 0.022</koboshi:cell><koboshi:cell>0.055 -0.022</koboshi:cell>
<koboshi:cell>-0.032 0.022</koboshi:cell><koboshi:cell>-0.032 -0.022</koboshi:cell>
<koboshi:cell_force><noise_density>0.002</noise_density><bias>0.03</bias><scale_error>0.03</scale_error>
<bandwidth_Hz>98</bandwidth_Hz><range>30</range><resolution>0.01</resolution><delay_s>0.002</delay_s>
</koboshi:cell_force></sensor>)");
  return robot;
}

std::string with_contact_switches(std::string robot) {
  replace_ankle_sensors(robot, R"(<sensor name="SIDE_ankle" type="koboshi:contact_switch">
<update_rate>500</update_rate><koboshi:closing_force_N>1</koboshi:closing_force_N></sensor>)");
  return robot;
}

std::string without_ankle_sensors(std::string robot) {
  replace_ankle_sensors(robot, "");
  return robot;
}

std::string with_inertial_unit(std::string robot, const std::string& link, const std::string& pose) {
  std::string sensor = cut(robot, "<sensor name=\"imu\"", "</sensor>");
  sensor = std::regex_replace(sensor, std::regex("<pose>[^<]*</pose>"), "<pose>" + pose + "</pose>");
  const auto place = robot.find("</link>", robot.find("<link name=\"" + link + "\""));
  robot.insert(place, sensor);
  return robot;
}

std::string with_waist(std::string robot) {
  // The pelvis keeps the hips, the battery and its board; the chest has the rest of the trunk's mass.
  replace(robot, "<mass>0.36</mass>", "<mass>0.2</mass>");
  for (const char* joint : {"left_shoulder_pitch", "right_shoulder_pitch", "head_pan"}) {
    const auto place =
        robot.find("<parent>trunk</parent>", robot.find(std::string("<joint name=\"") + joint));
    robot.replace(place, std::string("<parent>trunk</parent>").size(), "<parent>chest</parent>");
  }
  add(robot, {"waist_yaw", "", "trunk", "waist_yaw_link", "0 0 0.07 0 0 0", "0 0 1", 0.01, 0.0, 39});
  add(robot, {"waist_roll", "", "waist_yaw_link", "waist_roll_link", "0 0 0 0 0 0", "1 0 0", 0.01, 0.0, 40});
  add(robot, {"waist_pitch", "", "waist_roll_link", "chest", "0 0 0 0 0 0", "0 1 0", 0.14, 0.035, 41});
  return robot;
}

std::string with_longer_arms(std::string robot) {
  int node_id = 42;
  for (const std::string side : kSides) {
    const auto elbow = robot.find("<joint name=\"" + side + "_elbow\"");
    const std::string parent = "<parent>" + side + "_upper_arm</parent>";
    robot.replace(robot.find(parent, elbow), parent.size(), "<parent>" + side + "_arm_yaw</parent>");
    add(robot, {side + "_shoulder_yaw", "", side + "_upper_arm", side + "_arm_yaw", "0 0 -0.03 0 0 0",
                "0 0 1", 0.008, 0.0, node_id++});
    add(robot, {side + "_wrist_yaw", "", side + "_forearm", side + "_wrist", "0 0 -0.08 0 0 0", "0 0 1",
                0.006, 0.0, node_id++});
    add(robot, {side + "_wrist_pitch", "", side + "_wrist", side + "_hand", "0 0 -0.01 0 0 0", "0 1 0", 0.006,
                -0.01, node_id++});
    add(robot, {side + "_gripper", "", side + "_hand", side + "_finger", "0 0 -0.02 0 0 0", "1 0 0", 0.003,
                -0.01, node_id++});
  }
  return robot;
}

std::string with_left_collar(std::string robot, int joints) {
  std::string carrier = "trunk";
  for (int i = 1; i <= joints; ++i) {
    const std::string name = fmt::format("left_collar_{}", i);
    add(robot, {name, "", carrier, name + "_link", i == 1 ? "0 0.02 0.09 0 0 0" : "0 0 0 0 0 0",
                i % 2 == 0 ? "1 0 0" : "0 0 1", 0.004, 0.0, 50 + i});
    carrier = name + "_link";
  }
  const std::string parent = "<parent>trunk</parent>";
  const auto shoulder = robot.find("<joint name=\"left_shoulder_pitch\"");
  robot.replace(robot.find(parent, shoulder), parent.size(), "<parent>" + carrier + "</parent>");
  return robot;
}

std::string without_hip_yaw(std::string robot) {
  for (const std::string side : kSides) {
    cut(robot, "<joint name=\"" + side + "_hip_yaw\"", "</joint>");
    const std::string link = cut(robot, "<link name=\"" + side + "_hip_yaw_link\"", "</link>");
    const std::string begin = "<pose relative_to=\"trunk\">";
    const auto pose = link.find(begin) + begin.size();
    const std::string place = link.substr(pose, link.find("</pose>", pose) - pose);
    replace(robot, "<pose relative_to=\"" + side + "_hip_yaw_link\">0 0 0 0 0 0</pose>",
            begin + place + "</pose>");
    replace(robot, "<parent>" + side + "_hip_yaw_link</parent>", "<parent>trunk</parent>");
  }
  return robot;
}

std::string four_joints() {
  std::string robot = default_robot();
  const std::string imu = cut(robot, "<sensor name=\"imu\"", "</sensor>");
  const auto first_link = robot.find("<link name=");
  robot = robot.substr(0, first_link);
  constexpr const char* kBox =
      R"(<collision name="box"><pose>{}</pose><geometry><box><size>{}</size></box></geometry><surface>
<friction><ode><mu>0.8</mu><mu2>0.8</mu2></ode></friction>
<bounce><restitution_coefficient>0</restitution_coefficient><threshold>0.01</threshold></bounce>
<contact><ode><soft_cfm>0.0001</soft_cfm><soft_erp>0.2</soft_erp></ode></contact></surface></collision>)";
  robot += R"(<link name="trunk"><pose>0 0 0.08 0 0 0</pose>
<inertial><pose>0 0 0.03 0 0 0</pose><mass>0.3</mass>
<inertia><ixx>3e-4</ixx><iyy>3e-4</iyy><izz>3e-4</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>)" +
           fmt::format(fmt::runtime(kBox), "0 0 0.03 0 0 0", "0.06 0.08 0.06") + imu + "</link>\n";
  int node_id = 16;
  for (const std::string side : kSides) {
    const std::string y = side == "left" ? "0.035" : "-0.035";
    const Part hip{side + "_hip_yaw", "",   "trunk", side + "_leg", "0 " + y + " 0 0 0 0",
                   "0 0 1",           0.05, -0.02,   node_id++};
    const Part ankle{side + "_ankle_roll",
                     "",
                     side + "_leg",
                     side + "_foot",
                     "0 0 -0.05 0 0 0",
                     "1 0 0",
                     0.05,
                     -0.025,
                     node_id++};
    std::string foot = link_text(ankle);
    insert_before(foot, "</link>", fmt::format(fmt::runtime(kBox), "0 0 -0.025 0 0 0", "0.1 0.056 0.01"));
    robot += link_text(hip) + foot + joint_text(hip) + joint_text(ankle);
  }
  return robot + "</model></sdf>\n";
}

void write_robot(const std::filesystem::path& folder, const std::string& robot, bool walks,
                 bool fixed_upper_body) {
  std::filesystem::create_directories(folder / "motions");
  std::ofstream(folder / "robot.sdf") << robot;
  const std::filesystem::path koboshi = KOBOSHI_SOURCE_DIR "/robots/koboshi";
  std::string stand = read(koboshi / "motions/stand.yaml");
  std::string parameters = read(koboshi / "parameters.yaml");
  if (walks) {
    replace(parameters, "fixed_upper_body: 1",
            fixed_upper_body ? "fixed_upper_body: 1" : "fixed_upper_body: 0");
    std::filesystem::copy_file(koboshi / "standing.yaml", folder / "standing.yaml",
                               std::filesystem::copy_options::overwrite_existing);
  } else {
    parameters =
        "version: 1\nrobot: koboshi\nparameters:\n  lowest_supply_mV: 6000\n  highest_supply_mV: 9000\n"
        "  ramp_rate_deg_per_s: 60\n";
    stand =
        "version: 1\nrobot: koboshi\nname: stand\nposes:\n  stand: {others: zero}\n"
        "steps:\n  - {pose: stand, time_s: 1.5}\n";
  }
  std::ofstream(folder / "parameters.yaml") << parameters;
  std::ofstream(folder / "motions/stand.yaml") << stand;
}

void copy_motion(const std::filesystem::path& folder, const std::string& name) {
  const std::filesystem::path motion = std::filesystem::path("motions") / (name + ".yaml");
  std::filesystem::copy_file(KOBOSHI_SOURCE_DIR "/robots/koboshi" / motion, folder / motion);
}

}  // namespace koboshi::test
