#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/behaviour/motion_source.h"
#include "firmware/behaviour/soft_start.h"
#include "firmware/robot/model.h"

namespace koboshi::behaviour {

// Follows joint targets that a program outside the firmware sends, set by set (docs/decision/0041). Each
// joint moves towards its target of the last set, at most at its highest speed and within its limits. When
// the stream ends, the joints return to the standing pose with the ramp of the soft start. No feedback of the
// firmware works against the program: its state lacks the trait kBalances.
class JointStream final : public MotionSource {
 public:
  static constexpr std::uint8_t kFullTorque_percent = 100;

  // The model must outlive the stream.
  explicit JointStream(const robot::RobotModel& model) : model_(model) {}

  // Begins at `targets`, which stay until the first set. `standing`: the pose of the return; both have one
  // angle for each joint. `ramp_rate`: of the return, positive, 2^-12 turn/s.
  void start(std::span<const fixed::Angle> targets, std::span<const fixed::Angle> standing,
             std::int16_t ramp_rate);
  // Follows again from where the return is. Precondition: running().
  void resume();
  // Takes a set, if it follows: a target for each joint, clamped to the joint's limits, and the torque limit
  // of each joint in percent, of which 0 and more than 100 are no limit. Returns whether it follows.
  bool take(std::span<const fixed::Angle> targets, std::span<const std::uint8_t> torques_percent);
  // The joints with a torque limit; bit i: joint i. None during the return.
  [[nodiscard]] std::uint32_t softened() const { return phase_ == Phase::kFollowing ? softened_ : 0; }
  // The torque limit of a joint, 1 to 100 %.
  [[nodiscard]] std::uint8_t torque_percent(std::size_t joint) const {
    return (softened() >> joint & 1u) != 0 ? torques_percent_[joint] : kFullTorque_percent;
  }
  [[nodiscard]] bool following() const { return phase_ == Phase::kFollowing; }

  void advance(std::uint32_t elapsed_us, const motion::Inputs& inputs,
               std::span<fixed::Angle> targets) override;
  void stop() override;
  void abort() override { phase_ = Phase::kEnded; }
  [[nodiscard]] bool running() const override { return phase_ != Phase::kEnded; }

 private:
  enum class Phase : std::uint8_t { kEnded, kFollowing, kReturning };
  using Angles = std::array<fixed::Angle, robot::kMaxJoints>;

  void follow();

  const robot::RobotModel& model_;
  Phase phase_ = Phase::kEnded;
  Angles targets_{};  // of the last cycle
  Angles goals_{};    // of the last set
  Angles standing_{};
  std::uint32_t softened_ = 0;
  std::array<std::uint8_t, robot::kMaxJoints> torques_percent_{};  // of the softened joints
  std::int16_t ramp_rate_ = 0;
  SoftStart return_;
};

}  // namespace koboshi::behaviour
