"""Measures the time from the trunk's rate to the ankle that answers it, with the Python module.

A standing robot is pushed twice in the same world, with gyro feedback of one ankle and without. The
difference of the joint's target, and of its true angle, is what the feedback adds. The lag is the one at
which the correlation with the trunk's true rate is largest.
"""

import koboshi
import numpy as np

GAIN_S = 0.01
IMPULSE_S = 0.1  # duration of the push
FORCE_N = 4.0
WATCHED_MS = 600
MOST_LAG_MS = 120
FEEDBACK_WHILE_STANDING = (
    [f"standing_gain_{joint}_s" for joint in ("ankle_pitch", "ankle_roll", "hip_pitch", "hip_roll", "knee")]
    + [f"standing_lean_gain_{joint}_percent"
       for joint in ("ankle_pitch", "ankle_roll", "hip_pitch", "hip_roll", "knee")]
    + ["standing_dead_band_deg_per_s"])


def pushed(stepper, seed, axis, gain_s):
    """Returns the trunk's rate [rad/s], the ankle's target and its true angle [rad], each millisecond."""
    sim = koboshi.Simulation("scenarios/go.yaml", seed=seed, stepper=stepper,
                             set={"commands": [{"at_s": 2, "enable": True}]})
    sim.step(4500)
    for name in FEEDBACK_WHILE_STANDING:
        sim.write(name, 0.0)
    sim.write(f"standing_gain_ankle_{axis}_s", gain_s)
    sim.step(500)
    sim.push([FORCE_N, 0, 0] if axis == "pitch" else [0, FORCE_N, 0], IMPULSE_S, shape="half-sine")
    joint = sim.joint_names.index(f"left_ankle_{axis}")
    rows = []
    for _ in range(WATCHED_MS):
        sim.step(1)
        truth = sim.truth()
        rows.append((truth.rate_rad_per_s[0 if axis == "roll" else 1], sim.state().joint_target_rad[joint],
                     truth.joint_position_rad[joint]))
    return np.array(rows).T


def lag_of(rate, answer):
    """Returns the lag [ms] with the largest correlation, and the correlation."""
    def correlation(lag):
        early, late = rate[:len(rate) - lag], answer[lag:]
        return abs(early @ late) / np.sqrt((early @ early) * (late @ late))
    lag = max(range(MOST_LAG_MS), key=correlation)
    return lag, correlation(lag)


def main():
    print("engine  ankle  seed  target: lag [ms], correlation  joint: lag [ms], correlation")
    for stepper in ("lumped", "mujoco"):
        for axis in ("pitch", "roll"):
            for seed in (1, 2, 3):
                rate, target, angle = pushed(stepper, seed, axis, GAIN_S)
                _, still_target, still_angle = pushed(stepper, seed, axis, 0.0)
                of_target = lag_of(rate, target - still_target)
                of_joint = lag_of(rate, angle - still_angle)
                print(f"{stepper:7} {axis:6} {seed:4}  {of_target[0]:16} {of_target[1]:12.2f}"
                      f"  {of_joint[0]:16} {of_joint[1]:12.2f}")


if __name__ == "__main__":
    main()
