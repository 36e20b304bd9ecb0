#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/simulation.h"

namespace koboshi::tools {

// What happens to a robot that falls and gets up: what the firmware says of it, and what the ground feels.
class FallObserver {
 public:
  // After each millisecond.
  void observe(const simulation::Simulation& simulation, const simulation::RunRecorder& recorder);

  // When the firmware foresaw the first fall.
  std::optional<double> foreseen_s() const { return foreseen_s_; }
  // When a link other than a foot first touched the ground.
  std::optional<double> touched_s() const { return touched_s_; }
  // How fast the first part of trunk or head came down that touched the ground.
  std::optional<double> impact_m_per_s() const { return impact_m_per_s_; }
  int falls() const { return falls_; }
  int attempts() const { return attempts_; }  // to get up
  int stands() const { return stands_; }      // after such an attempt
  // How it lay when it first began to turn over or to rise.
  behaviour::Reason lay() const { return lay_; }
  // Of the servos, since it lay: what the gears bear, and what the motors make of it. A link that strikes the
  // ground stops its joint within a step or two; the gears, which are rigid here, then stop the rotor, and
  // bear its inertia times the change of speed, divided by the time.
  double peak_torque_Nm() const { return peak_torque_Nm_; }
  double peak_motor_torque_Nm() const { return peak_motor_torque_Nm_; }
  double peak_winding_C() const { return peak_winding_C_; }

 private:
  struct Part {  // trunk or head
    int link = -1;
    Eigen::Vector3d v_WCom_W = Eigen::Vector3d::Zero();  // before the last step
    Eigen::Vector3d w_WL_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_WCom_W = Eigen::Vector3d::Zero();
  };

  void begin(const simulation::Simulation& simulation);
  void follow_state(behaviour::State state, behaviour::Reason reason, double time_s);
  void look_at_ground(const sim::World& world, double time_s);
  void look_at_servos(const sim::SimBoard& board);
  void keep_parts(const sim::RobotDescription& robot, const sim::World& world);

  std::vector<bool> is_foot_;  // by link
  std::vector<Part> parts_;
  behaviour::State state_ = behaviour::State::kBoot;
  std::optional<double> foreseen_s_;
  std::optional<double> touched_s_;
  std::optional<double> impact_m_per_s_;
  int falls_ = 0;
  int attempts_ = 0;
  int stands_ = 0;
  behaviour::Reason lay_ = behaviour::Reason::kNone;
  double peak_torque_Nm_ = 0.0;
  double peak_motor_torque_Nm_ = 0.0;
  double peak_winding_C_ = 0.0;
};

}  // namespace koboshi::tools
