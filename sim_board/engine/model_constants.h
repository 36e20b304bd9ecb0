#pragma once

// Constants of the robot's model that all engines share.

namespace koboshi::sim {

// Link pairs that have fewer joints between them never collide: neighbours, and neighbours of neighbours, overlap where
// their hinges cross.
inline constexpr int kMinJointsBetween = 3;

// A joint that turns faster slides: the sign of its speed gives the friction. A slower one may stick, and the solver
// decides. Kc h / J of a small servo is 0.03 rad/s, so a sliding joint cannot jump across the band. Runs with 0.01 to
// 0.3 behave alike.
inline constexpr double kSlidingSpeed_rad_per_s = 0.1;

// Joint stops as spring and damper. A stalled servo of 1.4 N m bends a stop by 0.14 mrad. The damping is far beyond
// critical, so that no joint bounces off; a joint that ran past its limit within a step returns in kd/kp = 4 ms.
inline constexpr double kStopStiffness_Nm_per_rad = 1e4;
inline constexpr double kStopDamping_Nm_s_per_rad = 40.0;

}  // namespace koboshi::sim
