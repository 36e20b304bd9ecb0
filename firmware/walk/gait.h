#pragma once

#include <array>
#include <cstdint>

#include "firmware/walk/body.h"
#include "firmware/walk/footsteps.h"
#include "firmware/walk/velocity.h"

namespace koboshi::walk {

// Parameters of the walk, as the object dictionary holds them. Lengths in 0.1 mm, angles in 2^-16 turn,
// shares in permille. A walk takes a change within two steps (Walker). 0 in a value that the dictionary
// does not allow to be 0 means that it is not set. The values belong to the robot:
// robots/ROBOT/parameters.yaml.
struct WalkParameters {
  struct Steps {
    std::int16_t time_ms = 0;         // cut down to whole cycles of 10 ms
    std::int16_t double_support = 0;  // share of a step in double support
    std::int16_t width = 0;           // between the middle lines of the soles
    std::int16_t height = 0;          // of the swing foot
    std::int16_t swing_profile =
        0;  // 1000: the swing foot starts and lands without speed; 0: at constant speed
    std::int16_t acceleration[3] = {};  // forward and lateral in mm/s^2, of the turn in mrad/s^2
    // Limits of the swing foot's landing position relative to the support foot: within reach of the legs, and
    // no collision of the soles.
    std::int16_t max_forward = 0;  // in front and behind
    std::int16_t max_lateral = 0;
    std::int16_t min_lateral = 0;
    // Servos that yield shorten a step; the loss is added to its plan: a share of it backward and to the
    // side, and a length in each step forward, by which the feet of a robot that steps on the spot land
    // behind.
    std::int16_t lengthening = 0;
    std::int16_t forward_offset = 0;

    friend bool operator==(const Steps&, const Steps&) = default;
  } step;  // 0x2130
  struct Posture {
    std::int16_t com_height = 0;   // of the CoM above the soles: the length of the pendulum
    std::int16_t zmp_forward = 0;  // of the planned ZMP, in front of the ankle
    std::int16_t zmp_inward = 0;   // of the planned ZMP, from the sole's middle line towards the other foot
    std::int16_t trunk_pitch = 0;  // forward lean
    std::int16_t trunk_pitch_by_speed = 0;  // more of it for each m/s forward
    // Sag of the servos under the robot's weight, mrad for each metre of lever: hip, knee and ankle in pitch,
    // hip and ankle in roll.
    std::int16_t pitch_compliance = 0;
    std::int16_t roll_compliance = 0;
    std::int16_t arm_swing = 0;  // of a shoulder, mrad for each metre that the other side's foot is in front
    // 1: the plan takes waist, arms and head at joint zero; 0: where they are.
    std::int16_t fixed_upper_body = 0;

    friend bool operator==(const Posture&, const Posture&) = default;
  } posture;  // 0x2131
  struct Reactions {
    // Share of the measured DCM error by which the landing position moves.
    std::int16_t capture_forward = 0;
    std::int16_t capture_lateral = 0;
    std::int16_t dead_band = 0;          // of the DCM error
    std::int16_t smoothing = 0;          // share of the last cycle's DCM error that is kept
    std::int16_t touchdown_load_cN = 0;  // on the swing foot, which ends a step early; 0: no load does
    std::int16_t heading_hold = 0;       // share of the heading error by which a step turns back
    // From the plan to its measurement: servos, sensors and estimation. 0: the DCM is not compared.
    std::int16_t plan_age_ms = 0;
    std::int16_t level_swing = 0;  // share of the trunk's lean against which the swing foot's sole is level
    // Share of the DCM error by which the ZMP under the sole moves, and how far.
    std::int16_t zmp_tracking_forward = 0;
    std::int16_t zmp_tracking_lateral = 0;
    std::int16_t max_zmp_shift_forward = 0;
    std::int16_t max_zmp_shift_lateral = 0;
    // Forward and backward distance of the DCM from the planned ZMP beyond which a robot that stands takes
    // steps; 0: it takes none.
    std::int16_t max_standing_dcm = 0;
    std::int16_t pushed_step_time_ms = 0;  // step time of these steps; 0: as in a walk
    // Angle by which both arms turn back for each metre of the forward DCM error beyond the dead band, 0.01
    // rad/m.
    std::int16_t arm_reaction = 0;

    friend bool operator==(const Reactions&, const Reactions&) = default;
  } reaction;  // 0x2132

  friend bool operator==(const WalkParameters&, const WalkParameters&) = default;
};

// A length parameter, which is in 0.1 mm.
[[nodiscard]] fixed::Length tenths_of_mm(std::int16_t value);

// Returns whether everything is set that a walk cannot do without, and the limits of the landing position are
// in order.
[[nodiscard]] bool is_gait(const WalkParameters& parameters);

// The quantities that shape the poses of a walk. After a change, the poses approach the new ones gradually.
struct Carriage {
  fixed::Length com_height;
  fixed::Angle pitch;
  fixed::Angle pitch_at_1_m_per_s;  // beside it
  Compliance compliance;
  fixed::Ratio arm_swing;  // rad/m
};

// The parameters as quantities, computed at the start of a walk and with each change.
struct Gait {  // Large: one quantity for each parameter
  Gait() : Gait(WalkParameters()) {}
  explicit Gait(const WalkParameters& parameters);

  std::int32_t step_ticks;
  fixed::Ratio step_s;        // the same as a time
  std::int32_t double_ticks;  // of them, in double support
  fixed::Length step_width;
  fixed::Length step_height;
  fixed::Ratio swing_profile;
  std::array<std::int32_t, 3> acceleration;  // as in Speed
  fixed::Length max_forward;
  fixed::Length max_lateral;
  fixed::Length min_lateral;
  fixed::Ratio lengthening;
  fixed::Length forward_offset;
  fixed::Length zmp_forward;
  fixed::Length zmp_inward;
  Carriage carriage;
  bool follows_upper_body;
  fixed::Ratio capture_forward;
  fixed::Ratio capture_lateral;
  fixed::Length dead_band;
  fixed::Ratio smoothing;
  fixed::Force touchdown_load;
  fixed::Ratio heading_hold;
  std::int32_t plan_age_ticks;
  fixed::Ratio level_swing;
  fixed::Ratio level_fade;  // in a cycle after the landing: of it all within five
  fixed::Ratio zmp_tracking_forward;
  fixed::Ratio zmp_tracking_lateral;
  fixed::Length max_zmp_shift_forward;
  fixed::Length max_zmp_shift_lateral;
  fixed::Gain arm_reaction;  // rad/m
};

// The velocity of the walk, which follows the command within the gait's accelerations.
class Speed {
 public:
  // Advances by one cycle towards the command.
  void approach(const Velocity& command, const Gait& gait);
  [[nodiscard]] bool is_zero() const { return values_ == std::array<std::int32_t, 3>{}; }
  [[nodiscard]] Stride stride(const Gait& gait) const;
  // Planned forward lean of the trunk at this velocity.
  [[nodiscard]] fixed::Angle lean(const Carriage& carriage) const;
  // Turn of the robot in one cycle.
  [[nodiscard]] fixed::Angle turn() const;

 private:
  std::array<std::int32_t, 3> values_{};  // forward and left in 0.01 mm/s, turn in 0.01 mrad/s
};

}  // namespace koboshi::walk
