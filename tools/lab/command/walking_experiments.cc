#include "tools/lab/command/walking_experiments.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <memory>

#include "tools/lab/catalogue/push_recovery.h"
#include "tools/lab/catalogue/terrain.h"
#include "tools/lab/catalogue/walking_speed.h"
#include "tools/lab/command/scenario_experiment.h"

namespace koboshi::tools {
namespace {

// --- walking-speed

struct SpeedArguments : ScenarioArguments<WalkingSpeedOptions> {
  std::array<std::vector<double>, 4> commands{{{0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4},
                                               {0.05, 0.1, 0.15, 0.2, 0.25, 0.3},
                                               {0.03, 0.06, 0.09, 0.12, 0.15, 0.18},
                                               {0.25, 0.5, 0.75, 1.0, 1.25, 1.5}}};
  std::vector<std::string> only = SpeedLadder::names();
};

void play_walking_speed(SpeedArguments arguments, const std::string& command_line) {
  settle(arguments, "walking-speed");
  for (std::size_t i = 0; i < arguments.commands.size(); ++i) {
    if (std::ranges::find(arguments.only, SpeedLadder::names()[i]) == arguments.only.end()) continue;
    std::ranges::sort(arguments.commands[i]);
    arguments.options.ladders.push_back(
        {.direction = static_cast<SpeedLadder::Direction>(i), .commands = arguments.commands[i]});
  }
  const WalkingSpeed speed = make_walking_speed(arguments.options);
  const ClimbResult result = play_with_progress(arguments.common, [&](const ExperimentOptions& how) {
    return climb(speed.experiment, speed.ladders, how);
  });
  const Conclusions conclusions = walking_speed_conclusions(speed, result);
  leave_results(result.experiment, result.result, arguments.common, conclusions);
  write_page(result.experiment, result.result, arguments.common, "How fast it walks", command_line,
             draw_figure(ladder_figure("Walking speed: what is not sustained", speed.experiment,
                                       speed.ladders, result),
                         arguments.common),
             conclusions);
}

void add_walking_speed(CLI::App& parent, const std::string& command_line) {
  auto arguments = std::make_shared<SpeedArguments>();
  CLI::App* command = add_command(parent, "walking-speed",
                                  "The highest speeds that are sustained over 10 body heights", *arguments);
  command->footer(
      std::string(
          "The command is raised in each direction until more than 5 of 100 seeds fall, or make less than a "
          "quarter\nof it. Odd seeds go to the left, even ones to the right. ") +
      kWorlds +
      "\nExamples:\n"
      "  koboshi experiment walking-speed --seeds 20 --stepper mujoco\n"
      "  koboshi experiment walking-speed --only forward --forward 0.2,0.22,0.24 --json speed.json\n");
  for (std::size_t i = 0; i < SpeedLadder::names().size(); ++i) {
    const std::string& name = SpeedLadder::names()[i];
    command
        ->add_option("--" + name, arguments->commands[i],
                     std::string("Commands in this direction, ") + (name == "turn" ? "rad/s" : "m/s"))
        ->delimiter(',')
        ->check(CLI::Range(0.001, 3.0))
        ->capture_default_str();
  }
  command->add_option("--only", arguments->only, "Some of the directions")
      ->delimiter(',')
      ->check(CLI::IsMember(SpeedLadder::names()));
  command->callback([arguments, command_line] { play_walking_speed(*arguments, command_line); });
}

// --- push-recovery

void play_push_recovery(ScenarioArguments<PushRecoveryOptions> arguments, const std::string& command_line) {
  settle(arguments, "push-recovery");
  const Experiment experiment = make_push_recovery(arguments.options);
  const ExperimentResult result = play_with_progress(
      arguments.common, [&](const ExperimentOptions& how) { return play_experiment(experiment, how); });
  const std::vector<SurvivedPush> pushes = survived_pushes(arguments.options, experiment, result);
  const Conclusions conclusions = push_recovery_conclusions(pushes);
  leave_results(experiment, result, arguments.common, conclusions);
  write_page(experiment, result, arguments.common, "What pushes it survives", command_line,
             draw_figure(polar_figure(pushes), arguments.common), conclusions);
}

void add_push_recovery(CLI::App& parent, const std::string& command_line) {
  auto arguments = std::make_shared<ScenarioArguments<PushRecoveryOptions>>();
  PushRecoveryOptions& options = arguments->options;
  CLI::App* command =
      add_command(parent, "push-recovery",
                  "The largest pushes that are survived, standing and walking in place", *arguments);
  command->footer(
      std::string("A half sine of 0.1 s at the trunk. In each world and direction the largest impulse is "
                  "found by bisection;\n"
                  "told is what 95 of 100 seeds survive, with a 95 % interval, and walking, in the phase of "
                  "the step in\n"
                  "which that is least. ") +
      kWorlds +
      "\nExamples:\n"
      "  koboshi experiment push-recovery --seeds 20 --stepper mujoco\n"
      "  koboshi experiment push-recovery --directions 4 --ablate gyro,capture --json push.json\n");
  command->add_option("--only", options.states, "Some of the states: standing, walking")
      ->delimiter(',')
      ->check(CLI::IsMember(pushed_states()));
  std::vector<std::string> names;
  for (const Feedback& feedback : feedbacks()) names.push_back(feedback.name);
  command->add_option("--ablate", options.ablate, "Also without these feedbacks, one at a time")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  command->add_option("--directions", options.directions, "Of the pushes, all around")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command
      ->add_option("--highest", options.highest_N_s_per_kg, "Impulses are less, N s for each kg of the robot")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  command->add_option("--halvings", options.halvings, "Of the range of impulses, in the bisection")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  command->add_option("--phase-bins", options.phase_bins, "Into which a cycle of two steps is divided")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->callback([arguments, command_line] { play_push_recovery(*arguments, command_line); });
}

// --- terrain

void play_terrain(ScenarioArguments<TerrainOptions> arguments, const std::string& command_line) {
  settle(arguments, "terrain");
  const Terrain terrain = make_terrain(arguments.options);
  const ClimbResult result = play_with_progress(arguments.common, [&](const ExperimentOptions& how) {
    return climb(terrain.experiment, terrain.ladders, how);
  });
  const Conclusions conclusions = terrain_conclusions(terrain, result);
  leave_results(result.experiment, result.result, arguments.common, conclusions);
  write_page(
      result.experiment, result.result, arguments.common, "What ground it walks over", command_line,
      draw_figure(ladder_figure("Terrain: what is not passed", terrain.experiment, terrain.ladders, result),
                  arguments.common),
      conclusions);
}

void add_terrain(CLI::App& parent, const std::string& command_line) {
  auto arguments = std::make_shared<ScenarioArguments<TerrainOptions>>();
  CLI::App* command = add_command(
      parent, "terrain", "Steps, slopes, slippery patches and bumps that are walked over", *arguments);
  command->footer(std::string("Each kind of ground is made harder until more than 5 of 100 seeds fall, or "
                              "need more than twice the time. ") +
                  kWorlds +
                  "\nExample:\n"
                  "  koboshi experiment terrain --seeds 20 --stepper mujoco --budget-s 600\n");
  command->add_option("--speed", arguments->options.speed_m_per_s, "Commanded, m/s")
      ->check(CLI::Range(0.01, 3.0))
      ->capture_default_str();
  command->add_option("--way", arguments->options.way_m, "That must be made, m")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  command->callback([arguments, command_line] { play_terrain(*arguments, command_line); });
}

}  // namespace

void add_walking_experiments(CLI::App& experiment, const std::string& command_line) {
  add_walking_speed(experiment, command_line);
  add_push_recovery(experiment, command_line);
  add_terrain(experiment, command_line);
}

}  // namespace koboshi::tools
