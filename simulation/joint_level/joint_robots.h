#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "simulation/batch/workers.h"
#include "simulation/joint_level/joint_robot.h"

namespace koboshi::simulation {

// Several robots of one scenario with different seeds, stepped in parallel. They share the files and no
// state: each gives the same bits as alone.
class JointRobots {
 public:
  // One robot for each seed, at least one; `threads` >= 1, of which as many as robots are used. Throws as
  // prepare_joint_level and JointRobot do.
  JointRobots(const Scenario& scenario, std::span<const std::uint64_t> seeds, std::size_t threads);

  [[nodiscard]] std::size_t size() const { return robots_.size(); }
  [[nodiscard]] JointRobot& at(std::size_t robot) { return *robots_.at(robot); }
  [[nodiscard]] const JointRobot& at(std::size_t robot) const { return *robots_.at(robot); }

  // Sets targets and advances all by this many milliseconds. `targets_rad`: by robot and joint, or empty for
  // the present ones. `observations`: by robot and number of the observation. If robots throw, the others
  // still complete their step; the exception of the first failed robot, in order, is then rethrown.
  void step(std::span<const double> targets_rad, std::size_t milliseconds, std::span<double> observations);
  void observe(std::span<double> observations) const;
  // Restarts these robots as JointRobot::reset does, each with a seed of its own, in parallel.
  struct Restart {
    std::size_t robot = 0;
    std::uint64_t seed = 0;
  };
  void reset(std::span<const Restart> restarts, std::uint64_t until_us = 0);

 private:
  std::span<double> row(std::span<double> observations, std::size_t robot) const;

  Workers workers_;
  std::vector<std::unique_ptr<JointRobot>> robots_;
};

}  // namespace koboshi::simulation
