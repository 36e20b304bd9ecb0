#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim_board/description/description.h"

namespace koboshi::lab {

// A motion by which a robot falls, rolls over or rises (motion::kMotionNames), as a list of poses.
class RecoveryMotion {
 public:
  struct Pose {
    std::string name;
    std::map<std::size_t, double> angles_deg;  // by joint; the others keep their targets
  };
  struct Step {
    std::optional<std::size_t> pose{};  // of a move or a wait; nothing: what `text` says
    double time_s = 0.0;
    bool at_least = false;  // the servos may need longer, from wherever the robot is
    std::string text{};     // an expected attitude, as the motion file has it
  };

  // A variable of a search: the angles of a role on both sides in a pose, or the time of a step.
  struct Variable {
    std::size_t pose = 0;  // or, for a time, the step
    std::string role{};    // without its side: "hip_pitch"; empty: a time
    double reach = 0.0;    // degrees to either side, or the largest factor of the time
  };

  // Gives the motion `name` of the robot `from`, from its folder bring_up or else motions, to the robot `to`:
  // the angles of joints with the same role, within their limits, and times by `time_scale`, but no shorter
  // than the servos need. Where a knee does not bend as far, hip and ankle keep the direction of the leg and
  // the lean of the trunk. A pose named `stand` becomes `standing_deg`. Joints that `to` does not have are
  // dropped and noted. Throws InputError if `from` has no such motion, if it has a step that this class does
  // not know, and as retarget_joints() does.
  static RecoveryMotion retarget(const std::string& name, const std::filesystem::path& from,
                                 const sim_board::RobotDescription& to,
                                 std::span<const std::pair<std::string, double>> standing_deg,
                                 double time_scale);

  // A motion for rising from the back: right arm and leg push their side up until the robot rolls onto its
  // chest, from which it rises as by `rise_prone`. It needs neither knees that bend far nor long arms.
  static RecoveryMotion over_the_side(const RecoveryMotion& rise_prone);

  // Returns the variables of a search: hips, knees, ankles, shoulders and elbows of the poses after the first
  // attitude that is expected, but for the last pose, and the times of these moves.
  [[nodiscard]] std::vector<Variable> variables() const;
  // The motion with other values; `x` in the unit box, by variable: 0.5 leaves a value as it is.
  [[nodiscard]] RecoveryMotion with(std::span<const Variable> variables, std::span<const double> x) const;
  // The motion file; `origin` stands in its first line.
  [[nodiscard]] std::string text(const std::string& origin) const;

  // The motion with the rolls of hips and ankles multiplied, in the poses in which the legs are not spread;
  // the last pose stays. Feet below folded legs touch by them.
  [[nodiscard]] RecoveryMotion with_rolls(double factor) const;
  // The motion with hips that flex by this many degrees less where they flex most; the last pose stays.
  [[nodiscard]] RecoveryMotion with_less_flexion(double by_deg) const;
  // The motion with all times multiplied, but no shorter than the servos need.
  [[nodiscard]] RecoveryMotion with_times(double factor) const;
  // The motion with another time of a step.
  [[nodiscard]] RecoveryMotion with_step_slower_by(std::size_t step, double factor) const;
  // The step on a line of text(), if there is one.
  [[nodiscard]] std::optional<std::size_t> step_of_line(int line) const;

  const std::string& name() const { return name_; }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  RecoveryMotion(std::string name, const sim_board::RobotDescription& robot)
      : name_(std::move(name)), robot_(&robot) {}

  double clamped_deg(std::size_t joint, double angle_deg) const;
  // Clamps all angles; `thigh_share` is the length of the thigh as a share of that of the shank.
  void fit_legs(double thigh_share);
  // Gives each move the time that the servos need for it.
  void slow_down();

  std::string name_;
  const sim_board::RobotDescription* robot_;
  std::vector<Pose> poses_;
  std::vector<Step> steps_;
  std::vector<std::string> notes_;
  std::string how_ = "from that of the reference robot by the roles of the joints";  // it was made
};

}  // namespace koboshi::lab
