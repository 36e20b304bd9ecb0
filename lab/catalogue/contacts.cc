#include "lab/catalogue/contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/text/user_units.h"
#include "lab/experiment/report.h"
#include "lab/trial/pushes.h"
#include "lab/trial/scenario_trial.h"
#include "sim_board/description/load.h"

namespace koboshi::lab {
namespace {

constexpr double kWalkFor_s = 2.0;    // before a drive fails, and up to a second more: any phase of a step
constexpr double kLimpFor_s = 3.0;    // it lies after one
constexpr double kPushAfter_s = 1.0;  // of standing
constexpr double kGetUpFor_s = 14.0;  // from the push on: a fall, and up to three attempts to get up
// Up to twice what every robot falls from, so that it arrives on its side and turning, too.
constexpr double kLowestPush_N_s_per_kg = 0.6;
constexpr double kHighestPush_N_s_per_kg = 1.2;

simulation::Scenario with_push(const StandingStart& start, const sim_board::RobotDescription& robot,
                               sim_board::RandomStream& random) {
  simulation::Scenario scenario = start.standing(kPushAfter_s + kGetUpFor_s);
  const double towards_rad = kTurn_rad * random.uniform();
  const double impulse_N_s =
      between(random, kLowestPush_N_s_per_kg, kHighestPush_N_s_per_kg) * robot.total_mass_kg();
  scenario.pushes.push_back(
      half_sine_push(robot.links.front().name, start.ready_us + to_us(kPushAfter_s), kPush_s,
                     impulse_N_s * Eigen::Vector3d(std::cos(towards_rad), std::sin(towards_rad), 0.0)));
  return scenario;
}

ContactsTrial play(const simulation::Scenario& scenario, std::uint64_t seed) {
  std::optional<ContactObserver> observer;
  ContactsTrial trial;
  const ScenarioTrial played =
      watch_in_world(scenario, seed, [&](simulation::Simulation& simulation, const simulation::RunRecorder&) {
        const sim_board::World& world = simulation.board().world();
        if (!observer) observer.emplace(simulation.robot(), world);
        observer->observe();
        trial.unsettled_steps = world.unsettled_steps();
        return false;
      });
  trial.outcome = played.outcome;
  trial.error = played.error;
  trial.extremes = observer->extremes();
  for (const LinkPair& pair : observer->pairs()) {
    if (!pair.collides) trial.free_overlaps_m.push_back(pair.overlap_m);
    if (pair.collides) trial.largest_overlap_m = std::max(trial.largest_overlap_m, pair.overlap_m);
  }
  return trial;
}

// A pair of links that never collides.
struct FreePair {
  std::string first;
  std::string second;
  double overlap_m = 0.0;

  std::string metric() const { return fmt::format("overlap_{}_{}_m", first, second); }
};

std::vector<FreePair> free_pairs(const sim_board::RobotDescription& robot) {
  const auto name = [&](int link) { return robot.links[static_cast<std::size_t>(link)].name; };
  std::vector<FreePair> pairs;
  for (const LinkPair& pair : link_pairs(robot)) {
    if (!pair.collides) pairs.push_back({.first = name(pair.links[0]), .second = name(pair.links[1])});
  }
  return pairs;
}

std::string names_of_bare_links(const sim_board::RobotDescription& robot) {
  std::vector<std::string> names;
  for (const sim_board::LinkDescription& link : robot.links) {
    if (link.collisions.empty()) names.push_back(link.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

template <typename Member>
double largest_of(const std::vector<ContactsTrial>& trials, Member member) {
  const std::vector<double> values = values_of(trials, member);
  return values.empty() ? 0.0 : std::max(0.0, *std::ranges::max_element(values));
}

template <typename Member>
double total_of(const std::vector<ContactsTrial>& trials, Member member) {
  const std::vector<double> values = values_of(trials, member);
  return std::accumulate(values.begin(), values.end(), 0.0);
}

Conclusions conclude(const sim_board::RobotDescription& robot, const std::vector<ContactsTrial>& trials) {
  using T = ContactsTrial;
  Conclusions conclusions;
  const double depth_m =
      largest_of(trials, [](const T& trial) { return trial.extremes.deepest_without_force_m; });
  const double overlap_m = largest_of(trials, &T::largest_overlap_m);
  const double unsettled = total_of(trials, &T::unsettled_steps);
  const double steps = total_of(trials, [](const T& trial) { return trial.extremes.contact_steps; });
  conclusions.values["deepest_without_force_m"] = depth_m;
  conclusions.values["unsettled_share"] = unsettled / steps;
  conclusions.values["largest_overlap_m"] = overlap_m;
  conclusions.lines = fmt::format(
      "closing without force: {:.2f} mm deep at most\n"
      "unsettled: {:.0f} of {:.0f} steps with a contact, {:.4f} %\n"
      "links that collide overlap by {:.2f} mm at most\n"
      "links without a collision shape: {}\n"
      "links that never collide, and by how much they overlap at most:\n",
      kMmPerM * depth_m, unsettled, steps, 100.0 * (unsettled / steps), kMmPerM * overlap_m,
      names_of_bare_links(robot));
  std::vector<FreePair> pairs = free_pairs(robot);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i].overlap_m = largest_of(trials, [i](const T& trial) { return trial.free_overlaps_m.at(i); });
  }
  std::ranges::stable_sort(pairs, std::ranges::greater{}, &FreePair::overlap_m);
  for (const FreePair& pair : pairs) {
    conclusions.values[pair.metric()] = pair.overlap_m;
    conclusions.lines +=
        fmt::format("  {:5.1f} mm  {} and {}\n", kMmPerM * pair.overlap_m, pair.first, pair.second);
  }
  return conclusions;
}

}  // namespace

FieldTable<ContactsTrial> contacts_fields(const sim_board::RobotDescription& robot) {
  using T = ContactsTrial;
  using Extremes = ContactExtremes;
  Fields<T> overlaps;
  for (const FreePair& pair : free_pairs(robot)) {
    const std::size_t i = overlaps.size();
    overlaps.push_back({{.name = pair.metric()},
                        [i](const T& trial) { return number_of(trial.free_overlaps_m.at(i)); },
                        [i](T& trial, std::optional<double> overlap_m) {
                          trial.free_overlaps_m.resize(std::max(i + 1, trial.free_overlaps_m.size()));
                          assign_number(trial.free_overlaps_m[i], overlap_m);
                        }});
  }
  return {outcome_fields<T>(&T::outcome),
          Fields<T>{{{"deepest_without_force_m", "closing without force, deepest [mm]", 3, kMmPerM},
                     &T::extremes,
                     &Extremes::deepest_without_force_m},
                    {{"unsettled_steps", "unsettled steps", 2}, &T::unsettled_steps},
                    {{"contact_steps", "steps with contact", 0}, &T::extremes, &Extremes::contact_steps},
                    {{"deepest_m", "deepest contact [mm]", 2, kMmPerM}, &T::extremes, &Extremes::deepest_m},
                    {{"largest_force_N", "largest force [N]", 0}, &T::extremes, &Extremes::largest_force_N},
                    {{"largest_overlap_m", "links overlap [mm]", 2, kMmPerM}, &T::largest_overlap_m}},
          overlaps};
}

Experiment make_contacts(const ExperimentSetup& setup) {
  const StandingStart start = read_standing_start(setup, setup.overrides);
  const sim_board::RobotDescription robot = sim_board::load_robot(start.scenario.robot);
  const FieldTable<ContactsTrial> fields = contacts_fields(robot);
  Experiment experiment = begin_experiment("contacts", "Contacts in falls", setup, start.scenario, {});
  experiment.cells = {{"drive-failure", {{"fall", "drive failure"}}}, {"push", {{"fall", "push, gets up"}}}};
  set_trials(experiment, fields, [start, robot](std::size_t cell, std::uint64_t seed) {
    sim_board::RandomStream random(seed, "fall of the contacts");
    if (cell != 0) return play(with_push(start, robot, random), seed);
    const double walk_s = kWalkFor_s + random.uniform();
    return play(with_failing_drive(start, random, walk_s, kLimpFor_s), seed);
  });
  experiment.conclude = [fields, robot](const Experiment&, const ExperimentResult& result) {
    std::vector<ContactsTrial> trials;
    for (const CellResult& cell : result.cells) {
      for (const Trial& trial : cell.played) trials.push_back(fields.trial(trial.record));
    }
    return conclude(robot, trials);
  };
  return experiment;
}

}  // namespace koboshi::lab
