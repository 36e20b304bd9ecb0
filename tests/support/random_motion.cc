#include "tests/support/random_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace koboshi::test {
namespace {

// Angles in degrees by the robot's joints.
using PoseDeg = std::map<std::string, double>;

const PoseDeg& standing() {
  static const PoseDeg pose{{"left_hip_yaw", 0},
                            {"left_hip_roll", 0},
                            {"left_hip_pitch", -15.9},
                            {"left_knee", 43.72},
                            {"left_ankle_pitch", -27.82},
                            {"left_ankle_roll", 0},
                            {"right_hip_yaw", 0},
                            {"right_hip_roll", 0},
                            {"right_hip_pitch", -15.9},
                            {"right_knee", 43.72},
                            {"right_ankle_pitch", -27.82},
                            {"right_ankle_roll", 0},
                            {"left_shoulder_pitch", 0},
                            {"left_shoulder_roll", 8},
                            {"left_elbow", -20},
                            {"right_shoulder_pitch", 0},
                            {"right_shoulder_roll", -8},
                            {"right_elbow", -20},
                            {"head_pan", 0},
                            {"head_tilt", 0}};
  return pose;
}

// Shares of the motions: with a turned trunk and legs bent differently, and with both legs bent alike; the
// others lift a foot.
constexpr double kTurnedTrunk = 0.25;
constexpr double kLegsAlike = 0.55;  // of the rest

class Generator {
 public:
  explicit Generator(std::uint64_t seed) : engine_(seed) {}

  std::string motion(std::uint64_t seed) {
    if (uniform(0, 1) < kTurnedTrunk) return turned_trunk(seed);
    std::vector<PoseDeg> poses{standing()};
    add_target(poses);
    poses.push_back(standing());
    const bool jerk = uniform(0, 1) < 0.5;
    std::string text = fmt::format("version: 1\nrobot: koboshi\nname: trial_{}\nposes:\n", seed);
    std::string steps = "steps:\n";
    int number = 0;
    const auto add_pose = [&](const PoseDeg& pose) {
      text += fmt::format("  p{}: {{", number);
      for (const auto& [joint, angle_deg] : pose)
        text += fmt::format("{}{}: {:.2f}", joint == pose.begin()->first ? "" : ", ", joint, angle_deg);
      text += "}\n";
      return number++;
    };
    steps += fmt::format("  - {{pose: p{}, time_s: 1.0}}\n", add_pose(standing()));
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const double time_s = uniform(1.2, 3.0);
      const int pieces = jerk ? 10 : 1;
      for (int piece = 1; piece <= pieces; ++piece) {
        const double s = static_cast<double>(piece) / pieces;
        const double way = jerk ? s * s * s * (10.0 - 15.0 * s + 6.0 * s * s) : s;
        PoseDeg between;
        for (const auto& [joint, angle_deg] : poses[i])
          between[joint] = std::lerp(poses[i - 1].at(joint), angle_deg, way);
        steps += fmt::format("  - {{pose: p{}, time_s: {:.3f}}}\n", add_pose(between), time_s / pieces);
      }
      steps += "  - {wait_s: 0.5}\n";
    }
    return text + steps;
  }

 private:
  // Not std::uniform_real_distribution: its numbers differ between libraries.
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1.0p-53);
  }

  // Turns the trunk about all axes above both flat feet and puts the centre of mass somewhere.
  std::string turned_trunk(std::uint64_t seed) {
    std::string stand;
    for (const auto& [joint, angle_deg] : standing()) stand += fmt::format("{}: {:.2f}, ", joint, angle_deg);
    PoseDeg upper;
    add_arms(upper);
    std::string target;
    for (const auto& [joint, angle_deg] : upper) target += fmt::format("{}: {:.2f}, ", joint, angle_deg);
    const double roll = uniform(-10, 10);
    const double pitch = uniform(-12, 22);
    const double yaw = uniform(-12, 12);
    target +=
        fmt::format("trunk: {{roll_deg: {:.1f}, pitch_deg: {:.1f}, yaw_deg: {:.1f}}}, ", roll, pitch, yaw);
    const double x = uniform(-70, 100);
    const double y = uniform(-65, 65);
    const double z = uniform(130, 160);
    target += fmt::format("com: {{x_mm: {:.1f}, y_mm: {:.1f}, z_mm: {:.1f}}}", x, y, z);
    const char* const interpolation = uniform(0, 1) < 0.5 ? "minimum_jerk" : "linear";
    const double there_s = uniform(1.2, 3.0);
    const double back_s = uniform(1.2, 3.0);
    return fmt::format(
        "version: 2\nrobot: koboshi\nname: trial_{}\ninterpolation: {}\nposes:\n  stand: {{{}}}\n"
        "  target: {{from: stand, {}}}\nsteps:\n  - {{pose: stand, time_s: 1.0}}\n"
        "  - {{pose: target, time_s: {:.3f}, pause_s: 0.5}}\n  - {{pose: stand, time_s: {:.3f}, pause_s: "
        "0.5}}\n",
        seed, interpolation, stand.substr(0, stand.size() - 2), target, there_s, back_s);
  }

  void add_arms(PoseDeg& pose) {
    for (const char* const side : {"left", "right"}) {
      const double out = std::string(side) == "left" ? 1.0 : -1.0;
      pose[fmt::format("{}_shoulder_pitch", side)] = uniform(-150, 60);
      pose[fmt::format("{}_shoulder_roll", side)] = out * uniform(10, 90);
      pose[fmt::format("{}_elbow", side)] = uniform(-90, 0);
    }
    pose["head_pan"] = uniform(-60, 60);
    pose["head_tilt"] = uniform(-30, 30);
  }

  void add_target(std::vector<PoseDeg>& poses) {
    PoseDeg pose = standing();
    add_arms(pose);
    const double kind = uniform(0, 1);
    const double knee = uniform(25, 85);
    const double lean = uniform(-12, 22);  // of the trunk, forward
    const double ankle = std::max(-0.5 * knee + uniform(-60, 60) - 4.0, -85.0);
    const double roll =
        kind < kLegsAlike ? uniform(-24, 24) : uniform(19, 32) * (uniform(0, 1) < 0.5 ? -1.0 : 1.0);
    for (const char* const side : {"left", "right"}) {
      pose[fmt::format("{}_knee", side)] = knee;
      pose[fmt::format("{}_ankle_pitch", side)] = ankle;
      pose[fmt::format("{}_hip_pitch", side)] = std::max(-lean - knee - ankle, -85.0);
      pose[fmt::format("{}_hip_roll", side)] = roll;
      pose[fmt::format("{}_ankle_roll", side)] = -roll;
    }
    if (kind < kLegsAlike) {
      poses.push_back(pose);
      return;
    }
    const PoseDeg both_down = pose;
    const char* const lifted = roll > 0 ? "left" : "right";
    const double lift = uniform(12, 35);
    pose[fmt::format("{}_hip_pitch", lifted)] -= lift;
    pose[fmt::format("{}_knee", lifted)] += 2.0 * lift;
    pose[fmt::format("{}_ankle_pitch", lifted)] =
        std::max(pose[fmt::format("{}_ankle_pitch", lifted)] - lift, -88.0);
    poses.insert(poses.end(), {both_down, pose, both_down});
  }

  std::mt19937_64 engine_;
};

}  // namespace

std::string random_motion(std::uint64_t seed) { return Generator(seed).motion(seed); }

std::string trial_scenario(const std::filesystem::path& motion, const std::string& stepper, double duration_s,
                           double step_ms) {
  std::string text = fmt::format(
      "version: 1\nrobot: robots/koboshi/robot.sdf\nmotions: [robots/koboshi/motions/stand.yaml, {}]\n"
      "duration_s: {}\nseed: 1\nphysics: {{stepper: {}, step_ms: {}}}\ninitial:\n  held_until_s: 1.6\n  "
      "joints_deg:\n",
      motion.string(), duration_s, stepper, step_ms);
  for (const auto& [joint, angle_deg] : standing()) text += fmt::format("    {}: {}\n", joint, angle_deg);
  return text + fmt::format("commands:\n  - {{at_s: 0.8, enable: true}}\n  - {{at_s: {}, play: {}}}\n",
                            kTrialPlay_s, motion.stem().string());
}

}  // namespace koboshi::test
