#pragma once

#include <string>

#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"
#include "tools/import/servo/servo_catalogue.h"

namespace koboshi::tools {

// The answer to the question `servo` for drives as strong as the source says.
inline constexpr const char* kSourceServo = "source";

// Returns the sum of all links.
[[nodiscard]] double mass_of(const ImportedRobot& robot);

// Adds servo types with the torque, the speed, the rotor inertia and the friction that the source gives for
// each joint, and returns the joint's type: "drive_45" for 45 N m. What the source leaves out is that of the
// default robot's servo, scaled by dynamic similarity to this robot's mass and legs; so is a torque beyond
// what any such robot needs, which is a placeholder. Lines of `report` say so. The robot must be aligned.
class SourceServos {
 public:
  SourceServos(const ImportedRobot& robot, ServoCatalogue& catalogue, ImportReport& report);

  [[nodiscard]] std::string type_of(const ImportedJoint& joint);

 private:
  ServoCatalogue& catalogue_;
  ImportReport& report_;
  double leg_m_ = 0.0;
  double similar_torque_Nm_ = 0.0;
  double similar_speed_rad_per_s_ = 0.0;
};

}  // namespace koboshi::tools
