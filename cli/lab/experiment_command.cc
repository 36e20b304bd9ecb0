#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "base/file/standard_streams.h"
#include "cli/commands.h"
#include "cli/lab/session.h"
#include "cli/lab/tune_gait_command.h"
#include "lab/catalogue/contacts.h"
#include "lab/catalogue/fall_detection.h"
#include "lab/catalogue/loop.h"
#include "lab/catalogue/marathon.h"
#include "lab/catalogue/push_recovery.h"
#include "lab/catalogue/robustness.h"
#include "lab/catalogue/stand_up.h"
#include "lab/catalogue/terrain.h"
#include "lab/catalogue/walking_speed.h"
#include "lab/learn/comparison.h"
#include "simulation/disturbance/world_ranges.h"
#include "simulation/scenario/paths.h"
#include "tools/run/run.h"

namespace koboshi::cli {
namespace {

constexpr const char* kGetUp = "scenarios/get_up.yaml";
constexpr const char* kWorlds =
    "Every seed draws a world of its own within the ranges of --world (docs/reference/worlds.md), and the\n"
    "sensors' noise and bias.\n";

// An entry of the table of experiments below.
template <typename Options>
struct Entry {
  const char* name;
  const char* description;
  std::string footer;  // above the worlds
  std::vector<std::string> examples;
  lab::Experiment (*make)(const Options&);
  void (*add_options)(CLI::App&, Options&, SessionOptions&) = nullptr;
  Options options{};
  const char* worlds = kWorlds;
  std::string (*draw_figures)(const Options&, const SessionOptions&) = nullptr;
};

template <typename Options>
void add(CLI::App& parent, Invocation& invocation, Entry<Options> given) {
  struct Arguments {
    Entry<Options> entry;
    SessionOptions session{};
  };
  const auto arguments = std::make_shared<Arguments>(Arguments{std::move(given)});
  Entry<Options>& entry = arguments->entry;
  CLI::App* command = parent.add_subcommand(entry.name, entry.description);
  command->footer(fmt::format("{}{}\nExample{}:\n  koboshi experiment {}\n", entry.footer, entry.worlds,
                              entry.examples.size() > 1 ? "s" : "",
                              fmt::join(entry.examples, "\n  koboshi experiment ")));
  command->add_option("SCENARIO", entry.options.scenario, "File or name of a scenario that walks")
      ->capture_default_str();
  add_session_options(*command, entry.options, arguments->session);
  if (entry.add_options) entry.add_options(*command, entry.options, arguments->session);
  command->callback([arguments, &invocation] {
    Options& options = arguments->entry.options;
    options.scenario = simulation::find_input(simulation::InputKind::kScenario, options.scenario);
    options.overrides = overrides_of(arguments->session);
    const auto draw = arguments->entry.draw_figures;
    const DrawFigures draw_figures = [&](const SessionOptions& session) {
      return draw ? draw(options, session) : std::string();
    };
    conduct(arguments->entry.make(options), arguments->session, invocation, draw_figures);
  });
}

// --- gyro-feedback

void add_gyro_feedback_options(CLI::App& command, lab::GyroFeedbackOptions& options,
                               SessionOptions& session) {
  command.add_option("--duration", session.duration, "Simulated seconds of a trial");
  command.add_option("--points", options.points, "Points of a cycle of two steps: 4,8,16")
      ->delimiter(',')
      ->check(CLI::Range(2, 64));
  const auto set_feedback = [&options](const std::string& feedback) {
    if (feedback != "both") options.feedback = {feedback == "on"};
  };
  command.add_option_function<std::string>("--feedback", set_feedback, "off, on or both")
      ->check(CLI::IsMember({"off", "on", "both"}))
      ->default_str("both");
  add_disturbance_options(command, options);
  command.add_option("--gaits", options.gaits,
                     "Folder with a gait for each cell: 8-on.yaml, ... (default: the scenario's in all)");
  add_number(command, "--falls-within", options.falls_within, 0.0, 1.0,
             "End a cell early when its share of falls is known to within +- this");
}

// The paper's figure 8, off beside on: the first seed's walks of 8 points (or of the first number), each with
// everything that `koboshi run` leaves.
std::string draw_walks(const lab::GyroFeedbackOptions& options, const SessionOptions& session) {
  const bool has_eight = std::ranges::find(options.points, 8) != options.points.end();
  const int points = has_eight ? 8 : options.points.front();
  Row names;
  Row images;
  for (const bool feedback : options.feedback) {
    const simulation::Scenario scenario =
        lab::seeded_walk(lab::gyro_feedback_scenario(options, points, feedback), options, options.first_seed);
    const std::string name = lab::gyro_feedback_cell(points, feedback);
    const std::filesystem::path folder = session.out / name;
    const tools::RunResult walk = tools::run({.scenario = scenario, .out = folder}, {});
    if (walk.plot_warning) print_error("koboshi: {}\n", *walk.plot_warning);
    if (session.page.empty() || !std::filesystem::exists(folder / "zmp.png")) continue;
    const std::string image = session.section + "-" + name + ".png";
    std::filesystem::copy_file(folder / "zmp.png", session.page.parent_path() / image,
                               std::filesystem::copy_options::overwrite_existing);
    names.push_back(fmt::format("{} points, feedback {}", points, feedback ? "on" : "off"));
    images.push_back(fmt::format("![ZMP trace over the feet]({})", image));
  }
  return names.empty() ? std::string() : table_text(names, {images}, TableStyle::kMarkdown);
}

// --- options of the others

void add_walking_speed_options(CLI::App& command, lab::WalkingSpeedOptions& options, SessionOptions&) {
  for (lab::SpeedLadder& ladder : options.ladders) {
    const std::string& name = lab::SpeedLadder::names().at(static_cast<std::size_t>(ladder.direction));
    command
        .add_option("--" + name, ladder.commands,
                    std::string("Commands in this direction, ") + (name == "turn" ? "rad/s" : "m/s"))
        ->delimiter(',')
        ->check(CLI::Range(0.001, 3.0))
        ->capture_default_str();
  }
  command.add_option("--only", options.only, "Some of the directions")
      ->delimiter(',')
      ->check(CLI::IsMember(lab::SpeedLadder::names()));
}

void add_push_recovery_options(CLI::App& command, lab::PushRecoveryOptions& options, SessionOptions&) {
  command.add_option("--only", options.states, "Some of the states: standing, walking")
      ->delimiter(',')
      ->check(CLI::IsMember(lab::pushed_states()));
  std::vector<std::string> names;
  for (const lab::Feedback& feedback : lab::feedbacks()) names.push_back(feedback.name);
  command.add_option("--ablate", options.ablate, "Also without these feedbacks, one at a time")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  add_number(command, "--directions", options.directions, 1, 64, "Directions of the pushes, all around");
  add_number(command, "--highest", options.highest_N_s_per_kg, 0.01, 10.0,
             "Upper limit of the impulses, N s for each kg of the robot");
  add_number(command, "--halvings", options.halvings, 1, 16, "Halvings of the range in the bisection");
  add_number(command, "--phase-bins", options.phase_bins, 1, 64, "Parts of a cycle of two steps");
}

void add_terrain_options(CLI::App& command, lab::TerrainOptions& options, SessionOptions&) {
  add_number(command, "--speed", options.speed_m_per_s, 0.01, 3.0, "Commanded speed, m/s");
  add_number(command, "--distance", options.distance_m, 0.1, 10.0, "Distance to walk, m");
  command.add_option("--only", options.kinds, "Some of the kinds of ground")
      ->delimiter(',')
      ->check(CLI::IsMember(lab::TerrainOptions::all_kinds()));
  command
      .add_option("--levels", options.levels, "Levels of the kinds in --only instead of their own, rising")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1e3));
}

void add_stand_up_options(CLI::App& command, lab::StandUpOptions& options, SessionOptions&) {
  add_number(command, "--drop", options.drop_m, 0.0, 1.0, "Height of the drop, m");
  add_number(command, "--joint-share", options.joint_share, 0.0, 1.0,
             "Share of each joint's range in which its angle is drawn");
}

void add_fall_detection_options(CLI::App& command, lab::FallDetectionOptions& options, SessionOptions&) {
  add_number(command, "--standing", options.standing_N_s_per_kg, 0.01, 10.0,
             "Impulse that is survived standing, N s/kg");
  add_number(command, "--walking", options.walking_N_s_per_kg, 0.01, 10.0,
             "Impulse that is survived walking, N s/kg");
  add_number(command, "--survivable", options.survivable_N_s_per_kg, 0.0, 10.0,
             "Hardest push of the walks, N s/kg");
  add_number(command, "--walk", options.walk_s, 1.0, 3600.0, "Duration of each walk, s");
  command.add_option("--roc", options.scales, "Also multiply the thresholds by these factors")
      ->delimiter(',')
      ->check(CLI::Range(0.1, 3.5));
}

void add_marathon_options(CLI::App& command, lab::MarathonOptions& options, SessionOptions&) {
  add_number(command, "--hours", options.hours, 0.01, 100.0, "Simulated hours");
  add_number(command, "--highest", options.highest_N_s_per_kg, 0.0, 10.0, "Hardest push, N s/kg");
}

void add_comparison_options(CLI::App& command, lab::ComparisonOptions& options, SessionOptions&) {
  command
      .add_option("--policy", options.policy,
                  "Image of the policy (.kpol); without it the engine alone is played")
      ->type_name("FILE");
  command.add_option("--only", options.activities, "Some of the activities")
      ->delimiter(',')
      ->check(CLI::IsMember(lab::ComparisonOptions::all_activities()));
  command.add_option("--impulses", options.impulses_N_s_per_kg, "Impulses of the pushes, N s/kg")
      ->delimiter(',')
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str();
  add_number(command, "--walk", options.walk_s, 0.1, 3600.0, "Seconds of a walk without pushes");
}

void add_robustness_options(CLI::App& command, lab::RobustnessOptions& options, SessionOptions&) {
  command.add_option("--only", options.activities, "Some of the activities")
      ->delimiter(',')
      ->check(CLI::IsMember(lab::RobustnessOptions::all_activities()));
  command.add_option("--factors", options.factors, "Some of the factors")
      ->delimiter(',')
      ->check(CLI::IsMember(lab::RobustnessOptions::all_factors()));
  command.add_option("--levels", options.levels, "Levels of one factor instead of its own, rising")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1e3));
  std::vector<std::string> worlds = simulation::world_names();
  worlds.insert(worlds.begin(), lab::RobustnessOptions::kNominal);
  command.add_option("--others", options.others, "World from which the other factors are drawn")
      ->check(CLI::IsMember(worlds))
      ->capture_default_str();
  add_number(command, "--full-speed", options.full_speed_m_per_s, 0.0, 3.0,
             "Full speed, m/s, at most the robot's limit; 0: the limit");
  add_number(command, "--distance", options.distance_m, 0.1, 100.0,
             "Distance of a walk, m, for a leg of 0.13 m; it scales with the leg");
  add_number(command, "--cliff", options.cliff_share, 0.01, 1.0,
             "Share of lost trials beyond which no harder level is played");
}

void add_loop_options(CLI::App& command, lab::LoopOptions& options, SessionOptions&) {
  command.add_option("--only", options.states, "Some of the states: standing, walking")
      ->delimiter(',')
      ->check(CLI::IsMember({"standing", "walking"}));
  command.add_option("--axes", options.axes, "Some of the axes: pitch, roll")
      ->delimiter(',')
      ->check(CLI::IsMember({"pitch", "roll"}));
  command.add_option("--frequencies", options.frequencies_Hz, "Frequencies of the sine, Hz, rising")
      ->delimiter(',')
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str();
  add_number(command, "--amplitude", options.amplitude_deg_per_s, 0.1, 500.0, "Of the sine, deg/s");
  add_number(command, "--speed", options.speed_m_per_s, 0.0, 3.0, "Of the walk, m/s");
}

}  // namespace

void add_experiment_command(CLI::App& program, Invocation& invocation) {
  CLI::App& command =
      *program.add_subcommand("experiment", "Experiments: many trials over the cores, with statistics");
  command.require_subcommand(1);
  add<lab::GyroFeedbackOptions>(
      command, invocation,
      {.name = "gyro-feedback",
       .description = "The paper's section 3: points of the walking pattern, gyro feedback off and on",
       .footer = "",
       .examples = {"gyro-feedback --seeds 20 --duration 30",
                    "gyro-feedback --points 8 --feedback on --seeds 100 --duration 60 --json fb.json",
                    "gyro-feedback --disturbed --budget-s 1800"},
       .make = lab::make_gyro_feedback,
       .add_options = add_gyro_feedback_options,
       .draw_figures = draw_walks});
  add<lab::WalkingSpeedOptions>(
      command, invocation,
      {.name = "walking-speed",
       .description = "The highest speeds that are sustained over 10 body heights",
       .footer = "The command is raised in each direction until more than 5 of 100 seeds fall, or make less\n"
                 "than a quarter of it. Odd seeds go to the left, even ones to the right.\n",
       .examples = {"walking-speed --seeds 20 --stepper mujoco",
                    "walking-speed --only forward --forward 0.2,0.22,0.24 --json speed.json"},
       .make = lab::make_walking_speed,
       .add_options = add_walking_speed_options});
  add<lab::PushRecoveryOptions>(
      command, invocation,
      {.name = "push-recovery",
       .description = "The largest pushes that are survived, standing and walking in place",
       .footer =
           "A half sine of 0.1 s at the trunk. In each world and direction the largest impulse is found\n"
           "by bisection; the table shows the impulse that 95 of 100 seeds survive, with a 95 %\n"
           "confidence interval, and walking, in the phase of the step in which it is least.\n",
       .examples = {"push-recovery --seeds 20 --stepper mujoco",
                    "push-recovery --directions 4 --ablate gyro,capture --json push.json"},
       .make = lab::make_push_recovery,
       .add_options = add_push_recovery_options});
  add<lab::TerrainOptions>(
      command, invocation,
      {.name = "terrain",
       .description = "Steps, slopes, slippery patches and bumps that are walked over",
       .footer = "Each kind of ground is made harder until more than 5 of 100 seeds fall, or need more than\n"
                 "twice the time.\n",
       .examples = {"terrain --seeds 20 --stepper mujoco --budget-s 600",
                    "terrain --only uphill,downhill,across --levels 5,8 --world rough --stepper mujoco"},
       .make = lab::make_terrain,
       .add_options = add_terrain_options});
  add<lab::StandUpOptions>(
      command, invocation,
      {.name = "stand-up",
       .description = "Whether the robot gets up from any pose in which it was dropped",
       .footer = "The robot is dropped limp with a random attitude and random joint angles, settles, and is\n"
                 "commanded to get up.\n",
       .examples = {"stand-up --seeds 200 --stepper mujoco"},
       .make = lab::make_stand_up,
       .add_options = add_stand_up_options,
       .options = {{.scenario = kGetUp}}});
  add<lab::FallDetectionOptions>(
      command, invocation,
      {.name = "fall-detection",
       .description = "Lead time and false alarms of fall detection",
       .footer = "Pushes of 1.2 to 2 times the survived impulse, from all sides; bars in the path, slippery\n"
                 "floors, a push that lasts, drives that fail; and walks with pushes that are survived.\n",
       .examples = {"fall-detection --seeds 60 --stepper mujoco --roc 0.8,1.25"},
       .make = lab::make_fall_detection,
       .add_options = add_fall_detection_options,
       .options = {{.scenario = kGetUp}}});
  add<lab::MarathonOptions>(command, invocation,
                            {.name = "marathon",
                             .description = "An hour of random commands and pushes",
                             .footer = "The robot gets no help.\n",
                             .examples = {"marathon --stepper mujoco --hours 0.1"},
                             .make = lab::make_marathon,
                             .add_options = add_marathon_options,
                             .options = {{.scenario = kGetUp, .seeds = 10}}});
  add<lab::RobustnessOptions>(
      command, invocation,
      {.name = "robustness",
       .description = "What each disturbance alone costs, up to its cliff",
       .footer = "Walks at half and full speed, pushes (standing, on the spot, at half and full speed) and "
                 "getting\n"
                 "up, with one factor at a time at a level of its own; every other factor is as in the "
                 "files, or\n"
                 "drawn from the world that --others names. All of it takes hours: the folder of the results "
                 "resumes it, --budget-s divides it.\n",
       .examples = {"robustness --stepper mujoco --budget-s 3600",
                    "robustness --only walk-full,push-standing --factors slope,supply-low --seeds 50",
                    "robustness --only push-half --factors impulse --levels 0.25,0.3 --others rough"},
       .make = lab::make_robustness,
       .add_options = add_robustness_options,
       .options = {},
       .worlds = "--world has no effect here; --others has.\n"});
  add<lab::ComparisonOptions>(
      command, invocation,
      {.name = "learned",
       .description = "The walking engine alone against the engine with a policy",
       .footer =
           "The same worlds and the same pushes for both, on the spot and at half and full speed; walks\n"
           "without pushes. The lines below the table compare them seed by seed.\n",
       .examples = {"learned --only push-half --impulses 0.36 --seeds 20 --world harsh"},
       .make = lab::make_comparison,
       .add_options = add_comparison_options});
  add<lab::LoopOptions>(
      command, invocation,
      {.name = "loop",
       .description = "Gain, phase and margins of the balance feedback",
       .footer = "A sine is added to what the gyro senses. The trunk's answer gives the open loop's gain\n"
                 "and phase, standing and walking.\n",
       .examples = {"loop --stepper mujoco", "loop --only walking --amplitude 20 --json loop.json"},
       .make = lab::make_loop,
       .add_options = add_loop_options});
  add<lab::ExperimentSetup>(
      command, invocation,
      {.name = "contacts",
       .description = "Whether the simulated contacts hold in falls and in getting up",
       .footer =
           "The robot falls because a drive fails, or because it is pushed, and gets up. The table shows\n"
           "the deepest contact that closes without a force, steps in which sliding contacts did not\n"
           "settle, and how far links overlap.\n",
       .examples = {"contacts --seeds 100 --stepper mujoco"},
       .make = lab::make_contacts,
       .options = {.scenario = kGetUp}});
  add_tune_gait_command(command);
}

}  // namespace koboshi::cli
