#include "tests/closed_loop/motion_library/library_trial.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "lab/trial/motion_measure.h"
#include "lab/trial/scenario_trial.h"
#include "simulation/scenario/reader.h"

namespace koboshi::test {
namespace {

using simulation::RunRecorder;
using simulation::Simulation;

constexpr double kRadPerDegree = std::numbers::pi / 180.0;
constexpr double kPlay_s = 4.5;  // the robot of scenarios/motion.yaml stands and is settled
// The robot counts as standing within these of upright and of the standing pose's height of the trunk.
constexpr double kUpright_deg = 10.0;
constexpr double kStanding_m = 0.145;

// A criterion. `observe` is called after each millisecond, with the time since the motion's command.
class Judge {
 public:
  virtual ~Judge() = default;
  virtual void observe(double time_s, const Simulation& simulation, const RunRecorder& recorder) = 0;
  virtual LibraryOutcome judge() const = 0;
};

struct TrialPlan {
  std::string name;
  std::vector<std::string> motions{};                      // beside those of the stage
  std::vector<std::pair<double, std::string>> commands{};  // since kPlay_s: {"play": ...}
  double duration_s = 10.0;                                // since kPlay_s
  std::vector<Override> overrides{};
  std::function<std::unique_ptr<Judge>()> make_judge{};
};

double joint_deg(const Simulation& simulation, const char* name) {
  const auto joint = simulation.robot().find_joint(name);
  return simulation.board().world().joint(*joint).position_rad / kRadPerDegree;
}

bool is_upright(const RunRecorder& recorder) {
  return recorder.truth().tilt_rad < kUpright_deg * kRadPerDegree && recorder.truth().height_m > kStanding_m;
}

// Whether a link touches the ground.
bool touches_ground(const Simulation& simulation, const char* link) {
  const auto number = simulation.robot().find_link(link);
  return std::ranges::any_of(simulation.board().world().contacts(), [&](const sim_board::Contact& contact) {
    return contact.link == *number && contact.other_link < 0;
  });
}

// Judges that the robot is on its feet at the end, never fell, and did what `done` measures: the most of a
// quantity must reach a bound.
class Reaches : public Judge {
 public:
  using Measure = std::function<double(double time_s, const Simulation&, const RunRecorder&)>;

  Reaches(std::string quantity, double bound, Measure measure, bool ends_standing = true)
      : quantity_(std::move(quantity)),
        bound_(bound),
        measure_(std::move(measure)),
        ends_standing_(ends_standing) {}

  void observe(double time_s, const Simulation& simulation, const RunRecorder& recorder) override {
    most_ = std::max(most_, measure_(time_s, simulation, recorder));
    const behaviour::State state = recorder.telemetry().state;
    fell_ = fell_ || state == behaviour::State::kFalling || state == behaviour::State::kFault ||
            state == behaviour::State::kEmergencyStop;
    stands_ = is_upright(recorder) && state == behaviour::State::kStanding;
  }

  LibraryOutcome judge() const override {
    LibraryOutcome outcome{.measured = fmt::format("{:.3f} {}", most_, quantity_)};
    if (fell_)
      outcome.failure = "fell";
    else if (ends_standing_ && !stands_)
      outcome.failure = "does not stand at the end";
    else if (!(most_ >= bound_))
      outcome.failure = fmt::format("{}, expected {}", outcome.measured, bound_);
    return outcome;
  }

 private:
  const std::string quantity_;
  const double bound_;
  const Measure measure_;
  const bool ends_standing_;
  double most_ = -std::numeric_limits<double>::infinity();
  bool fell_ = false;
  bool stands_ = false;
};

std::unique_ptr<Judge> reaches(std::string quantity, double bound, Reaches::Measure measure,
                               bool ends_standing = true) {
  return std::make_unique<Reaches>(std::move(quantity), bound, std::move(measure), ends_standing);
}

// Counts how often a value rises above `high` after it was below `low`.
class Swings {
 public:
  Swings(double low, double high) : low_(low), high_(high) {}
  int count(double value) {
    if (value < low_) is_low_ = true;
    if (value > high_ && is_low_) {
      is_low_ = false;
      ++count_;
    }
    return count_;
  }

 private:
  const double low_;
  const double high_;
  bool is_low_ = true;
  int count_ = 0;
};

// The longest time that a condition held without a break, in s.
class Longest {
 public:
  double held_s(double time_s, bool holds) {
    if (!holds) since_s_.reset();
    if (holds && !since_s_) since_s_ = time_s;
    if (holds) longest_s_ = std::max(longest_s_, time_s - *since_s_);
    return longest_s_;
  }

 private:
  std::optional<double> since_s_;
  double longest_s_ = 0.0;
};

std::unique_ptr<Judge> judge_nod() {
  auto swings = std::make_shared<Swings>(5.0, 20.0);
  return reaches("nods by 20 degrees", 3.0,
                 [swings](double, const Simulation& simulation, const RunRecorder&) {
                   return static_cast<double>(swings->count(joint_deg(simulation, "head_tilt")));
                 });
}

std::unique_ptr<Judge> judge_squat() {
  return reaches("mm below standing", 55.0, [](double, const Simulation&, const RunRecorder& recorder) {
    return 1e3 * (0.1597 - recorder.truth().p_WB_W.z());
  });
}

std::unique_ptr<Judge> judge_one_leg(hal::Side lifted) {
  auto measure = std::make_shared<lab::OneLegTime>(lifted);
  return reaches("s on one leg", 5.0, [=](double, const Simulation& simulation, const RunRecorder& recorder) {
    measure->observe(simulation, recorder);
    return measure->value();
  });
}

std::unique_ptr<Judge> judge_touch_floor() {
  auto longest = std::make_shared<Longest>();
  return reaches("s with both hands on the floor", 0.3,
                 [=](double time_s, const Simulation& simulation, const RunRecorder&) {
                   return longest->held_s(time_s, touches_ground(simulation, "left_forearm") &&
                                                      touches_ground(simulation, "right_forearm"));
                 });
}

std::unique_ptr<Judge> judge_push_up() {
  auto measure = std::make_shared<lab::PushUps>();
  return reaches(
      "push-ups", 3.0,
      [=](double time_s, const Simulation& simulation, const RunRecorder& recorder) {
        if (time_s > 2.7)
          measure->observe(simulation, recorder);  // before, it is on its way to the first one
        return measure->value();
      },
      false);
}

std::unique_ptr<Judge> judge_sit() {
  auto longest = std::make_shared<Longest>();
  return reaches("s seated", 1.0, [=](double time_s, const Simulation&, const RunRecorder& recorder) {
    const simulation::GroundTruth& truth = recorder.truth();
    // Half of the weight of 1.2 kg at most is on the feet.
    const bool seated =
        truth.foot_load_N[0] + truth.foot_load_N[1] < 0.5 * 11.77 && truth.tilt_rad < 20.0 * kRadPerDegree;
    return longest->held_s(time_s, seated);
  });
}

std::unique_ptr<Judge> judge_dance() {
  auto squats = std::make_shared<Swings>(-0.1, 0.020);
  auto sways = std::make_shared<Swings>(0.0, 0.010);
  return reaches("beats down and to the left", 10.0,
                 [=](double, const Simulation&, const RunRecorder& recorder) {
                   const Eigen::Vector3d& p_m = recorder.truth().p_WB_W;
                   return static_cast<double>(squats->count(0.1597 - p_m.z() > 0.010 ? 0.03 : -0.2) +
                                              sways->count(p_m.y()));
                 });
}

std::unique_ptr<Judge> judge_greet() {
  auto swings = std::make_shared<Swings>(112.0, 122.0);
  return reaches("waves while it walks", 3.0,
                 [=](double, const Simulation& simulation, const RunRecorder& recorder) {
                   if (recorder.telemetry().state != behaviour::State::kWalking) return 0.0;
                   return static_cast<double>(swings->count(-joint_deg(simulation, "right_shoulder_roll")));
                 });
}

class JudgeKick final : public Judge {
 public:
  void observe(double time_s, const Simulation& simulation, const RunRecorder& recorder) override {
    ball_.observe(simulation, recorder);
    const behaviour::State state = recorder.telemetry().state;
    fell_ = fell_ || state == behaviour::State::kFalling || state == behaviour::State::kFault;
    if (ball_.touched_s() && kPlay_s + time_s > *ball_.touched_s() + 3.0)
      stands_ = recorder.truth().tilt_rad < kUpright_deg * kRadPerDegree;
  }
  LibraryOutcome judge() const override {
    LibraryOutcome outcome{.measured = fmt::format("{:.3f} m/s", ball_.value())};
    if (fell_)
      outcome.failure = "fell";
    else if (!ball_.touched_s())
      outcome.failure = "missed the ball";
    else if (!stands_)
      outcome.failure = "does not stand 3 s later";
    else if (ball_.value() < 0.8)
      outcome.failure = outcome.measured + ", expected 0.8";
    return outcome;
  }

 private:
  lab::BallSpeed ball_;
  bool fell_ = false;
  bool stands_ = false;
};

TrialPlan plan_of(const std::string& motion, double duration_s,
                  std::function<std::unique_ptr<Judge>()> judge) {
  return {.name = motion,
          .motions = {motion},
          .commands = {{0.0, "\"play\": \"" + motion + "\""}},
          .duration_s = duration_s,
          .make_judge = std::move(judge)};
}

TrialPlan kick(const std::string& side, double left) {
  TrialPlan plan = plan_of("kick_" + side, 9.0, [] { return std::make_unique<JudgeKick>(); });
  plan.overrides.push_back(
      {"bodies", fmt::format("[{{name: ball, diameter_m: 0.065, mass_kg: 0.058, bounce: 0.5, friction: 0.6, "
                             "rolling_friction: 0.04, position_m: [0.105, {}]}}]",
                             0.045 * left)});
  return plan;
}

std::vector<TrialPlan> plans() {
  std::vector<TrialPlan> all;
  all.push_back(plan_of("nod", 6.0, judge_nod));
  all.push_back(plan_of("squat_deep", 8.0, judge_squat));
  all.push_back(plan_of("one_leg_left", 13.5, [] { return judge_one_leg(hal::Side::kRight); }));
  all.push_back(plan_of("one_leg_right", 13.5, [] { return judge_one_leg(hal::Side::kLeft); }));
  all.push_back(plan_of("touch_floor", 10.0, judge_touch_floor));
  all.push_back(plan_of("dance", 32.5, judge_dance));
  all.push_back(kick("left", 1.0));
  all.push_back(kick("right", -1.0));

  // The walk begins with its first steps; the arm waves while it goes on.
  TrialPlan greet = plan_of("greet", 9.0, judge_greet);
  greet.name = "wave_while_walking";
  greet.commands = {
      {0.0, "\"walk\": {\"forward_m_per_s\": 0.15}"}, {1.5, "\"play\": \"greet\""}, {6.5, "\"stop\": true"}};
  all.push_back(greet);

  TrialPlan push_up = plan_of("push_up", 11.5, judge_push_up);
  push_up.overrides = {{"initial", "{attitude_deg: {pitch: 90}}"}};
  all.push_back(push_up);

  TrialPlan sit = plan_of("sit_down", 13.0, judge_sit);
  sit.name = "sit";
  sit.motions = {"sit_down", "sit_up"};
  sit.commands.push_back({6.0, "\"play\": \"sit_up\""});
  sit.overrides = {{"ground.shapes", "[{box: {position_m: [-0.111, 0], size_m: [0.1, 0.16, 0.13]}}]"}};
  all.push_back(sit);
  return all;
}

simulation::Scenario scenario_of(const TrialPlan& plan, std::string_view stepper, std::string_view world) {
  const std::string stage = KOBOSHI_SOURCE_DIR "/scenarios/motion.yaml";
  std::vector<Override> overrides = plan.overrides;
  std::string motions =
      "stand, fall_front, fall_back, fall_left, fall_right, roll_left, roll_right, rise_prone, rise_supine, "
      "rise_seat";
  for (const std::string& motion : plan.motions) motions += ", " + motion;
  overrides.push_back({"motions", "[" + motions + "]"});
  std::string commands = "{\"at_s\": 2, \"enable\": true}";
  for (const auto& [at_s, command] : plan.commands)
    commands += fmt::format(", {{\"at_s\": {}, {}}}", kPlay_s + at_s, command);
  overrides.push_back({"commands", "[" + commands + "]"});
  overrides.push_back({"duration_s", fmt::format("{}", kPlay_s + plan.duration_s)});
  overrides.push_back({"physics.stepper", std::string(stepper)});
  if (!world.empty()) overrides.push_back({"world", std::string(world)});
  return simulation::read_scenario(stage, overrides);
}

}  // namespace

const std::vector<std::string>& library_trials() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const TrialPlan& plan : plans()) all.push_back(plan.name);
    return all;
  }();
  return names;
}

LibraryOutcome play_library_trial(std::string_view trial, std::string_view stepper, std::string_view world,
                                  std::uint64_t seed) {
  const std::vector<TrialPlan> all = plans();
  const auto plan = std::ranges::find(all, trial, &TrialPlan::name);
  const std::unique_ptr<Judge> judge = plan->make_judge();
  const lab::ScenarioTrial played =
      lab::watch_in_world(scenario_of(*plan, stepper, world), seed,
                          [&](const Simulation& simulation, const RunRecorder& recorder) {
                            const double time_s = simulation.board().world().time_s() - kPlay_s;
                            if (time_s >= 0.0) judge->observe(time_s, simulation, recorder);
                            return false;
                          });
  if (!played.error.empty()) return {.failure = played.error};
  return judge->judge();
}

}  // namespace koboshi::test
