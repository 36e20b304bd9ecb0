#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/lab/session.h"
#include "cli/options.h"
#include "lab/learn/training.h"
#include "simulation/scenario/paths.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::cli {
namespace {

struct LearnArguments {
  std::filesystem::path study;
  lab::TrainingOptions options;
  std::string stepper;
  std::string robot;
};

void learn(const LearnArguments& arguments) {
  const lab::LearningStudy study = lab::read_learning_study(
      simulation::find_input(simulation::InputKind::kLearningStudy, arguments.study));
  lab::TrainingOptions options = arguments.options;
  if (!arguments.stepper.empty())
    options.overrides.push_back({"physics.stepper", arguments.stepper, "--stepper"});
  if (!arguments.robot.empty()) options.overrides.push_back(simulation::robot_override(arguments.robot));
  if (options.out.empty()) options.out = "runs/learn" / arguments.study.stem();
  const lab::TrainingResult result = [&] {
    const ProgressLine line;
    return lab::train(study, options, [&](const lab::TrainingProgress& now) {
      line.show(
          fmt::format("generation {} of {}, stage {}: reward {:.4f}, {:.0f} % survive; validation {:.4f}, "
                      "best {:.4f} of generation {}",
                      now.generation, now.generations, now.stage, now.reward, 100.0 * now.survived,
                      now.last.reward, now.best.reward, now.best.generation));
    });
  }();
  fmt::print("engine alone: reward {:.4f}, {:.1f} % survive\n", result.engine.reward,
             100.0 * result.engine.survived);
  fmt::print("policy of generation {}: reward {:.4f}, {:.1f} % survive\n", result.best.generation,
             result.best.reward, 100.0 * result.best.survived);
  fmt::print("{} of {} generations; results in {}\n", result.generations, study.generations,
             options.out.string());
}

}  // namespace

void add_learn_command(CLI::App& program, Invocation&) {
  auto arguments = std::make_shared<LearnArguments>();
  CLI::App* command =
      program.add_subcommand("learn", "Train a policy that adds to the walking engine, by a study");
  command->footer(
      "An evolution strategy over the weights of a small network. Every candidate is quantised, and runs in "
      "the\n"
      "firmware, in worlds and under pushes that the study draws. The results do not depend on --jobs. An\n"
      "interrupted training resumes when it is called again. docs/reference/learn.md describes study and "
      "results.\n\n"
      "Example:\n"
      "  koboshi learn residual --until 40 --out runs/learn/residual\n");
  command->add_option("STUDY", arguments->study, "The learning study's file or name")->required();
  command
      ->add_option("--until", arguments->options.until,
                   "Stops after this generation; a later call resumes (default: all of the study)")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000}));
  add_stepper_option(*command, arguments->stepper, "Stepper of the physics instead of the study's");
  add_robot_option(*command, arguments->robot);
  add_jobs_option(*command, arguments->options.jobs);
  command->add_option("--out", arguments->options.out,
                      "Folder of the results (default: runs/learn/ and the study's name)");
  command->callback([arguments] { learn(*arguments); });
}

}  // namespace koboshi::cli
