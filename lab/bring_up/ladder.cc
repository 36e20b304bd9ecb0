#include "lab/bring_up/ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "lab/bring_up/start_values.h"
#include "sim_board/description/load.h"
#include "sim_board/random/random_stream.h"
#include "simulation/assembly/operator_input.h"
#include "simulation/batch/parallel.h"
#include "simulation/model/abilities.h"
#include "simulation/observe/event_words.h"
#include "simulation/observe/watched_simulation.h"
#include "simulation/scenario/reader.h"

namespace koboshi::tools {
namespace {

using behaviour::State;
using simulation::name_of;

constexpr double kLost_rad = 0.6;      // a trunk that leans so far does not come back
constexpr double kUpright_rad = 0.12;  // of a robot that only stands, on slopes of up to 2 degrees
constexpr std::uint64_t kReady_us =
    5'000'000;  // boots, is released at 3.5 s, and has measured its gyro's bias
constexpr std::uint64_t kSearchSeed = 900'000;  // robots of the search; the rungs have others
constexpr std::size_t kMostCandidates = 400;

// What one robot did.
struct Played {
  bool lost = false;
  State state = State::kBoot;
  std::string reason;                     // of the state
  double at_s = 0.0;                      // when it was lost, after the command
  double lean_rad = 0.0;                  // largest
  double torque = 0.0;                    // largest share of the rated torque
  std::array<double, 2> speed_m_per_s{};  // forward and to the left, over the second half
  double turn_rad_per_s = 0.0;
  std::string touching;  // what the event log says of links that touch
};

// A time limit.
class Clock {
 public:
  explicit Clock(double budget_s) : end_(std::chrono::steady_clock::now() + duration(budget_s)) {}
  [[nodiscard]] bool is_over() const { return std::chrono::steady_clock::now() >= end_; }
  // One with half of the time that is left.
  [[nodiscard]] Clock half() const {
    return Clock(0.5 * std::chrono::duration<double>(end_ - std::chrono::steady_clock::now()).count());
  }

 private:
  static std::chrono::steady_clock::duration duration(double time_s) {
    return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(time_s));
  }

  std::chrono::steady_clock::time_point end_;
};

std::string touching_of(const simulation::WatchedSimulation& world) {
  for (const simulation::RunEvent& event : world.recorder().events().events()) {
    if (event.text.find("touch") != std::string::npos) return event.text;
  }
  return {};
}

double yaw_difference(double from_rad, double to_rad) {
  return std::remainder(to_rad - from_rad, 2.0 * M_PI);
}

// Plays a command from the moment at which the robot stands.
Played play(const simulation::Scenario& scenario, const std::string& command, double for_s) {
  simulation::WatchedSimulation world(scenario);
  Played played;
  const auto observe = [&] {
    const auto& truth = world.recorder().truth();
    played.lean_rad = std::max(played.lean_rad, truth.tilt_rad);
    for (std::size_t joint = 0; joint < world.simulation().robot().joints.size(); ++joint)
      played.torque = std::max(played.torque,
                               1e-3 * std::abs(world.recorder().telemetry().joints[joint].torque_permille));
    played.state = world.recorder().telemetry().state;
    played.reason = name_of(world.recorder().telemetry().reason);
    if (truth.tilt_rad > kLost_rad && !played.lost) {
      played.lost = true;
      played.at_s = 1e-6 * (static_cast<double>(world.now_us()) - static_cast<double>(kReady_us));
    }
    return !played.lost;
  };
  while (world.now_us() < kReady_us) {
    world.step(10);
    if (world.now_us() > 4'000'000 && !observe()) return played;
  }
  if (!command.empty()) simulation::command(world.simulation(), command);
  played.torque = 0.0;
  const auto end_us = kReady_us + static_cast<std::uint64_t>(1e6 * for_s);
  Eigen::Vector3d half_p = Eigen::Vector3d::Zero();
  double half_yaw_rad = 0.0;
  double turned_rad = 0.0;
  double last_yaw_rad = 0.0;
  std::uint64_t half_us = 0;
  while (world.now_us() < end_us) {
    world.step(10);
    if (!observe()) break;
    const auto& truth = world.recorder().truth();
    if (half_us == 0 && world.now_us() >= (kReady_us + end_us) / 2) {
      half_us = world.now_us();
      half_p = truth.p_WB_W;
      half_yaw_rad = last_yaw_rad = truth.rpy_rad.z();
    } else if (half_us != 0) {
      turned_rad += yaw_difference(last_yaw_rad, truth.rpy_rad.z());
      last_yaw_rad = truth.rpy_rad.z();
    }
  }
  if (half_us != 0 && !played.lost) {
    const double time_s = 1e-6 * static_cast<double>(world.now_us() - half_us);
    const Eigen::Vector3d way = world.recorder().truth().p_WB_W - half_p;
    played.speed_m_per_s = {(way.x() * std::cos(half_yaw_rad) + way.y() * std::sin(half_yaw_rad)) / time_s,
                            (way.y() * std::cos(half_yaw_rad) - way.x() * std::sin(half_yaw_rad)) / time_s};
    played.turn_rad_per_s = turned_rad / time_s;
  }
  played.touching = touching_of(world);
  return played;
}

class Ladder {
 public:
  Ladder(const BringUpOptions& options, const std::function<void(const std::string&)>& progress)
      : options_(options),
        progress_(progress),
        clock_(options.budget_s),
        folder_(options.robot.parent_path()),
        robot_(sim_board::load_robot(options.robot)),
        reference_(simulation::read_robot_parameters(options.reference)),
        reference_body_(measure(sim_board::load_robot(options.reference))),
        origin_("Written by koboshi bring-up") {}

  BringUpResult run() {
    for (const char* name :
         {"parameters.yaml", "motions/stand.yaml", "motions/squat.yaml", "go.yaml", "bring-up.md"})
      check_writable(folder_ / name);
    bool going = true;
    for (const auto& [name, climb] : rungs()) {
      Rung rung{.name = name, .figure = {}, .cause = {}};
      if (going) {
        progress_(rung.name);
        try {
          (this->*climb)(rung);
        } catch (const InputError& error) {
          fail(rung, error.what());
        }
        going = rung.result == Rung::Result::kReached && options_.until != name;
        progress_(fmt::format("{}: {}", rung.name,
                              rung.result == Rung::Result::kFailed ? rung.cause : rung.figure));
      }
      result_.rungs.push_back(std::move(rung));
    }
    for (const char* name : {"falls protected", "gets up from the front", "gets up from the back"}) {
      result_.rungs.push_back(
          {.name = name,
           .figure = {},
           .cause = "no motions for it are made yet: import or write them (docs/guide/import-a-robot.md)"});
    }
    write("bring-up.md", page());
    return std::move(result_);
  }

  using Climb = void (Ladder::*)(Rung&);
  static std::array<std::pair<const char*, Climb>, 8> rungs() {
    return {{{"loads", &Ladder::load},
             {"hangs", &Ladder::hang},
             {"stands", &Ladder::stand},
             {"squats", &Ladder::squat},
             {"steps on the spot", &Ladder::march},
             {"walks forward", &Ladder::walk},
             {"walks sideways", &Ladder::sidestep},
             {"turns", &Ladder::turn}}};
  }

 private:
  static void fail(Rung& rung, const std::string& cause) {
    rung.result = Rung::Result::kFailed;
    rung.cause = cause;
  }
  static void reach(Rung& rung, const std::string& figure) {
    rung.result = Rung::Result::kReached;
    rung.figure = figure;
    rung.cause.clear();  // of a try before the search
  }

  // --- Files

  static void check_writable(const std::filesystem::path& file) {
    std::error_code missing;
    if (std::filesystem::exists(file, missing) &&
        read_text_file(file, "a file").find("Written by koboshi bring-up") == std::string::npos)
      throw InputError(file, 0, "a file that bring-up has not written",
                       "none, or one of an earlier bring-up: move it away");
  }

  void write(const std::string& name, const std::string& text) {
    const std::filesystem::path file = folder_ / name;
    std::filesystem::create_directories(file.parent_path());
    write_whole_file(file, text);
    if (std::ranges::find(result_.files, file) == result_.files.end()) result_.files.push_back(file);
  }

  void write_values(const StartFactors& factors) {
    values_ = scaled_values(reference_, reference_body_, robot_, *model_, factors);
    const StandingPose pose = standing_pose(*values_, *model_, origin_);
    write("parameters.yaml", parameters_text(*values_, origin_));
    write("motions/stand.yaml", pose.stand_text);
    write("motions/squat.yaml", pose.squat_text);
    write(
        "go.yaml",
        fmt::format(
            "# {}: stands, and walks forward.\nversion: 1\nrobot: robot.sdf\nmotions: [stand, "
            "squat]\nduration_s: 15\nseed: 1\n"
            "initial:\n  held_until_s: 3.5\n  joints_deg: {{{}}}\ncommands:\n  - {{at_s: 2, enable: true}}\n"
            "  - {{at_s: 5, walk: {{forward_m_per_s: {:.3f}}}}}\n  - {{at_s: 12, stop: true}}\n",
            origin_, pose.joints_text, forward_m_per_s()));
  }

  double forward_m_per_s() const {
    return walked_m_per_s_.value_or(0.3 * values_->value("highest_velocity_forward_mm_per_s") / 1e3);
  }

  simulation::Scenario scenario(std::uint64_t seed, bool fixed_base = false) const {
    std::vector<Override> overrides{
        {"physics.stepper", options_.stepper}, {"seed", std::to_string(seed)}, {"duration_s", "1000"}};
    overrides.push_back({"commands", "[{at_s: 2, enable: true}]"});
    if (fixed_base) overrides.push_back({"initial.held_until_s", "900"});
    overrides.push_back(text_override("world", options_.world, "world"));
    return simulation::read_scenario(folder_ / "go.yaml", overrides);
  }

  // Plays the same command on several robots of other seeds.
  std::vector<Played> play_all(const std::string& command, double for_s, std::uint64_t first_seed,
                               std::size_t count, bool fixed_base = false) const {
    std::vector<Played> all(count);
    simulation::for_each_parallel(count, options_.jobs, [&](std::size_t i) {
      try {
        all[i] = play(scenario(first_seed + i, fixed_base), command, for_s);
      } catch (const sim_board::WorldBlewUp& error) {
        all[i].lost = true;
        all[i].reason = one_line(error.what());
      }
    });
    return all;
  }
  std::vector<Played> play_rung(const std::string& command, double for_s, bool fixed_base = false) const {
    return play_all(command, for_s, options_.first_seed, options_.seeds, fixed_base);
  }

  // Those that are lost, or not in the state that they should be in.
  static std::size_t losses(const std::vector<Played>& all, State state) {
    return static_cast<std::size_t>(
        std::ranges::count_if(all, [&](const Played& one) { return one.lost || one.state != state; }));
  }
  std::string cause_of(const std::vector<Played>& all, State state) const {
    std::string cause = "it is not lost";
    for (const Played& one : all) {
      if (!one.lost && one.state == state) continue;
      cause = one.lost ? fmt::format("{} of {} robots fall, the first {:.1f} s after the command",
                                     losses(all, state), all.size(), one.at_s)
                       : fmt::format("the robot is {}: {}", name_of(one.state), one.reason);
      if (!one.touching.empty()) cause += "; " + one.touching;
      break;
    }
    return cause;
  }
  static double largest(const std::vector<Played>& all, double Played::*member) {
    double value = 0.0;
    for (const Played& one : all) value = std::max(value, one.*member);
    return value;
  }

  // --- Rungs

  void load(Rung& rung) {
    model_ = simulation::load_named_model(robot_);
    write_values({});
    std::string lost;
    for (const simulation::LostAbility& ability : simulation::find_lost_abilities(model_->model))
      lost += (lost.empty() ? "; without " : ", ") + ability.name;
    const BodyMeasures body = measure(robot_);
    reach(rung, fmt::format(
                    "{} joints, {:.2f} kg, legs of {:.0f} mm, the centre of mass {:.0f} mm above the soles{}",
                    robot_.joints.size(), robot_.total_mass_kg(), kMmPerM * body.leg_m, kMmPerM * body.com_m,
                    lost));
  }

  void hang(Rung& rung) {
    const std::vector<Played> all = play_rung({}, 3.0, /*fixed_base=*/true);
    for (const Played& one : all) {
      if (!one.touching.empty()) return fail(rung, one.touching);
      if (one.state != State::kStanding)
        return fail(rung, fmt::format("the robot is {}: {}", name_of(one.state), one.reason));
    }
    reach(rung, "its drives hold the pose, and no links touch");
  }

  void stand(Rung& rung) {
    const std::vector<Played> all = play_rung({}, 10.0);
    const std::size_t lost = losses(all, State::kStanding);
    const double lean_rad = largest(all, &Played::lean_rad);
    if (lost > 0 || lean_rad > kUpright_rad)
      return fail(rung, lost > 0 ? cause_of(all, State::kStanding)
                                 : fmt::format("leans by {:.1f} degrees", kDegreesPerRad * lean_rad));
    reach(
        rung,
        fmt::format(
            "{} of {} robots for 10 s, lean at most {:.1f} degrees, torque at most {:.0f} % of the rated one",
            all.size(), all.size(), kDegreesPerRad * lean_rad, 100.0 * largest(all, &Played::torque)));
  }

  void squat(Rung& rung) {
    const std::vector<Played> all = play_rung("play: squat", 12.0 * std::max(1.0, values_->time_scale));
    if (losses(all, State::kStanding) > 0) return fail(rung, cause_of(all, State::kStanding));
    reach(rung, fmt::format("{} of {} robots, torque at most {:.0f} % of the rated one", all.size(),
                            all.size(), 100.0 * largest(all, &Played::torque)));
  }

  double walk_s() const { return 6.0 * std::max(1.0, values_->time_scale); }

  static std::string walk_command(double forward_m_per_s, double left_m_per_s, double turn_rad_per_s) {
    return fmt::format("walk: {{forward_m_per_s: {:.4f}, left_m_per_s: {:.4f}, turn_rad_per_s: {:.4f}}}",
                       forward_m_per_s, left_m_per_s, turn_rad_per_s);
  }

  void march(Rung& rung) {
    std::vector<Played> all = play_rung(walk_command(0, 0, 0), walk_s());
    if (losses(all, State::kWalking) > 0) {
      search(0.0);
      all = play_rung(walk_command(0, 0, 0), walk_s());
    }
    if (losses(all, State::kWalking) > 0) return fail(rung, cause_of(all, State::kWalking));
    reach(rung, fmt::format("{} of {} robots for {:.0f} s, lean at most {:.1f} degrees", all.size(),
                            all.size(), walk_s(), kDegreesPerRad * largest(all, &Played::lean_rad)));
  }

  static double mean(const std::vector<Played>& all, const std::function<double(const Played&)>& value) {
    double sum = 0.0;
    for (const Played& one : all) sum += value(one);
    return sum / static_cast<double>(all.size());
  }

  // A kind of walk: the key of its limit, its command for a speed, and what a robot made good of it. The
  // limit has the unit of a thousandth of the speed's.
  struct Walk {
    const char* limit;
    std::function<std::string(double)> command;
    std::function<double(const Played&)> made_good;
    const char* unit;
  };
  static Walk forward() {
    return {"highest_velocity_forward_mm_per_s", [](double speed) { return walk_command(speed, 0, 0); },
            [](const Played& one) { return one.speed_m_per_s[0]; }, "m/s"};
  }
  static Walk sideways() {
    return {"highest_velocity_lateral_mm_per_s", [](double speed) { return walk_command(0, speed, 0); },
            [](const Played& one) { return one.speed_m_per_s[1]; }, "m/s"};
  }
  static Walk turning() {
    return {"highest_turn_mrad_per_s", [](double speed) { return walk_command(0, 0, speed); },
            [](const Played& one) { return one.turn_rad_per_s; }, "rad/s"};
  }

  double highest(const Walk& walk) const { return 1e-3 * values_->value(walk.limit); }

  // Climbs levels of an eighth of the limit, from a quarter of it on, while no robot is lost and all make
  // good half of the speed in the mean. Returns the last speed, or nothing, with the figure or the cause.
  std::optional<double> fastest(const Walk& walk, Rung& rung) const {
    constexpr double kLeastShare = 0.5;
    std::optional<double> best;
    for (int level = 2; level <= 8; ++level) {
      const double speed = 0.99 * highest(walk) * level / 8.0;
      const std::vector<Played> all = play_rung(walk.command(speed), walk_s());
      const double good = mean(all, walk.made_good);
      const bool lost = losses(all, State::kWalking) > 0;
      if (lost || good < kLeastShare * speed) {
        if (!best)
          fail(rung,
               lost ? fmt::format("told {:.3f} {}, {}", speed, walk.unit, cause_of(all, State::kWalking))
                    : fmt::format("told {:.3f} {}, the robots make good {:.3f}", speed, walk.unit, good));
        break;
      }
      best = speed;
      reach(rung, fmt::format("{0} of {0} robots told {1:.3f} {3} make good {2:.3f} {3}", all.size(), speed,
                              good, walk.unit));
    }
    return best;
  }

  void walk(Rung& rung) {
    const double wanted = 0.5 * highest(forward());
    walked_m_per_s_ = fastest(forward(), rung);
    if (!walked_m_per_s_ || *walked_m_per_s_ < wanted) {
      search(wanted);
      walked_m_per_s_ = fastest(forward(), rung);
    }
    write_values(factors_);  // go.yaml walks at this speed
  }
  void sidestep(Rung& rung) { fastest(sideways(), rung); }
  void turn(Rung& rung) { fastest(turning(), rung); }

  // --- Search

  struct Score {
    double value = 0.0;
    bool carries_all = false;  // no robot is lost
  };

  // How well robots of the search walk: those that are lost count by how long they last, the others by what
  // they make good of the speed and how little they lean.
  Score score(double forward_m_per_s) const {
    constexpr std::size_t kRobots = 3;
    const std::vector<Played> all =
        play_all(walk_command(forward_m_per_s, 0, 0), walk_s(), kSearchSeed, kRobots);
    double sum = 0.0;
    for (const Played& one : all) {
      const double good = forward_m_per_s > 0.0 ? std::min(1.0, one.speed_m_per_s[0] / forward_m_per_s) : 1.0;
      const bool walks = !one.lost && one.state == State::kWalking;
      sum += walks ? 1.0 + 0.5 * good - one.lean_rad : 0.9 * std::clamp(one.at_s / walk_s(), 0.0, 1.0);
    }
    return {sum / kRobots, losses(all, State::kWalking) == 0};
  }

  // Tries other factors, at random and ever closer around the best, until they carry all robots and a number
  // of candidates has brought nothing more. Half of the time that is left is for it.
  void search(double forward_m_per_s) {
    constexpr std::size_t kPatience = 25;
    const Clock clock = clock_.half();
    sim_board::RandomStream random(1, "bring-up");
    StartFactors best = factors_;
    Score best_score = score(forward_m_per_s);
    std::size_t since = 0;
    for (std::size_t i = 0; i < kMostCandidates && !clock.is_over(); ++i, ++since) {
      if (best_score.carries_all && since >= kPatience) break;
      const double width = best_score.carries_all ? 0.3 : 1.0;
      const auto about = [&](double value, double reach, double low, double high) {
        return std::clamp(value + width * reach * (2.0 * random.uniform() - 1.0), low, high);
      };
      const StartFactors candidate{.com_height = about(best.com_height, 0.08, 0.85, 1.05),
                                   .step_time = about(best.step_time, 0.3, 0.6, 1.8),
                                   .compliance = about(best.compliance, 0.6, 0.0, 2.5),
                                   .gains = about(best.gains, 0.6, 0.0, 2.5),
                                   .trunk_pitch_deg = about(best.trunk_pitch_deg, 5.0, -8.0, 12.0)};
      try {
        write_values(candidate);
      } catch (const InputError&) {
        continue;  // out of the legs' reach
      }
      ++result_.searched;
      const Score candidate_score = score(forward_m_per_s);
      if (candidate_score.value <= best_score.value) continue;
      best_score = candidate_score;
      best = candidate;
      since = 0;
      progress_(fmt::format("search {}: score {:.2f} with {}", i + 1, best_score.value, factors_text(best)));
    }
    factors_ = best;
    write_values(best);
  }

  static std::string factors_text(const StartFactors& factors) {
    return fmt::format(
        "CoM height x {:.3f}, step time x {:.3f}, compliance x {:.2f}, gains x {:.2f}, lean {:+.1f} degrees",
        factors.com_height, factors.step_time, factors.compliance, factors.gains, factors.trunk_pitch_deg);
  }

  std::string page() const {
    std::string text = fmt::format(
        "# {}\n\n{}, with seeds {} to {} in worlds `{}`, stepper `{}`.\n\n| rung | reached | figure, or "
        "cause |\n| --- | --- | --- |\n",
        model_ ? model_->robot : robot_.name, origin_, options_.first_seed,
        options_.first_seed + options_.seeds - 1, options_.world, options_.stepper);
    for (const Rung& rung : result_.rungs) {
      const char* reached = rung.result == Rung::Result::kReached  ? "yes"
                            : rung.result == Rung::Result::kFailed ? "**no**"
                                                                   : "not tried";
      text += fmt::format("| {} | {} | {} |\n", rung.name, reached,
                          rung.cause.empty() ? rung.figure : rung.cause);
    }
    text += fmt::format("\nThe start values are scaled from {}", reference_.robot.text);
    if (result_.searched > 0)
      text += fmt::format("; a search over {} candidates changed them: {}", result_.searched,
                          factors_text(factors_));
    return text + ".\n\n    koboshi run go.yaml\n";
  }

  const BringUpOptions& options_;
  const std::function<void(const std::string&)>& progress_;
  const Clock clock_;
  const std::filesystem::path folder_;
  const sim_board::RobotDescription robot_;
  const simulation::RobotParameters reference_;
  const BodyMeasures reference_body_;
  const std::string origin_;
  std::optional<simulation::NamedModel> model_;
  std::optional<StartValues> values_;
  StartFactors factors_;
  std::optional<double> walked_m_per_s_;
  BringUpResult result_;
};

}  // namespace

BringUpResult bring_up(const BringUpOptions& options,
                       const std::function<void(const std::string&)>& progress) {
  return Ladder(options, progress).run();
}

std::vector<std::string> rung_names() {
  std::vector<std::string> names;
  for (const auto& [name, climb] : Ladder::rungs()) names.emplace_back(name);
  return names;
}

std::string ladder_text(const BringUpResult& result) {
  std::string text;
  for (const Rung& rung : result.rungs) {
    const char* mark = rung.result == Rung::Result::kReached  ? "yes"
                       : rung.result == Rung::Result::kFailed ? "NO"
                                                              : "-";
    text += fmt::format("{:24} {:4} {}\n", rung.name, mark, rung.cause.empty() ? rung.figure : rung.cause);
  }
  return text;
}

}  // namespace koboshi::tools
