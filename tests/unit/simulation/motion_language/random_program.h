#pragma once

#include <fmt/core.h>

#include <array>
#include <cstdlib>
#include <random>
#include <string>

#include "simulation/motion_language/parse/sensors.h"
#include "tests/unit/simulation/motion_language/motion_fixture.h"

namespace koboshi::simulation {

// Writes random motion files of version 2: named, derived, mirrored, Cartesian and inline poses; moves by
// time and by speed, with every interpolation, pauses and settings of their own; waits, loops, branches,
// jumps, routines and exits; expressions and conditions; mixes, leans, stiffness, gains and windows; and the
// low-level steps. One in three does not compile: it needs too many variables, or lets no time pass.
class RandomProgram {
 public:
  explicit RandomProgram(std::uint32_t seed) : random_(seed) {}

  std::string text() {
    std::string text = "version: 2\nrobot: koboshi\nname: r\nvariables: {a: 0, b: -7, c: 2147483647}\n";
    if (flip()) text += "interpolation: " + one_of("linear", "minimum_jerk", "trapezoid") + "\n";
    const bool has_exit = flip();
    if (has_exit) text += "exit: way_out\n";
    text += "poses:\n  p0: {others: zero}\n";
    for (pose_count_ = 1; pose_count_ < 5; ++pose_count_)
      text += fmt::format("  p{}: {}\n", pose_count_, pose());
    text +=
        "routines:\n  inner:\n" + steps(4, 2, false) + "  outer:\n    - {call: inner}\n" + steps(4, 2, true);
    text += "steps:\n  - {call: outer}\n" + steps(2, 3, true);
    return text + (has_exit ? "  - {label: way_out}\n" : "") + (flip() ? "  - fail\n" : "  - {wait_s: 1}\n");
  }

 private:
  int below(int limit) { return static_cast<int>(random_() % static_cast<std::uint32_t>(limit)); }
  bool flip() { return below(2) == 0; }
  template <typename... Texts>
  std::string one_of(Texts... texts) {
    const std::array<std::string, sizeof...(Texts)> all{texts...};
    return all[static_cast<std::size_t>(below(sizeof...(Texts)))];
  }
  std::string joint() {
    return koboshi_model()
        .joint_names[static_cast<std::size_t>(below(static_cast<int>(koboshi_model().joint_names.size())))];
  }
  std::string number() {
    return one_of(std::to_string(below(20'000) - 10'000), "0", "2147483647", "-2147483648");
  }

  std::string pose() {
    if (below(4) == 0) return fmt::format("{{from: p{}, head_pan: {}.25}}", below(pose_count_), below(60));
    if (below(4) == 0) return fmt::format("{{mirror: p{}}}", below(pose_count_));
    if (below(4) == 0) return cartesian_pose();
    std::string text;
    for (std::size_t i = 0; i < koboshi_model().joint_names.size(); ++i) {
      const robot::Joint& limits = koboshi_model().model.joints[i];
      const double share = below(1'000) / 999.0;
      const double raw =
          limits.lower.raw() + share * (static_cast<double>(limits.upper.raw()) - limits.lower.raw());
      if (koboshi_model().joint_names[i] != "head_tilt" && below(3) == 0)
        text += fmt::format("{}: {:.4f}, ", koboshi_model().joint_names[i], raw * 360.0 / 4'294'967'296.0);
    }
    return "{" + text + "head_tilt: 0}";
  }

  // A pose within reach, on both feet or one.
  std::string cartesian_pose() {
    const std::string support = one_of("both", "left", "right");
    std::string text;
    if (flip()) {
      text = fmt::format("{{support: {}, trunk: {{x_mm: {}, z_mm: {}, roll_deg: {}, yaw_deg: {}}}", support,
                         below(20) - 10, 140 + below(18), below(9) - 4, below(9) - 4);
    } else {
      text =
          fmt::format("{{support: {}, com: {{x_mm: {}, z_mm: {}}}", support, below(20) - 5, 125 + below(15));
    }
    if (support == "left") text += fmt::format(", right_foot: {{z_mm: {}}}", below(8));
    if (flip()) text += fmt::format(", left_hand: {{x_mm: {}, z_mm: {}}}", 50 + below(15), 140 + below(20));
    return text + "}";
  }

  std::string source() {
    const Sensor& sensor = kSensors[static_cast<std::size_t>(below(kSensors.size()))];
    if (sensor.index == Sensor::Index::kJoint) return fmt::format("{}({})", sensor.name, joint());
    if (sensor.index == Sensor::Index::kInput) return fmt::format("{}({})", sensor.name, 1 + below(8));
    return std::string(sensor.name);
  }
  std::string value(int depth) {
    if (depth == 0 || below(3) == 0) return one_of(source(), one_of("a", "b", "c"), number());
    if (below(4) == 0)
      return fmt::format("{}({}, {})", one_of("min", "max"), value(depth - 1), value(depth - 1));
    return fmt::format("({} {} {})", value(depth - 1), one_of("+", "-", "*"), value(depth - 1));
  }
  std::string comparison(int depth) {
    return fmt::format("{} {} {}", value(depth), one_of("==", "!=", "<", "<=", ">", ">="), value(depth));
  }
  std::string condition(int depth) {
    if (depth == 0 || below(3) == 0) return comparison(below(2));
    if (below(4) == 0) return "not (" + condition(depth - 1) + ")";
    return fmt::format("({} {} {})", condition(depth - 1), one_of("and", "or"), condition(depth - 1));
  }

  std::string steps(std::size_t indent, int depth, bool may_call) {
    std::string text;
    const std::string label = fmt::format("l{}", labels_++);
    const std::string lead(indent, ' ');
    const int count = 1 + below(4);
    for (int i = 0; i < count; ++i) text += lead + "- " + step(indent, depth, may_call, label) + "\n";
    return text +
           fmt::format("{0}- {{wait_s: 0.{1:03}}}\n{0}- {{label: {2}}}\n", lead, 1 + below(999), label);
  }

  std::string move() {
    const bool own_pose = below(4) == 0;
    std::string text = own_pose
                           ? fmt::format("{{pose: {{head_pan: {}, left_elbow: -{}}}, ", below(60), below(90))
                           : fmt::format("{{pose: p{}, ", below(pose_count_));
    const bool at_least = below(4) == 0;
    const bool by_time = !at_least && flip();
    text += at_least  ? fmt::format("at_least_s: 0.{:03}", 1 + below(999))
            : by_time ? fmt::format("time_s: {}.{:06}", 2 + below(50), below(1'000'000))
                      : fmt::format("speed_deg_per_s: {}.{:04}", below(60), 1 + below(9'999));
    const bool windows = own_pose && by_time && flip();
    if (windows) text += fmt::format(", during: {{head_pan: [{}.{:03}, 2]}}", below(2), below(1'000));
    if (flip())
      text += ", interpolation: " + (at_least || windows
                                         ? one_of("linear", "minimum_jerk", "trapezoid")
                                         : one_of("linear", "minimum_jerk", "cubic", "trapezoid"));
    if (flip()) text += ", pause_s: 0.5";
    if (below(3) == 0) text += ", mirror: true";
    if (below(3) == 0) text += ", lean: {pitch_deg: 12.5}";
    if (below(3) == 0) text += ", stiffness: {arms: 40, head: 70}";
    if (below(3) == 0) text += ", gain: {legs: 60, head: 150}";
    if (below(3) == 0) text += ", mix: {ankle_pitch: {pitch_rate: -0.3, limit_deg: 1}}";
    return text + "}";
  }

  std::string step(std::size_t indent, int depth, bool may_call, const std::string& label) {
    const std::string lead(indent + 4, ' ');
    switch (below(depth > 0 ? 17 : 14)) {
      case 0:
      case 1:
        return move();
      case 2:
        return fmt::format("{{wait: {{until: \"{}\", timeout_s: {}, else: {}}}}}", condition(2),
                           1 + below(60), one_of("fail", "continue", label));
      case 3:
        return fmt::format("{{jump: {}, if: \"{}\"}}", label, condition(2));
      case 4:
        return fmt::format("{{set: {{a: \"{}\", b: \"{}{}\"}}}}", value(2),
                           one_of("+=", "-=", "*=", "min=", "max="), value(1));
      case 5:
        return fmt::format("{{set: {{c: \"{} {}\"}}}}", one_of("/=", "%="), source());
      case 6:
        return fmt::format("{{expect: {{roll_deg: {}, pitch_deg: {}, within_deg: {}}}}}", below(360) - 180,
                           below(180) - 90, 1 + below(179));
      case 7:
        return one_of("{mix: none}", "{lean: none}", "{torque_off: [arms, left_knee]}",
                      "{lean: {roll_deg: -7}}");
      case 8:
        return flip() ? fmt::format("{{stiffness: {{{}: {}}}}}", joint(), below(101))
                      : fmt::format("{{gain: {{{}: {}}}}}", joint(), 1 + below(200));
      case 9:
        return fmt::format("{{mix: {{{}: {{{}: {}, limit_deg: {}}}}}}}", joint(),
                           one_of("roll_rate", "pitch_rate", "yaw_rate", "roll", "pitch"), below(15) - 7,
                           1 + below(15));
      case 10:
        return may_call ? "{call: inner}" : one_of("{wait_s: 0.001}", "return");
      case 11:
        return fmt::format("{{branch: {{to: {}, {}: [\"{} < 5\", \"c != a\"]}}}}", label,
                           one_of("all", "any", "not_all", "not_any"), source());
      case 12:
        return fmt::format("{{await: {{to: {}, {}: [\"{} < b\"], timeout_s: 59.999999}}}}", label,
                           one_of("all", "any", "not_all", "not_any"), source());
      case 13:
        return one_of(fmt::format("{{jump: {}}}", label), "end", "fail");
      case 14:
        return fmt::format("loop:\n{}{}\n{}steps:\n{}", lead, one_of("times: 3", "until: stopped"), lead,
                           steps(indent + 6, depth - 1, may_call));
      case 15:
        return fmt::format("loop:\n{}{}: \"{}\"\n{}steps:\n{}", lead, one_of("while", "until"), condition(1),
                           lead, steps(indent + 6, depth - 1, may_call));
      default: {
        const std::string part(indent + 2, ' ');
        return fmt::format("if: \"{}\"\n{}then:\n{}{}else:\n{}", condition(1), part,
                           steps(indent + 4, depth - 1, may_call), part,
                           steps(indent + 4, depth - 1, may_call));
      }
    }
  }

  std::mt19937 random_;
  int pose_count_ = 1;
  int labels_ = 0;
};

// Returns the number of random motions of a test. KOBOSHI_MOTIONS=10000 runs the long form.
inline int random_motions(int usual) {
  const char* text = std::getenv("KOBOSHI_MOTIONS");
  return text == nullptr ? usual : std::atoi(text);
}

}  // namespace koboshi::simulation
