#include "lab/bring_up/rungs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/text/user_units.h"
#include "sim_board/world/foot.h"
#include "simulation/observe/event_words.h"

namespace koboshi::lab {
namespace {

using behaviour::State;

constexpr double kUpright_rad = 0.12;   // of a robot that only stands, on slopes of up to 2 degrees
constexpr double kLeastShare = 0.5;     // of a told speed, to be made good
constexpr double kHoldSettles_s = 0.3;  // of the second of a hold, for bus, servos and sway
constexpr double kHold_s = 1.0;

Rung failed(const char* name, std::string cause) {
  return {.name = name, .result = Rung::Result::kFailed, .figure = {}, .cause = std::move(cause)};
}

// The legs do not reach a motion.
Rung impossible(const char* name, std::string cause) {
  return {.name = name, .result = Rung::Result::kImpossible, .figure = {}, .cause = std::move(cause)};
}

std::string unreached(const TriedRobot& robot, const std::string& motion) {
  const auto found = robot.values().unreached.find(motion);
  return found == robot.values().unreached.end() ? std::string() : found->second;
}

Rung reached(const char* name, std::string figure) {
  return {.name = name, .result = Rung::Result::kReached, .figure = std::move(figure), .cause = {}};
}

// A robot stands on its soles alone.
Rung grounded(const char* name, const std::string& link) {
  return failed(name, link + " touches the ground: its box reaches below the sole");
}

std::string walk_command(double forward_m_per_s, double left_m_per_s, double turn_rad_per_s) {
  return fmt::format("walk: {{forward_m_per_s: {:.4f}, left_m_per_s: {:.4f}, turn_rad_per_s: {:.4f}}}",
                     forward_m_per_s, left_m_per_s, turn_rad_per_s);
}

double mean_made_good(const std::vector<Played>& all, const Walk& walk) {
  double sum = 0.0;
  for (const Played& one : all) sum += walk.made_good(one);
  return sum / static_cast<double>(all.size());
}

// The extent of a sole in its own frame.
struct SoleExtent {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());

  explicit SoleExtent(const sim_board::Foot& foot) {
    for (const Eigen::Vector3d& corner_L : foot.corners_L) {
      const Eigen::Vector2d corner_S = (foot.X_LSole.inverse() * corner_L).head<2>();
      low = low.cwiseMin(corner_S);
      high = high.cwiseMax(corner_S);
    }
  }

  // Distance of a point from the edge; positive inside.
  double margin_m(const Eigen::Vector2d& p_S) const {
    return std::min((p_S - low).minCoeff(), (high - p_S).minCoeff());
  }
};

// Least margins of the robots' CoM and ZMP in the sole over which they hold still, by side.
class HoldWatch {
 public:
  HoldWatch(const sim_board::RobotDescription& robot, double move_s, std::size_t robots)
      : move_s_(move_s), margins_(robots) {
    const auto feet = sim_board::feet_of(robot);
    for (const auto& foot : feet) soles_.emplace_back(*foot);
  }

  MakeWatcher maker() {
    return [this](std::size_t robot) {
      return [this, robot](const simulation::WatchedSimulation& world, double at_s) {
        observe(world.recorder().truth(), at_s, margins_[robot]);
      };
    };
  }

  struct Margins {
    std::array<double, 2> com_m{std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::infinity()};
    std::array<double, 2> zmp_m = com_m;
  };
  // Returns the smallest margins of all robots.
  Margins least() const {
    Margins least;
    for (const Margins& one : margins_) {
      for (std::size_t side = 0; side < 2; ++side) {
        least.com_m[side] = std::min(least.com_m[side], one.com_m[side]);
        least.zmp_m[side] = std::min(least.zmp_m[side], one.zmp_m[side]);
      }
    }
    return least;
  }

 private:
  // The motion goes to the standing pose, over the left foot, holds, over the right foot, and holds.
  std::optional<std::size_t> held_side(double at_s) const {
    const double left_s = 2.0 * move_s_;
    const double right_s = left_s + kHold_s + move_s_;
    if (at_s > left_s + kHoldSettles_s && at_s < left_s + kHold_s) return 0;
    if (at_s > right_s + kHoldSettles_s && at_s < right_s + kHold_s) return 1;
    return std::nullopt;
  }

  void observe(const simulation::GroundTruth& truth, double at_s, Margins& margins) const {
    const auto side = held_side(at_s);
    if (!side) return;
    const Eigen::Isometry3d X_SoleW = truth.X_WSole[*side].inverse();
    const auto margin = [&](const Eigen::Vector3d& p_W) {
      return soles_[*side].margin_m((X_SoleW * p_W).head<2>());
    };
    // Along the vertical of the world, down to the height of the sole.
    Eigen::Vector3d com_W = truth.p_WCom_W;
    com_W.z() = truth.X_WSole[*side].translation().z();
    margins.com_m[*side] = std::min(margins.com_m[*side], margin(com_W));
    const double zmp_m = truth.p_WZmp_W ? margin(*truth.p_WZmp_W) : -std::numeric_limits<double>::infinity();
    margins.zmp_m[*side] = std::min(margins.zmp_m[*side], zmp_m);
  }

  const double move_s_;
  std::vector<SoleExtent> soles_;
  std::vector<Margins> margins_;
};

}  // namespace

// --- TriedRobot

TriedRobot::TriedRobot(RobotFiles files, StartValues values, double move_s,
                       const std::filesystem::path& robot, const TemporaryFolder& scratch)
    : files_(std::move(files)),
      values_(std::move(values)),
      move_s_(move_s),
      robot_(robot),
      scratch_(scratch) {}

double TriedRobot::walk_s() const { return 6.0 * std::max(1.0, values_.time_scale); }

std::shared_ptr<const simulation::PreparedScenario> TriedRobot::prepare(
    const PlayOptions& options, std::vector<Override> overrides) const {
  overrides.push_back({"physics.stepper", options.stepper});
  overrides.push_back({"duration_s", "1000"});
  overrides.push_back(text_override("world", options.world, "world"));
  return prepare_files(files_, robot_, scratch_, overrides);
}

ReadyRobots& TriedRobot::ready(const PlayOptions& options, bool hangs) const {
  const auto found = std::ranges::find_if(kept_, [&](const Kept& kept) {
    return kept.stepper == options.stepper && kept.first_seed == options.first_seed &&
           kept.seeds == options.seeds && kept.hangs == hangs;
  });
  if (found != kept_.end()) return *found->robots;
  std::vector<Override> overrides{{"commands", "[{at_s: 2, enable: true}]"}};
  if (hangs) overrides.push_back({"initial.held_until_s", "900"});
  auto robots = std::make_unique<ReadyRobots>(prepare(options, std::move(overrides)), options.first_seed,
                                              options.seeds, options.jobs, options.go_on);
  return *kept_.emplace_back(options.stepper, options.first_seed, options.seeds, hangs, std::move(robots))
              .robots;
}

// --- Walks

Walk forward_walk() {
  return {"highest_velocity_forward_mm_per_s", "m/s", [](double speed) { return walk_command(speed, 0, 0); },
          [](const Played& one) { return one.speed_m_per_s[0]; }};
}

Walk sideways_walk() {
  return {"highest_velocity_lateral_mm_per_s", "m/s", [](double speed) { return walk_command(0, speed, 0); },
          [](const Played& one) { return one.speed_m_per_s[1]; }};
}

Walk turning_walk() {
  return {"highest_turn_mrad_per_s", "rad/s", [](double speed) { return walk_command(0, 0, speed); },
          [](const Played& one) { return one.turn_rad_per_s; }};
}

// --- Rungs

Rung hang(const TriedRobot& robot, const PlayOptions& options) {
  constexpr const char* kName = "hangs";
  ReadyRobots& robots = robot.hanging(options);
  const std::vector<Played> all = robots.play({}, 3.0);
  for (const Played& one : all) {
    if (!one.touching.empty()) return failed(kName, one.touching);
    if (one.state != State::kStanding)
      return failed(kName, fmt::format("the robot is {}: {}", simulation::name_of(one.state), one.reason));
  }
  const LargestUse sag = largest_use(all, robots.robot(), &JointUse::sag_rad);
  return reached(kName, fmt::format("no links touch; {} follows its target worst, {:.1f} degrees behind",
                                    sag.joint, kDegreesPerRad * sag.value));
}

Rung stand(const TriedRobot& robot, const PlayOptions& options) {
  constexpr const char* kName = "stands";
  ReadyRobots& robots = robot.standing(options);
  const std::vector<Played> all = robots.play({}, 10.0);
  if (losses(all, State::kStanding) > 0) return failed(kName, cause_of(all, State::kStanding));
  if (const std::string link = grounded_link(all); !link.empty()) return grounded(kName, link);
  const double lean_deg = kDegreesPerRad * largest_lean_rad(all);
  if (lean_deg > kDegreesPerRad * kUpright_rad)
    return failed(kName, fmt::format("leans by {:.1f} degrees", lean_deg));
  const LargestUse sag = largest_use(all, robots.robot(), &JointUse::sag_rad);
  return reached(
      kName,
      fmt::format("{0} of {0} robots for 10 s, lean at most {1:.1f} degrees, torque at most "
                  "{2:.0f} % of stall, {3} sags most, by {4:.1f} degrees",
                  all.size(), lean_deg, 100.0 * largest_use(all, robots.robot(), &JointUse::torque).value,
                  sag.joint, kDegreesPerRad * sag.value));
}

TorqueLimits torque_limits(const sim_board::ServoDescription& servo, double low_supply_V) {
  TorqueLimits limits{.peak = std::min(1.0, low_supply_V / servo.supply_V)};
  if (servo.winding) {
    // I^2 R(T) Rth = T - ambient at T = derating, and torque / stall torque = I R0 / V.
    const sim_board::WindingDescription& winding = *servo.winding;
    const double rise_K = winding.derating_C - winding.ambient_C;
    const double hot_ohm = servo.resistance_ohm * (1.0 + winding.copper_per_K * rise_K);
    const double current_A = std::sqrt(rise_K / (winding.thermal_resistance_K_per_W * hot_ohm));
    limits.continuous = std::min(1.0, current_A * servo.resistance_ohm / servo.supply_V);
  }
  return limits;
}

Rung squat(const TriedRobot& robot, const PlayOptions& options) {
  constexpr const char* kName = "squats";
  if (const std::string cause = unreached(robot, "squat"); !cause.empty()) return impossible(kName, cause);
  ReadyRobots& robots = robot.standing(options);
  const double for_s = 7.0 * robot.move_s() + 1.5;
  const std::vector<Played> all = robots.play("play: squat", for_s);
  if (losses(all, State::kStanding) > 0) return failed(kName, cause_of(all, State::kStanding));
  if (const std::string link = grounded_link(all); !link.empty()) return grounded(kName, link);
  const double low_supply_V = 1e-3 * robot.values().value("low_supply_mV");
  for (const Played& one : all) {
    for (std::size_t i = 0; i < one.joints.size(); ++i) {
      const sim_board::JointDescription& joint = robots.robot().joints[i];
      const TorqueLimits limits = torque_limits(joint.servo, low_supply_V);
      if (one.joints[i].torque > limits.peak)
        return failed(
            kName, fmt::format("{} needs {:.0f} % of its stall torque, and {:.0f} % are left at a "
                               "low supply of {:.1f} V",
                               joint.name, 100.0 * one.joints[i].torque, 100.0 * limits.peak, low_supply_V));
      if (limits.continuous && one.joints[i].rms_torque > *limits.continuous)
        return failed(kName,
                      fmt::format("{} needs {:.0f} % of its stall torque in the mean (RMS), and its "
                                  "winding bears {:.0f} %",
                                  joint.name, 100.0 * one.joints[i].rms_torque, 100.0 * *limits.continuous));
    }
  }
  const LargestUse peak = largest_use(all, robots.robot(), &JointUse::torque);
  const LargestUse rms = largest_use(all, robots.robot(), &JointUse::rms_torque);
  return reached(kName,
                 fmt::format("{0} of {0} robots, {1} at most {2:.0f} % of its stall torque, RMS "
                             "{3:.0f} % ({4})",
                             all.size(), peak.joint, 100.0 * peak.value, 100.0 * rms.value, rms.joint));
}

Rung shift_weight(const TriedRobot& robot, const PlayOptions& options) {
  constexpr const char* kName = "shifts its weight";
  if (const std::string cause = unreached(robot, "shift"); !cause.empty()) return impossible(kName, cause);
  ReadyRobots& robots = robot.standing(options);
  HoldWatch watch(robots.robot(), robot.move_s(), options.seeds);
  const std::vector<Played> all =
      robots.play("play: shift", 4.0 * robot.move_s() + 2.0 * kHold_s + 1.5, watch.maker());
  if (losses(all, State::kStanding) > 0) return failed(kName, cause_of(all, State::kStanding));
  if (const std::string link = grounded_link(all); !link.empty()) return grounded(kName, link);
  const HoldWatch::Margins margins = watch.least();
  constexpr std::array<const char*, 2> kSides{"left", "right"};
  for (std::size_t side = 0; side < 2; ++side) {
    const bool is_com = margins.com_m[side] < margins.zmp_m[side];
    const double margin_m = is_com ? margins.com_m[side] : margins.zmp_m[side];
    if (margin_m >= 0.0) continue;
    return failed(kName, fmt::format("over the {} foot the {} is {:.1f} mm beside the sole", kSides[side],
                                     is_com ? "centre of mass" : "ZMP", -kMmPerM * margin_m));
  }
  return reached(kName,
                 fmt::format("{0} of {0} robots over each foot for 1 s, CoM at least {1:.1f} mm and ZMP "
                             "{2:.1f} mm inside of the sole",
                             all.size(), kMmPerM * std::min(margins.com_m[0], margins.com_m[1]),
                             kMmPerM * std::min(margins.zmp_m[0], margins.zmp_m[1])));
}

Rung march(const TriedRobot& robot, const PlayOptions& options) {
  constexpr const char* kName = "steps on the spot";
  const std::vector<Played> all = robot.standing(options).play(walk_command(0, 0, 0), robot.walk_s());
  if (losses(all, State::kWalking) > 0) return failed(kName, cause_of(all, State::kWalking));
  if (const std::string link = grounded_link(all); !link.empty()) return grounded(kName, link);
  return reached(kName, fmt::format("{0} of {0} robots for {1:.0f} s, lean at most {2:.1f} degrees",
                                    all.size(), robot.walk_s(), kDegreesPerRad * largest_lean_rad(all)));
}

WalkRung fastest(const TriedRobot& robot, const PlayOptions& options, const Walk& walk) {
  WalkRung result;
  for (int level = 2; level <= 8; ++level) {
    const double speed = 0.99 * walk.highest(robot.values()) * level / 8.0;
    const std::vector<Played> all = robot.standing(options).play(walk.command(speed), robot.walk_s());
    const double good = mean_made_good(all, walk);
    const bool lost = losses(all, State::kWalking) > 0;
    if (lost || good < kLeastShare * speed) {
      if (!result.speed)
        result.rung = failed(
            "", lost ? fmt::format("told {:.3f} {}, {}", speed, walk.unit, cause_of(all, State::kWalking))
                     : fmt::format("told {:.3f} {}, the robots make good {:.3f}", speed, walk.unit, good));
      break;
    }
    result.speed = speed;
    result.made_good = good;
    result.rung = reached("", fmt::format("{0} of {0} robots told {1:.3f} {3} make good {2:.3f} {3}",
                                          all.size(), speed, good, walk.unit));
  }
  return result;
}

bool walks_at(const TriedRobot& robot, const PlayOptions& options, const Walk& walk, double speed) {
  const std::vector<Played> all = robot.standing(options).play(walk.command(speed), robot.walk_s());
  return losses(all, State::kWalking) == 0 && mean_made_good(all, walk) >= kLeastShare * speed;
}

}  // namespace koboshi::lab
