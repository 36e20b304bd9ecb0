#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "hal/port/ankle.h"
#include "sim_board/description/description.h"
#include "sim_board/sensor/sensitivity.h"
#include "sim_board/sensor/six_axis.h"
#include "sim_board/world/foot.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Sensor of a foot. Six axes, below the joint that connects the foot to the shank, measure the wrench that
// the ground side exerts on the shank side, in the sensor's frame S about its origin: f_z > 0 when the robot
// stands on the foot. Pressure cells and a contact switch are in the sole and measure the ground's force
// normal to it, the foot's own weight included.
class AnkleSensor {
 public:
  // `robot` contains the description's joint and the foot, its child, and must outlive the sensor. Throws as
  // SixAxis does.
  AnkleSensor(const AnkleSensorDescription& description, const RobotDescription& robot,
              const SensorErrors& errors);

  // Call it once before the first physics step and after each step. `time_us` is the world's time.
  void step(const World& world, std::uint64_t time_us);
  // Only for six axes. `foot` is the state of the foot link after the step, `joint_W` the result of
  // World::joint_wrench().
  void step(const BodyState& foot, const Wrench& joint_W, std::uint64_t time_us);
  // Takes the oldest sample that has arrived by `now_us`. Returns false and leaves `sample` unchanged if
  // there is none.
  [[nodiscard]] bool poll(std::uint64_t now_us, hal::AnkleSample& sample);
  hal::AnkleKind kind() const { return description_.kind; }
  // True wrench of the last step: without errors, filter and delay. Only for six axes.
  const Wrench& wrench_S() const { return wrench_S_; }
  // A stopped sensor delivers no samples.
  void set_running(bool running) { channels_.set_running(running); }

 private:
  void step_sole(const World& world, std::uint64_t time_us);

  AnkleSensorDescription description_;
  Foot sole_;
  const RobotDescription* robot_;
  bool closed_ = false;  // the switch
  int joint_;
  int foot_;
  Eigen::Matrix3d R_SL_;
  Eigen::Vector3d p_SJ_S_;  // from the sensor to the joint's anchor, both fixed in the foot
  AnkleCrosstalk crosstalk_;
  SixAxis channels_;
  Eigen::Matrix3d R_WL_before_ = Eigen::Matrix3d::Identity();  // the foot's axes at the beginning of the step
  Wrench wrench_S_;
  bool started_ = false;
};

}  // namespace koboshi::sim_board
