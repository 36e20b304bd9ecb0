#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/fixed/literals.h"
#include "firmware/walk/body.h"
#include "firmware/walk/footsteps.h"
#include "firmware/walk/gait.h"
#include "firmware/walk/pendulum.h"

namespace koboshi::walk {

// What the sensors tell of the trunk and the feet.
struct Observation {
  fixed::Angle roll;
  fixed::Angle pitch;
  robot::Vector<fixed::AngularRate> rates;  // in the trunk's axes, free of bias
  std::array<fixed::Force, 2> loads{};      // of the feet, by Side
};

// Walks by the linear inverted pendulum: while one foot stands the mass falls away from it, and the other is
// put down where that makes the motion the wanted one (Englsberger, Ott and Albu-Schaeffer, 2015). All is
// planned a cycle at a time, so that velocity and footholds may change in any.
class Walker {
 public:
  // The model must outlive this. One without joints must not be walked.
  explicit Walker(const robot::RobotModel& model);

  // From standing at `targets`, to which it comes back in the end.
  void start(const WalkParameters& parameters, std::span<const fixed::Angle> targets);
  // Slows down, puts the feet side by side and comes to an end.
  void stop() { stopping_ = true; }
  // Takes the stop back; it has no effect once the feet are side by side.
  void resume() { stopping_ = false; }
  void abort() { phase_ = Phase::kIdle; }
  // The next cycle of 10 ms.
  void advance(const Velocity& command, const Observation& seen);

  [[nodiscard]] bool running() const { return phase_ != Phase::kIdle; }
  [[nodiscard]] std::span<const fixed::Angle> targets() const {
    return {targets_.data(), model_.joint_count};
  }
  // How far the trunk is to lean ahead.
  [[nodiscard]] fixed::Angle pitch() const { return stance_.pitch; }

 private:
  using Angles = std::array<fixed::Angle, robot::kMaxJoints>;

  enum class Phase : std::uint8_t {
    kIdle,
    kPreparing,    // from standing to the knees bent
    kWeightShift,  // both soles rest; the mass goes over to the first foot that is to stand
    kStepping,
    kClosingStep,  // both soles rest; the mass comes back to the middle
    kSettling,     // to standing
  };
  // A shoulder whose arm swings with the foot of the other side.
  struct Shoulder {
    std::uint8_t joint = 0;
    std::int8_t sign = 0;  // of its axis; 0 where there is none
  };

  void enter(Phase phase);
  void run_preparing();
  void run_weight_shift();
  void run_stepping(const Velocity& command, const Observation& seen);
  void run_closing_step();
  void run_settling();

  void observe(const Observation& seen);
  void plan_landing();
  void swing();
  [[nodiscard]] bool has_touched_down(const Observation& seen) const;
  void end_step();
  void stand_on_both(Point zmp);
  void pose();
  void swing_arms();

  [[nodiscard]] Point zmp_under(hal::Side side) const;
  [[nodiscard]] Point middle() const;
  [[nodiscard]] hal::Side swing_side() const { return other(support_); }

  const robot::RobotModel& model_;
  Body body_;
  std::array<Shoulder, 2> shoulders_{};
  Gait gait_;
  Pendulum pendulum_;
  Footsteps footsteps_;

  Phase phase_ = Phase::kIdle;
  bool stopping_ = false;
  std::int32_t tick_ = 0;  // of the phase, or of the step
  hal::Side support_ = hal::Side::kLeft;
  Stance stance_;
  PendulumState com_;
  Point last_zmp_;    // where the ZMP was when the step began
  Foothold liftoff_;  // where the swinging sole was then
  Foothold landing_;
  Point dcm_bias_;   // error of the divergent part, measured
  Point dcm_error_;  // beside it
  Stride stride_;
  Speed speed_;
  fixed::Angle heading_;  // by the gyro, less what was told: how far the robot has turned too much
  Angles standing_targets_{};
  Angles ramp_{};  // the other end of a ramp from or to standing
  Angles targets_{};
};

}  // namespace koboshi::walk
