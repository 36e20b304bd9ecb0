// An external behaviour on top of the firmware: the robot walks a given distance and stops.

#include <cstdio>
#include <vector>

#include "simulation/assembly/operator_input.h"
#include "simulation/observe/watched_simulation.h"
#include "simulation/scenario/reader.h"

namespace {

using koboshi::simulation::WatchedSimulation;

constexpr double kFarEnough_m = 0.2;
constexpr std::uint64_t kPatience_us = 20'000'000;

// Walks to the goal. Returns false if the robot does not reach it in time.
bool walk_there(WatchedSimulation& robot) {
  command(robot.simulation(), "walk: {forward_m_per_s: 0.15}");
  while (robot.recorder().truth().p_WB_W.x() < kFarEnough_m) {
    robot.step(100);
    if (robot.now_us() > kPatience_us) return false;
  }
  command(robot.simulation(), "stop: true");
  robot.step(4000);
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  const std::vector<koboshi::Override> overrides{{"physics.stepper", "lumped"},
                                                 {"commands", "[{at_s: 2, enable: true}]"}};
  WatchedSimulation robot(koboshi::simulation::read_scenario(arguments[1], overrides));
  robot.step(4500);
  const bool there = walk_there(robot);
  std::printf("%s\n", robot.recorder().events().verdict().c_str());
  return there && robot.recorder().events().stands() ? 0 : 1;
}
