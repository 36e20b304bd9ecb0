#pragma once

// Model constants that all engines share.

namespace koboshi::sim_board {

// Minimum number of joints between two links that can collide. Closer links overlap by design where their
// hinges intersect.
inline constexpr int kMinJointsBetween = 3;

// Speed above which a joint slides, with friction opposite to its speed. Below it the joint may stick, and
// the solver decides. For a small servo Kc h / J is 0.03 rad/s, so a sliding joint cannot cross the band in
// one step. Runs with 0.01 to 0.3 behave alike.
inline constexpr double kSlidingSpeed_rad_per_s = 0.1;

// Joint stops as spring and damper. A stalled servo of 1.4 N m deflects a stop by 0.14 mrad. The damping is
// far above critical, so that joints do not bounce; a joint that passes its limit within a step returns with
// a time constant of kd/kp = 4 ms.
inline constexpr double kStopStiffness_Nm_per_rad = 1e4;
inline constexpr double kStopDamping_Nm_s_per_rad = 40.0;

// Coupling of two hinges that one motor turns, as a constraint with ODE's default error reduction per step.
// It yields by the mixing times the torque: 1e-6 rad/s at 10 N m.
inline constexpr double kCouplingErrorReduction = 0.2;
inline constexpr double kCouplingForceMixing = 1e-7;

}  // namespace koboshi::sim_board
