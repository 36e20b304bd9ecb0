#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/motion/instructions.h"
#include "firmware/motion/motion.h"
#include "firmware/robot/model.h"

namespace koboshi::motion {

// The targets of all joints within one step of a motion. A move takes the joints of its pose from where they
// are to the pose, the others stay. For the elapsed fraction s of its time T:
//
//   linear:        p0 + (p1 - p0) s
//   minimum jerk:  p0 + (p1 - p0) (10 s^3 - 15 s^4 + 6 s^5)
//   trapezoid:     p0 + (p1 - p0) (9/4 s^2 up to s = 1/3, 3/2 s - 1/4 up to 2/3, 1 - 9/4 (1 - s)^2)
//   cubic:         p0 + (p1 - p0) (3 s^2 - 2 s^3) + T v0 (s^3 - 2 s^2 + s) + T v1 (s^3 - s^2)
//
// The velocity v1 at the end of a cubic is zero unless another cubic follows that moves the joint on in the
// same direction; v0 is the v1 of the cubic before. With the mean speeds d1 = (p1 - p0) / T1 and d2 of the
// next one, it is their weighted harmonic mean (Fritsch and Butland, "A method for constructing local
// monotone piecewise cubic interpolants", SIAM J. Sci. Stat. Comput. 5, 1984):
//
//   v1 = d1 d2 / (a d2 + (1 - a) d1),  a = (T1 + 2 T2) / (3 (T1 + T2)),
//
// with which the joint never overshoots a pose.
class Trajectory {
 public:
  // All joints rest at zero, clamped to their limits. The model must outlive the trajectory.
  explicit Trajectory(const robot::RobotModel& model);

  // All joints rest at `pose`, one angle for each, clamped to their limits.
  void reset(std::span<const fixed::Angle> pose);

  // Returns the time in which `interpolation` covers `travel`, 2^-32 turn, at this peak speed, 2^-24 turn/s
  // and above 0; kMinStepTime_us to kMaxStepTime_us.
  [[nodiscard]] static std::uint32_t duration_us(Interpolation interpolation, std::uint32_t travel,
                                                 std::uint32_t speed);
  // Reads the pose of the next move, or of the one that continues it. Returns the longest way of a joint from
  // the end of the present step to it, 2^-32 turn. begin_move and plan_through use the pose read last.
  std::uint32_t look_ahead(PoseReader pose);

  // Returns the time in which no joint exceeds its speed limit on the way to the pose that look_ahead read;
  // kMinStepTime_us to kMaxStepTime_us.
  [[nodiscard]] std::uint32_t fastest_us(Interpolation interpolation) const;

  // The joints of this mask, bit i for joint i, rest where they were measured, clamped to their limits, and
  // take no part in the present move. Joints beyond the end of `angles` keep their targets.
  void release(std::uint32_t joints, std::span<const fixed::Angle> angles);

  // Begins a step. The one before has finished.
  void begin_wait();
  // Begins a move to the pose that look_ahead read. `continues`: the step before was a cubic one that was
  // planned to go on to this pose.
  void begin_move(Interpolation interpolation, bool continues);
  // Some joints of the move that has just begun, which is not cubic, turn in a part of its time only. At most
  // Move::kMaxWindows.
  void add_window(const Window& window);
  // Plans the present cubic move, of `time_us`, to go on to the pose that look_ahead has read since it began.
  void plan_through(std::uint32_t time_us, std::uint32_t next_time_us);

  // Sets the targets to those after this fraction of the step's time.
  void interpolate(fixed::Ratio fraction);
  // Ends the step: its joints are at the pose.
  void finish();

  [[nodiscard]] std::span<const fixed::Angle> targets() const {
    return {targets_.data(), model_.joint_count};
  }

 private:
  // Differences and tangents of cubics, 2^-29 turn: up to 3 turns fit 32 bits.
  static constexpr int kTangentShift = 3;

  struct Tangents {
    std::int32_t start = 0;  // T v0 of the present move
    std::int32_t end = 0;    // T v1
    std::int32_t next = 0;   // T v0 of the next move
  };

  [[nodiscard]] std::int64_t difference(std::size_t joint) const {
    return std::int64_t{to_[joint].raw()} - from_[joint].raw();
  }
  // The part of the time in which joints of the present step turn.
  struct Part {
    std::uint32_t joints = 0;
    std::int32_t start_raw = 0;  // as a Ratio
    std::uint32_t rate = 0;      // the move's time over that of the part, 2^-16
  };

  void interpolate_profile(std::uint32_t joints, fixed::Ratio fraction);
  void interpolate_linearly(std::uint32_t joints, fixed::Ratio fraction);
  void interpolate_cubic(fixed::Ratio fraction);

  const robot::RobotModel& model_;
  Interpolation interpolation_ = Interpolation::kLinear;
  std::uint32_t moving_ = 0;   // joints of the present step; bit i: joint i
  std::uint32_t through_ = 0;  // those that go on in the next one
  std::array<Part, Move::kMaxWindows> parts_{};
  std::size_t part_count_ = 0;
  std::array<fixed::Angle, robot::kMaxJoints> from_{};
  std::array<fixed::Angle, robot::kMaxJoints> to_{};
  std::array<fixed::Angle, robot::kMaxJoints> targets_{};
  std::uint32_t joints_ahead_ = 0;    // of the pose that look_ahead read; bit i: joint i
  std::uint32_t changing_ahead_ = 0;  // those of them whose angle differs from that before
  std::array<fixed::Angle, robot::kMaxJoints> ahead_{};
  std::array<Tangents, robot::kMaxJoints> tangents_{};
};

}  // namespace koboshi::motion
