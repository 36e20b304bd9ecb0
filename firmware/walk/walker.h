#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/fixed/literals.h"
#include "firmware/walk/arms.h"
#include "firmware/walk/body.h"
#include "firmware/walk/footsteps.h"
#include "firmware/walk/gait.h"
#include "firmware/walk/pendulum.h"

namespace koboshi::walk {

// The measured divergent component of motion (DCM), in the frame of a foot's sole.
struct MeasuredDcm {
  Point p;
  hal::Side sole = hal::Side::kLeft;
};

// The measured motion of the trunk and the loads of the feet in one cycle.
struct Observation {
  fixed::Angle roll;                  // positive to the right
  fixed::Angle pitch;                 // positive forward
  fixed::Angle turn;                  // change of the trunk's heading in this cycle, counter-clockwise
  hal::BySide<fixed::Force> loads{};  // of the feet
  // If it is known: in the frame of reference()'s sole, or it is not used.
  std::optional<MeasuredDcm> dcm{};
  std::span<const fixed::Angle> angles{};  // measured, of all joints; empty: as the targets
};

// The ZMP of the plan, in the frame of a foot's sole.
struct PlannedZmp {
  Point p;
  hal::Side sole = hal::Side::kLeft;
};

// Generates the joint targets of a walk at a commanded velocity, one control cycle of 10 ms at a time.
//
// The centre of mass (CoM) is a linear inverted pendulum above the ZMP (pendulum.h). Its divergent component
// of motion (DCM) runs away from the support foot, and the landing position of the swing foot is what steers
// it: plan_landing() chooses the one from which the next step begins with the DCM of a periodic gait
// (Englsberger, Ott and Albu-Schaeffer, "Three-dimensional bipedal walking control based on divergent
// component of motion", T-RO 2015). The plan is made anew in every cycle, so velocity and landing position
// may change at any time.
//
// clang-format off
//   phase         lasts                 what happens
//   Preparing     50 ms for legs        the first inverse kinematics; the robot stands
//                 without a closed
//                 form, else nothing
//   WeightShift   at most 0.6 s         double support with the ZMP under the foot that swings first, until
//                                       the DCM is where the first step begins; the standing pose fades
//                                       into bent knees, for 0.25 s from here on
//   Stepping      until a stop at zero  double support, then swing, in turn; it ends when the feet stand
//                 speed                 side by side
//   ClosingStep   at most 0.6 s, then   double support: the ZMP stays under the support foot until the DCM
//                 3 T_c                 is midway between the feet, then the ZMP and the DCM rest there
//                                       while the CoM follows (T_c: time constant of the pendulum)
//   Settling      0.7 s                 a ramp back to the standing targets, and time for the servos to follow
// clang-format on
//
// All positions are in the frame of the support foot's sole: x forward, y to the left. When a foot lands,
// end_step() moves everything into its frame; no position in the world is kept.
class Walker {  // Large: the plan of a step is one state, which the phases advance in turn
 public:
  // `model` must outlive the walker; a walk needs one with legs.
  explicit Walker(const robot::RobotModel& model);

  // Returns whether the legs can walk.
  [[nodiscard]] bool is_possible() const { return body_.has_legs(); }
  // Begins a walk from standing at `targets`, one angle a joint, to which it returns in the end. `parameters`
  // must be a gait (walk::is_gait), and outlive the walk. The walk takes changes of them with its next step
  // but one, except those that leave no gait. What does not belong to the plan of a step (Carriage) goes
  // over to its new value within a quarter of a second, so that no joint jumps.
  // `pushed_to`: the robot was pushed to this side. The foot there bears it in the first step, the steps have
  // a time of their own (2132:0E), and the walk ends as after stop(), unless resume() makes it an ordinary
  // one.
  void start(const WalkParameters& parameters, std::span<const fixed::Angle> targets,
             std::optional<hal::Side> pushed_to = std::nullopt);
  // Brings the robot to a stand: it slows down, puts its feet side by side and ends the walk.
  void stop() { stopping_ = true; }
  bool stopping() const { return stopping_; }
  // Takes the stop back. Once the closing step has begun, the walk ends all the same, with stopping() false.
  void resume() { stopping_ = pushed_ = false; }
  // Ends the walk at once; the targets stay as they are.
  void abort() {
    phase_ = Phase::kIdle;
    error_percent_.reset();
  }
  // Computes the targets of the next cycle.
  void advance(const Velocity& command, const Observation& seen);

  [[nodiscard]] bool running() const { return phase_ != Phase::kIdle; }
  [[nodiscard]] std::span<const fixed::Angle> targets() const {
    return {targets_.data(), model_.joint_count};
  }
  // The ZMP that is planned for the end of this cycle. Empty while the walk begins and ends with a ramp.
  [[nodiscard]] std::optional<PlannedZmp> planned_zmp() const;
  // The foot that is planned in the air; none in double support.
  [[nodiscard]] std::optional<hal::Side> swing_foot() const {
    const bool swings = phase_ == Phase::kStepping && tick_ > gait_.double_ticks;
    return swings ? std::optional(swing_side()) : std::nullopt;
  }
  // The foot that bears the robot by the plan; none while both do for longer than between two steps.
  [[nodiscard]] std::optional<hal::Side> support() const {
    return phase_ == Phase::kStepping ? std::optional(support_) : std::nullopt;
  }
  // The DCM that was planned for the moment of the next measurement, and the foot in whose frame it is: for a
  // while after a landing it is still the other one. None outside of a walk and of a comparison.
  [[nodiscard]] std::optional<MeasuredDcm> expected_dcm() const;
  [[nodiscard]] std::optional<hal::Side> reference() const {
    const auto expected = expected_dcm();
    return expected ? std::optional(expected->sole) : std::nullopt;
  }
  // The measured DCM less the planned one, in the frame of the foot that bears the robot; none unless they
  // are compared.
  [[nodiscard]] std::optional<Point> dcm_error() const {
    return reference() ? std::optional(dcm_error_) : std::nullopt;
  }
  // The DCM error in percent of the greatest one that the next steps catch; none unless the robot steps, or
  // shifts its weight for the first step, and the error is measured. 0 within the dead band. Saturates.
  // Derivation in walker.cc.
  [[nodiscard]] std::optional<std::uint16_t> error_percent() const { return error_percent_; }
  // The phase of the walk: half a turn for each step, that of the left support foot first. None while the
  // walk does not step.
  [[nodiscard]] std::optional<fixed::Angle> phase() const;
  // The planned forward lean of the trunk.
  [[nodiscard]] fixed::Angle pitch() const { return stance_.pitch; }

 private:
  static constexpr std::size_t kMaxPlanAge = 20;  // cycles

  using Angles = std::array<fixed::Angle, robot::kMaxJoints>;

  enum class Phase : std::uint8_t {
    kIdle,
    kPreparing,
    kWeightShift,
    kStepping,
    kClosingStep,
    kSettling,
  };
  // What a landing needs to know of the gait that begins with it.
  struct Landing {
    Footsteps footsteps;
    fixed::Length zmp_forward;  // as in Gait
    fixed::Length zmp_inward;
  };
  // The plan of one cycle.
  struct Planned {
    Point dcm;
    hal::Side support = hal::Side::kLeft;
    std::uint8_t tick = 0;  // of the step; 0 outside of a step
  };
  void enter(Phase phase);
  [[nodiscard]] WalkParameters wanted() const;
  void use(const WalkParameters& parameters);
  [[nodiscard]] static Landing landing_for(const Gait& gait, const Pendulum& pendulum);
  // At the beginning of a step: notes changed parameters, if they are a gait, for the step after it.
  void look_for_changes();
  void use_changes();
  void carry();
  void run_preparing();
  void begin_weight_shift();
  void run_weight_shift();
  void run_stepping(const Velocity& command, const Observation& seen);
  void run_closing_step();
  void run_settling();

  // Updates the DCM error and the heading error.
  void observe(const Observation& seen);
  void compare(const MeasuredDcm& measured);
  [[nodiscard]] const Planned& compared_plan() const;
  // Keeps the plan of this cycle, for the comparison with a later measurement.
  void remember();
  // The part of the DCM error that the next foothold takes up.
  [[nodiscard]] Point captured() const;
  // Shift of the ZMP against the DCM error, as far as the sole reaches.
  [[nodiscard]] Point zmp_shift() const;
  void level_soles();
  void judge_error();
  void plan_landing();
  void move_swing_foot();
  [[nodiscard]] bool has_touched_down(const Observation& seen) const;
  void end_step();
  // Distributes the load for double support with the ZMP there, and poses.
  void stand_on_both(Point zmp);
  // Writes the targets of legs and arms for the stance.
  void pose();
  void blend();

  [[nodiscard]] Point zmp_under(hal::Side side) const;
  [[nodiscard]] Point middle() const;
  [[nodiscard]] hal::Side swing_side() const { return other(support_); }

  const robot::RobotModel& model_;
  Body body_;
  Arms arms_;
  const WalkParameters* parameters_ = nullptr;  // of the caller
  WalkParameters in_force_;
  std::optional<WalkParameters> changes_;  // of which the present step prepares the next one
  Gait gait_;
  Carriage carriage_;  // that of the gait, or on its way there
  std::int32_t carriage_ticks_left_ = 0;
  Pendulum pendulum_;
  Footsteps footsteps_;
  Landing landing_on_;  // of the step that follows

  Phase phase_ = Phase::kIdle;
  bool stopping_ = false;
  bool pushed_ = false;
  // Cycles since the phase or the step began; in the closing step, since the ZMP has been midway.
  std::int32_t tick_ = 0;
  hal::Side support_ = hal::Side::kLeft;
  Stance stance_;
  PendulumState com_;
  Point last_zmp_;  // the ZMP at the beginning of the step, or midway once the closing step has put it there
  Foothold liftoff_;                                // of the swing foot's sole, at the beginning of the step
  Foothold landing_;                                // planned, of the same sole
  std::array<Planned, kMaxPlanAge + 1> history_{};  // the plans of the last cycles, as a ring
  std::size_t newest_ = 0;
  // The mean of the error in each cycle of a step: slopes, sagging servos, errors of the model; not pushes.
  std::array<hal::BySide<Point>, Pendulum::kMaxTicks + 1> dcm_means_{};
  std::optional<std::uint16_t> error_percent_;  // of this cycle, since it is asked for more than once
  Point dcm_error_;  // measured DCM less the DCM planned for its moment, without the mean; smoothed
  // The trunk's lean, measured less planned, and its slow mean: roll to the right and pitch forward.
  Tilt lean_;
  Tilt lean_mean_;
  fixed::Ratio swing_phase_;            // 0 to 1, of the present or the last swing
  hal::BySide<fixed::Ratio> levels_{};  // how far each sole is held level against the lean
  std::int32_t last_steps_ = 0;         // on the spot, of a robot that is to stop
  Stride stride_;                       // commanded, with the lengthening and the correction of the heading
  Speed speed_;
  fixed::Angle heading_error_;  // observed less commanded turn; positive to the left
  Angles standing_targets_{};
  Angles standing_offsets_{};  // from the first pose of the plan to that at the start
  std::int32_t blend_ticks_left_ = 0;
  Angles ramp_{};  // the beginning of the ramp of kSettling
  Angles targets_{};
};

}  // namespace koboshi::walk
