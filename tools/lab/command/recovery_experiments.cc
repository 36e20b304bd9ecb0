#include "tools/lab/command/recovery_experiments.h"

#include <memory>

#include "tools/lab/catalogue/contacts.h"
#include "tools/lab/catalogue/fall_detection.h"
#include "tools/lab/catalogue/marathon.h"
#include "tools/lab/catalogue/stand_up.h"
#include "tools/lab/command/scenario_experiment.h"

namespace koboshi::tools {
namespace {

constexpr const char* kScenario = "scenarios/get_up.yaml";

// Plays it, and leaves what it comes to.
template <typename Conclude>
void play(const Experiment& experiment, const ExperimentArguments& arguments, const std::string& title,
          const std::string& command_line, const Conclude& conclude) {
  const ExperimentResult result = play_with_progress(
      arguments, [&](const ExperimentOptions& how) { return play_experiment(experiment, how); });
  const Conclusions conclusions = conclude(result);
  leave_results(experiment, result, arguments, conclusions);
  write_page(experiment, result, arguments, title, command_line, {}, conclusions);
}

void add_stand_up(CLI::App& parent, const std::string& command_line) {
  auto arguments = std::make_shared<ScenarioArguments<StandUpOptions>>();
  StandUpOptions& options = arguments->options;
  options.scenario = kScenario;
  CLI::App* command =
      add_command(parent, "stand-up", "Whether it gets up from however it was dropped", *arguments);
  command->footer(
      std::string("The robot is dropped limp with a random attitude and random joint angles, settles, "
                  "and is told to get up.\n") +
      kWorlds + "\nExample:\n  koboshi experiment stand-up --seeds 200 --stepper mujoco\n");
  command->add_option("--drop", options.drop_m, "From this height, m")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--joint-share", options.joint_share, "Of each joint's range, in which its angle is drawn")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->callback([arguments, command_line] {
    settle(*arguments, "stand-up");
    const Experiment experiment = make_stand_up(arguments->options);
    play(experiment, arguments->common, "How it gets up", command_line,
         [&](const ExperimentResult& result) { return stand_up_conclusions(experiment, result); });
  });
}

void add_fall_detection(CLI::App& parent, const std::string& command_line) {
  auto arguments = std::make_shared<ScenarioArguments<FallDetectionOptions>>();
  FallDetectionOptions& options = arguments->options;
  options.scenario = kScenario;
  CLI::App* command =
      add_command(parent, "fall-detection",
                  "How long before the ground it foresees a fall, and how often in vain", *arguments);
  command->footer(
      std::string("Pushes of 1.2 to 2 times what is survived, from all sides; bars in the way, slippery "
                  "floors, a push that lasts,\ndrives that fail; and walks with pushes that are "
                  "survived.\n") +
      kWorlds +
      "\nExample:\n  koboshi experiment fall-detection --seeds 60 --stepper mujoco --roc 0.8,1.25\n");
  command->add_option("--standing", options.standing_N_s_per_kg, "What is survived standing, N s/kg")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  command->add_option("--walking", options.walking_N_s_per_kg, "What is survived walking, N s/kg")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  command->add_option("--survivable", options.survivable_N_s_per_kg, "The hardest push of the walks, N s/kg")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command->add_option("--walk", options.walk_s, "How long each walk lasts, s")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  command->add_option("--roc", options.scales, "Also with thresholds that are so many times as large")
      ->delimiter(',')
      ->check(CLI::Range(0.1, 3.5));
  command->callback([arguments, command_line] {
    settle(*arguments, "fall-detection");
    const Experiment experiment = make_fall_detection(arguments->options);
    play(experiment, arguments->common, "How it foresees falls", command_line,
         [&](const ExperimentResult& result) {
           return fall_detection_conclusions(arguments->options, experiment, result);
         });
  });
}

void add_marathon(CLI::App& parent, const std::string& command_line) {
  auto arguments = std::make_shared<ScenarioArguments<MarathonOptions>>();
  MarathonOptions& options = arguments->options;
  options.scenario = kScenario;
  options.seeds = 10;
  CLI::App* command = add_command(parent, "marathon", "An hour of random commands and pushes", *arguments);
  command->footer(std::string("Nobody helps it up.\n") + kWorlds +
                  "\nExample:\n  koboshi experiment marathon --stepper mujoco --hours 0.1\n");
  command->add_option("--hours", options.hours, "How long")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  command->add_option("--highest", options.highest_N_s_per_kg, "Of the pushes, N s/kg")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command->callback([arguments, command_line] {
    settle(*arguments, "marathon");
    const Experiment experiment = make_marathon(arguments->options);
    play(experiment, arguments->common, "A marathon", command_line,
         [&](const ExperimentResult& result) { return marathon_conclusions(experiment, result); });
  });
}

void add_contacts(CLI::App& parent, const std::string& command_line) {
  auto arguments = std::make_shared<ScenarioArguments<ContactsOptions>>();
  arguments->options.scenario = kScenario;
  CLI::App* command = add_command(
      parent, "contacts", "Whether the simulated contacts hold in falls and in getting up", *arguments);
  command->footer(
      std::string("The robot falls because a drive fails, or because it is pushed, and gets up. The "
                  "table shows the deepest contact\nthat closes without a force, steps in which sliding "
                  "contacts did not settle, and how far links overlap.\n") +
      kWorlds + "\nExample:\n  koboshi experiment contacts --seeds 100 --stepper mujoco\n");
  command->callback([arguments, command_line] {
    settle(*arguments, "contacts");
    const Experiment experiment = make_contacts(arguments->options);
    play(experiment, arguments->common, "Contacts in falls", command_line,
         [&](const ExperimentResult& result) { return contacts_conclusions(arguments->options, result); });
  });
}

}  // namespace

void add_recovery_experiments(CLI::App& experiment, const std::string& command_line) {
  add_stand_up(experiment, command_line);
  add_fall_detection(experiment, command_line);
  add_marathon(experiment, command_line);
  add_contacts(experiment, command_line);
}

}  // namespace koboshi::tools
