#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/lab/session.h"
#include "cli/lab/shard_options.h"
#include "cli/options.h"
#include "lab/cluster/job_file.h"
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
  ShardArguments shards{};
};

void print_result(const lab::TrainingResult& result, const lab::LearningStudy& study,
                  const std::filesystem::path& out) {
  fmt::print("engine alone: reward {:.4f}, {:.1f} % survive\n", result.engine.reward,
             100.0 * result.engine.survived);
  fmt::print("policy of generation {}: reward {:.4f}, {:.1f} % survive\n", result.best.generation,
             result.best.reward, 100.0 * result.best.survived);
  fmt::print("{} of {} generations; results in {}\n", result.generations, study.generations, out.string());
}

// Returns the result of `train`, which is given a function that shows its progress.
template <typename Train>
lab::TrainingResult show_training(const Train& train) {
  const ProgressLine line;
  return train([&line](const lab::TrainingProgress& now) {
    line.show(
        fmt::format("generation {} of {}, stage {}: reward {:.4f}, {:.0f} % survive; validation {:.4f}, "
                    "best {:.4f} of generation {}",
                    now.generation, now.generations, now.stage, now.reward, 100.0 * now.survived,
                    now.last.reward, now.best.reward, now.best.generation));
  });
}

// Plays or merges the shards that --shard and --shards name.
void learn_in_shards(const lab::LearningStudy& study, const lab::TrainingOptions& options,
                     const ShardArguments& shards, Invocation& invocation) {
  lab::require_shards(study);
  const std::size_t count = shards.count(options.out);
  lab::keep_job(options.out, {lab::job_command(invocation.arguments), std::filesystem::current_path(), count,
                              lab::training_inputs(study, options)});
  if (shards.is_merge()) {
    print_result(lab::merge_training(study, options, count), study, options.out);
  } else if (!shards.action.empty()) {
    invocation.exit_status = show_shards(shards, lab::training_progress(study, options, count));
  } else {
    const lab::TrainingResult result = show_training([&](const lab::ShowTraining& show) {
      return lab::play_training_shard(study, options, *shards.shard, show);
    });
    fmt::print("shard {} of {}: the training has ended after {} generations\n", shards.shard->number, count,
               result.generations);
  }
}

void learn(const LearnArguments& arguments, Invocation& invocation) {
  const lab::LearningStudy study = lab::read_learning_study(
      simulation::find_input(simulation::InputKind::kLearningStudy, arguments.study));
  lab::TrainingOptions options = arguments.options;
  if (!arguments.stepper.empty())
    options.overrides.push_back({"physics.stepper", arguments.stepper, "--stepper"});
  if (!arguments.robot.empty()) options.overrides.push_back(simulation::robot_override(arguments.robot));
  if (options.out.empty()) options.out = "runs/learn" / arguments.study.stem();
  if (arguments.shards.is_used()) return learn_in_shards(study, options, arguments.shards, invocation);
  print_result(show_training([&](const lab::ShowTraining& show) { return lab::train(study, options, show); }),
               study, options.out);
}

}  // namespace

void add_learn_command(CLI::App& program, Invocation& invocation) {
  auto arguments = std::make_shared<LearnArguments>();
  CLI::App* command =
      program.add_subcommand("learn", "Train a policy that adds to the walking engine, by a study");
  command->footer(
      "An evolution strategy or proximal policy optimisation over the weights of a small network. Every "
      "network is\n"
      "quantised, and runs in the firmware, in worlds and under pushes that the study draws. The results do "
      "not\n"
      "depend on --jobs. An interrupted training resumes when it is called again. docs/reference/learn.md "
      "describes\n"
      "study and results.\n\n"
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
  add_shard_options(*command, arguments->shards);
  command->callback([arguments, &invocation] { learn(*arguments, invocation); });
}

}  // namespace koboshi::cli
