#include "simulation/joint_level/joint_robots.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace koboshi::simulation {

JointRobots::JointRobots(const Scenario& scenario, std::span<const std::uint64_t> seeds, std::size_t threads)
    : workers_(std::min(threads, std::max<std::size_t>(seeds.size(), 1))), robots_(seeds.size()) {
  if (seeds.empty()) throw std::invalid_argument("found no seed, expected one for each robot");
  if (threads == 0) throw std::invalid_argument("found 0 threads, expected at least 1");
  const auto prepared = prepare_joint_level(scenario);
  workers_.run(seeds.size(), [&](std::size_t robot) {
    robots_[robot] = std::make_unique<JointRobot>(prepared, seeds[robot]);
  });
}

std::span<double> JointRobots::row(std::span<double> observations, std::size_t robot) const {
  const std::size_t size = robots_.front()->observation_size();
  return observations.subspan(robot * size, size);
}

void JointRobots::step(std::span<const double> targets_rad, std::size_t milliseconds,
                       std::span<double> observations) {
  const std::size_t joints = robots_.front()->robot().joints.size();
  if (!targets_rad.empty() && targets_rad.size() != robots_.size() * joints)
    throw std::invalid_argument(fmt::format("found {} targets, expected {} robots by {} joints",
                                            targets_rad.size(), robots_.size(), joints));
  // All are checked before any robot moves.
  if (!targets_rad.empty()) {
    for (std::size_t robot = 0; robot < robots_.size(); ++robot)
      robots_[robot]->set_targets(targets_rad.subspan(robot * joints, joints));
  }
  workers_.run(robots_.size(), [&](std::size_t robot) {
    robots_[robot]->step(milliseconds);
    robots_[robot]->observe(row(observations, robot));
  });
}

void JointRobots::observe(std::span<double> observations) const {
  for (std::size_t robot = 0; robot < robots_.size(); ++robot)
    robots_[robot]->observe(row(observations, robot));
}

void JointRobots::reset(std::span<const Restart> restarts, std::uint64_t until_us) {
  workers_.run(restarts.size(),
               [&](std::size_t i) { robots_.at(restarts[i].robot)->reset(restarts[i].seed, until_us); });
}

}  // namespace koboshi::simulation
