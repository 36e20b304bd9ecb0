#pragma once

#include <filesystem>
#include <string>

namespace koboshi::test {

// Robots that differ from the default one in their sensors and bodies, as texts of robot.sdf without meshes.
// They keep its servos, legs and parameters.

// The default robot.
std::string default_robot();

// Replaces the sensor in both feet.
std::string with_pressure_cells(std::string robot);
std::string with_contact_switches(std::string robot);
std::string without_ankle_sensors(std::string robot);

// Moves the inertial unit to another link, with this pose there ("x y z roll pitch yaw", m and rad).
std::string with_inertial_unit(std::string robot, const std::string& link, const std::string& pose);

// Adds three waist joints between the pelvis (the link trunk) and a chest that carries arms and head: 23
// joints.
std::string with_waist(std::string robot);
// Adds shoulder yaw, two wrist joints and a gripper to each arm: eight joints more.
std::string with_longer_arms(std::string robot);

// Adds joints between the trunk and the left shoulder.
std::string with_left_collar(std::string robot, int joints);

// Takes the hip yaw out of both legs and bolts its bracket to the trunk: 18 joints.
std::string without_hip_yaw(std::string robot);

// Four joints: two legs of hip yaw and ankle roll, and nothing else.
std::string four_joints();

// Writes a robot that `robot: FOLDER/robot.sdf` in a scenario loads, with the motion `stand` and, where it
// has legs that walk, the parameters of the default robot; `fixed_upper_body` is that parameter.
void write_robot(const std::filesystem::path& folder, const std::string& robot, bool walks,
                 bool fixed_upper_body);
// Adds a motion of the default robot to such a robot.
void copy_motion(const std::filesystem::path& folder, const std::string& name);

}  // namespace koboshi::test
