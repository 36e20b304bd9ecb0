#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/behaviour/motion_source.h"
#include "firmware/walk/velocity.h"
#include "firmware/walk/walker.h"

namespace koboshi::behaviour {

// The walk at the velocity that was commanded last.
class CommandedWalk final : public MotionSource {
 public:
  // The model must outlive the walk.
  explicit CommandedWalk(const robot::RobotModel& model) : model_(model), walker_(model) {}

  // Returns whether the robot has legs that walk.
  [[nodiscard]] bool is_possible() const { return walker_.is_possible(); }
  // Returns the foot that bears the first of the steps which a robot that stands needs to keep its balance;
  // none while its soles are enough.
  [[nodiscard]] static std::optional<hal::Side> needed(const walk::WalkParameters& parameters,
                                                       const estimation::RobotState& robot);
  // As Walker::start.
  void start(const walk::WalkParameters& parameters, std::span<const fixed::Angle> targets,
             std::optional<hal::Side> pushed_to) {
    walker_.start(parameters, targets, pushed_to);
  }
  // Takes a stop back, as Walker::resume.
  void resume() { walker_.resume(); }
  [[nodiscard]] bool stopping() const { return walker_.stopping(); }
  // As Walker::phase.
  [[nodiscard]] std::optional<fixed::Angle> phase() const { return walker_.phase(); }

  // Within the limits of the parameters: the caller has checked it. It takes effect in the next cycle, and is
  // kept from one walk to the next.
  void set_velocity(const walk::Velocity& velocity) { velocity_ = velocity; }
  [[nodiscard]] const walk::Velocity& velocity() const { return velocity_; }

  // Returns the joints that it moves; bit i: joint i.
  [[nodiscard]] std::uint32_t joints() const;

  void advance(std::uint32_t elapsed_us, const motion::Inputs& inputs,
               std::span<fixed::Angle> targets) override;
  void stop() override { walker_.stop(); }
  void abort() override { walker_.abort(); }
  [[nodiscard]] bool running() const override { return walker_.running(); }
  [[nodiscard]] Plan plan() const override {
    return {.lean = {.roll = {}, .pitch = walker_.pitch()},
            .pitch = walker_.pitch(),
            .zmp = walker_.planned_zmp(),
            .swing = walker_.swing_foot(),
            .support = walker_.support(),
            .reference = walker_.reference(),
            .dcm_error = walker_.dcm_error(),
            .error_percent = walker_.error_percent(),
            .feedback = balance::FeedbackMode::kWalking};
  }

 private:
  const robot::RobotModel& model_;
  walk::Walker walker_;
  walk::Velocity velocity_;
};

}  // namespace koboshi::behaviour
