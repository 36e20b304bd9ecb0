#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/assembly/simulation.h"
#include "simulation/observe/run_recorder.h"

namespace koboshi::lab {

// The history of a robot that falls and gets up, as the firmware reports it and as the ground feels it.
struct FallHistory {
  std::optional<double> predicted_s{};  // when the firmware predicted the first fall
  std::optional<double> touched_s{};    // a link other than a foot first touched the ground
  std::optional<double>
      impact_m_per_s{};  // downward speed of the first part of trunk or head that touched it
  int falls = 0;
  int attempts = 0;                                  // to get up
  int stands = 0;                                    // after such an attempt
  behaviour::Reason lay = behaviour::Reason::kNone;  // the pose when it first began to turn over or to rise
  // Peaks of the servos since the first attempt: the torque of gears and of motors. A link that strikes
  // the ground stops its joint within a step or two; the gears, which are rigid here, then stop the rotor,
  // and bear its inertia times the change of speed, divided by the time.
  double peak_torque_Nm = 0.0;
  double peak_motor_torque_Nm = 0.0;
  double peak_winding_C = 0.0;
};

class FallObserver {
 public:
  // Call it after each millisecond.
  void observe(const simulation::Simulation& simulation, const simulation::RunRecorder& recorder);

  const FallHistory& history() const { return history_; }

 private:
  struct Part {  // trunk or head
    int link = -1;
    Eigen::Vector3d v_WCom_W = Eigen::Vector3d::Zero();  // before the last step
    Eigen::Vector3d w_WL_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_WCom_W = Eigen::Vector3d::Zero();
  };

  void begin(const simulation::Simulation& simulation);
  void follow_state(behaviour::State state, behaviour::Reason reason, double time_s);
  void look_at_ground(const sim_board::World& world, double time_s);
  void look_at_servos(const sim_board::SimBoard& board);
  void keep_parts(const sim_board::RobotDescription& robot, const sim_board::World& world);

  std::vector<bool> is_foot_;  // by link
  std::vector<Part> parts_;
  behaviour::State state_ = behaviour::State::kBoot;
  FallHistory history_;
};

}  // namespace koboshi::lab
