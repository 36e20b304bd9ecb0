#include "tools/lab/catalogue/contacts.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "sim_board/input/user_units.h"
#include "sim_board/robot/load.h"
#include "sim_board/scenario/reader.h"
#include "tools/lab/trial/contact_observer.h"
#include "tools/lab/trial/outcome.h"
#include "tools/lab/trial/perturbation.h"
#include "tools/lab/trial/scenario_trial.h"

namespace koboshi::tools {
namespace {

constexpr double kWalkFor_s = 2.0;    // before a drive fails, and up to a second more: any phase of a step
constexpr double kLimpFor_s = 3.0;    // it lies after one
constexpr double kPushAfter_s = 1.0;  // of standing
constexpr double kGetUpFor_s = 14.0;  // from the push on: a fall, and up to three attempts to get up
// Up to twice what every robot falls from, so that it arrives on its side and turning, too.
constexpr double kLowestPush_N_s_per_kg = 0.6;
constexpr double kHighestPush_N_s_per_kg = 1.2;

constexpr const char* kDepth = "deepest_without_force_m";
constexpr const char* kUnsettled = "unsettled_steps";
constexpr const char* kSteps = "contact_steps";
constexpr const char* kOverlap = "largest_overlap_m";

sim::Scenario with_failing_drive(const StandingStart& start, sim::RandomStream& random) {
  static constexpr std::array<const char*, 4> kJoints{"left_knee", "right_knee", "left_hip_pitch",
                                                      "right_ankle_pitch"};
  const double walk_s = kWalkFor_s + random.uniform();
  const Eigen::Vector3d velocity{between(random, -0.15, 0.22), between(random, -0.06, 0.06),
                                 between(random, -0.5, 0.5)};
  sim::Scenario scenario = start.walking(velocity, walk_s + kLimpFor_s);
  sim::Fault fault;
  fault.at_us = start.ready_us + to_us(walk_s);
  fault.kind = sim::Fault::Kind::kDrivePowerLoss;
  fault.target = {kJoints[static_cast<std::size_t>(random.uniform() * kJoints.size())], "an experiment", 0};
  scenario.faults.push_back(fault);
  return scenario;
}

sim::Scenario with_push(const StandingStart& start, const sim::RobotDescription& robot,
                        sim::RandomStream& random) {
  sim::Scenario scenario = start.standing(kPushAfter_s + kGetUpFor_s);
  const double towards_rad = kTurn_rad * random.uniform();
  const double impulse_N_s =
      between(random, kLowestPush_N_s_per_kg, kHighestPush_N_s_per_kg) * robot.total_mass_kg();
  scenario.pushes.push_back(
      half_sine_push(robot.links.front().name, start.ready_us + to_us(kPushAfter_s), kPush_s,
                     impulse_N_s * Eigen::Vector3d(std::cos(towards_rad), std::sin(towards_rad), 0.0)));
  return scenario;
}

std::string pair_measure(const sim::RobotDescription& robot, const LinkPair& pair) {
  const auto name = [&](int link) { return robot.links[static_cast<std::size_t>(link)].name; };
  return fmt::format("overlap_{}_{}_m", name(pair.links[0]), name(pair.links[1]));
}

Values play(const sim::Scenario& scenario, std::uint64_t seed) {
  std::unique_ptr<ContactObserver> observer;
  std::uint64_t unsettled = 0;
  Values values;
  const Values played = watch_in_world(
      scenario, kRoughWorld, seed, [&](simulation::Simulation& simulation, const simulation::RunRecorder&) {
        const sim::World& world = simulation.board().world();
        if (!observer) observer = std::make_unique<ContactObserver>(simulation.robot(), world);
        observer->observe();
        unsettled = world.unsettled_steps();
        for (const LinkPair& pair : observer->pairs()) {
          const std::string name = pair.collides ? kOverlap : pair_measure(simulation.robot(), pair);
          values[name] = std::max(values[name], pair.overlap_m);
        }
        return false;
      });
  add_outcome(played, values);
  values[kDepth] = observer->deepest_without_force_m();
  values[kUnsettled] = static_cast<double>(unsettled);
  values[kSteps] = static_cast<double>(observer->contact_steps());
  values["deepest_m"] = observer->deepest_m();
  values["largest_force_N"] = observer->largest_force_N();
  return values;
}

double largest(const ExperimentResult& result, const std::string& measure) {
  double largest = 0.0;
  for (const CellResult& cell : result.cells) {
    for (const double value : values_of(cell, {.name = measure})) largest = std::max(largest, value);
  }
  return largest;
}

double total(const ExperimentResult& result, const std::string& measure) {
  double sum = 0.0;
  for (const CellResult& cell : result.cells) {
    for (const double value : values_of(cell, {.name = measure})) sum += value;
  }
  return sum;
}

// The pairs of links that never collide, by the name of their measure.
std::vector<std::pair<std::string, std::array<std::string, 2>>> free_pairs(
    const sim::RobotDescription& robot) {
  std::vector<std::pair<std::string, std::array<std::string, 2>>> pairs;
  for (const LinkPair& pair : link_pairs(robot)) {
    if (pair.collides) continue;
    pairs.push_back({pair_measure(robot, pair),
                     {robot.links[static_cast<std::size_t>(pair.links[0])].name,
                      robot.links[static_cast<std::size_t>(pair.links[1])].name}});
  }
  return pairs;
}

std::string names_of_bare_links(const sim::RobotDescription& robot) {
  std::string names;
  for (const sim::LinkDescription& link : robot.links) {
    if (link.collisions.empty()) names += (names.empty() ? "" : ", ") + link.name;
  }
  return names;
}

}  // namespace

Experiment make_contacts(const ContactsOptions& options) {
  const auto start =
      std::make_shared<StandingStart>(read_standing_start(options.scenario, options.overrides));
  const auto robot = std::make_shared<sim::RobotDescription>(sim::load_robot(start->scenario.robot));
  Experiment experiment = begin_experiment("contacts", options, start->scenario, {});
  using enum Measure::Kind;
  experiment.measures = outcome_measures();
  experiment.measures.insert(
      experiment.measures.end(),
      {{.name = kDepth, .label = "closing without force, deepest [mm]", .factor = sim::kMmPerM},
       {.name = kUnsettled, .label = "unsettled steps", .decimals = 2},
       {.name = kSteps, .label = "steps with contact", .decimals = 0},
       {.name = "deepest_m", .label = "deepest contact [mm]", .factor = sim::kMmPerM, .decimals = 2},
       {.name = "largest_force_N", .label = "largest force [N]", .decimals = 0},
       {.name = kOverlap, .label = "links overlap [mm]", .factor = sim::kMmPerM, .decimals = 2}});
  for (const auto& [measure, names] : free_pairs(*robot)) experiment.measures.push_back({.name = measure});
  experiment.cells = {{"drive-failure", {{"fall", "drive failure"}}}, {"push", {{"fall", "push, gets up"}}}};
  experiment.play = [start, robot](std::size_t cell, std::uint64_t seed) {
    sim::RandomStream random(seed, "fall of the contacts");
    return play(cell == 0 ? with_failing_drive(*start, random) : with_push(*start, *robot, random), seed);
  };
  return experiment;
}

Conclusions contacts_conclusions(const ContactsOptions& options, const ExperimentResult& result) {
  const sim::RobotDescription robot =
      sim::load_robot(sim::read_scenario(options.scenario, options.overrides).robot);
  Conclusions conclusions;
  const double depth_m = largest(result, kDepth);
  const double overlap_m = largest(result, kOverlap);
  const double share = total(result, kUnsettled) / total(result, kSteps);
  conclusions.values["deepest_without_force_m"] = depth_m;
  conclusions.values["unsettled_share"] = share;
  conclusions.values["largest_overlap_m"] = overlap_m;
  conclusions.lines += fmt::format("closing without force: {:.2f} mm deep at most\n", sim::kMmPerM * depth_m);
  conclusions.lines += fmt::format("unsettled: {:.0f} of {:.0f} steps with a contact, {:.4f} %\n",
                                   total(result, kUnsettled), total(result, kSteps), 100.0 * share);
  conclusions.lines +=
      fmt::format("links that collide overlap by {:.2f} mm at most\n", sim::kMmPerM * overlap_m);
  conclusions.lines += fmt::format("links without a collision shape: {}\n", names_of_bare_links(robot));
  conclusions.lines += "links that never collide, and by how much they overlap at most:\n";
  auto pairs = free_pairs(robot);
  std::ranges::stable_sort(pairs, std::ranges::greater{},
                           [&](const auto& pair) { return largest(result, pair.first); });
  for (const auto& [measure, names] : pairs) {
    const double pair_m = largest(result, measure);
    conclusions.values[measure] = pair_m;
    conclusions.lines += fmt::format("  {:5.1f} mm  {} and {}\n", sim::kMmPerM * pair_m, names[0], names[1]);
  }
  return conclusions;
}

}  // namespace koboshi::tools
