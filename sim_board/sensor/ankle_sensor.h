#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "hal/port/ankle.h"
#include "sim_board/robot/description.h"
#include "sim_board/sensor/ankle_crosstalk.h"
#include "sim_board/sensor/six_axis.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// A six-axis force/torque sensor in a foot link, fed by what crosses the joint above it: in the sensor's
// frame S, about its origin, the wrench that the ground side exerts on the shank side. A robot that stands on
// the foot reads f_z > 0.
class AnkleSensor {
 public:
  // `robot` has the joint of the description and its child, the foot. Throws as SixAxis does.
  AnkleSensor(const AnkleSensorDescription& description, const RobotDescription& robot,
              const SensorErrors& errors);

  // Once before the first physics step and then after each. `time_us` is the world's time.
  void step(const World& world, std::uint64_t time_us);
  // `foot` is the state of the foot link after the step, `joint_W` what World::joint_wrench tells of it.
  void step(const BodyState& foot, const Wrench& joint_W, std::uint64_t time_us);
  // Takes the oldest sample that has arrived by `now_us`. False, and `sample` untouched, when there is none.
  [[nodiscard]] bool poll(std::uint64_t now_us, hal::AnkleSample& sample);
  // The wrench itself in the last step: neither filtered nor delayed, without any error.
  const Wrench& wrench_S() const { return wrench_S_; }
  // A stopped sensor delivers nothing.
  void set_running(bool running) { channels_.set_running(running); }

 private:
  int joint_;
  int foot_;
  Eigen::Matrix3d R_SL_;
  Eigen::Vector3d p_SJ_S_;  // from the sensor to the joint's anchor; both are fixed in the foot
  AnkleCrosstalk crosstalk_;
  SixAxis channels_;
  Eigen::Matrix3d R_WL_before_ = Eigen::Matrix3d::Identity();  // the foot's axes when the last step began
  Wrench wrench_S_;
  bool started_ = false;
};

}  // namespace koboshi::sim
